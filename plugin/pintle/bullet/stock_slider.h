// Purpose: what a slider of Bullet's shows of its angle.
#pragma once

#include <pintle/precision.h>

class btSliderConstraint;

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The state that btSliderConstraint::testAngLimits leaves for getSolveAngLimit and getAngDepth: by how much the limit is broken, rad, above
/// zero beyond the upper one.
void showAngularLimit(btSliderConstraint& slider, Scalar depth);
/// The answers of getSolveLinLimit and getSolveAngLimit.
void showBroken(btSliderConstraint& slider, bool linear, bool angular);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
