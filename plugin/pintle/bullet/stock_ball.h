// Purpose: what stands in a ball joint of Bullet's.
#pragma once

#include <pintle/bullet/stock_parameter.h>

class btPoint2PointConstraint;

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Parameters of a ball joint, as they stand. (Its other settings are public.)
struct StockBall {
  StockParameter erp, cfm;

  explicit StockBall(const btPoint2PointConstraint& ball);
};

/// Bullet leaves the parameters that are not set as the memory was.
void clearParameters(btPoint2PointConstraint& ball);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
