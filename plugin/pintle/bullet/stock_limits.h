// Purpose: limits as they stand in Bullet's objects.
#pragma once

#include <pintle/finite.h>
#include <pintle/precision.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Limits of Pintle's that Bullet's object cannot hold stand there as this pair, which is free, and which nobody else writes.
constexpr btScalar free_low = btScalar(0.7320508), free_high = btScalar(-0.5303301);

/// rad: (-pi, pi) within this is no limit. Clients write pi in either precision, or as 3.14159
/// (FreeTurn.HalfATurnEitherWayIsNoLimit).
constexpr Scalar of_pi = Scalar(1e-5);

/// False where low and high are no numbers, or the same infinity: there no position is.
inline bool leavesAPosition(Scalar low, Scalar high) {
  if (!isNumber(low) || !isNumber(high)) return false;
  return !(low <= high && (low >= infinity || high <= -infinity));
}

/// The distance of a coordinate beyond its limits, above zero beyond the upper one; low > high: there are none.
inline Scalar beyond(Scalar position, Scalar low, Scalar high) {
  if (!(low <= high)) return 0;
  return position > high ? position - high : position < low ? position - low : Scalar(0);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
