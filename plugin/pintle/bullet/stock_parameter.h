// Purpose: a parameter of setParam in a constraint of Bullet's.
#pragma once

#include <pintle/precision.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct StockParameter {
  bool is_set = false;
  Scalar value = 0;  ///< as a client wrote it
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
