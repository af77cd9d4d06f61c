// Purpose: the one angular row of the locks and hinges that have too few.
#pragma once

#include <pintle/equations/orientation_lock.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Its error is taken away at no more than `max_speed` (rad/s) about the axis of J, which may be of any
/// length.
inline void addSingleRow(const equations::AngularRow<Scalar>& row, Scalar max_speed, Rows& rows) {
  const Scalar length = std::sqrt(row.J_b.dot(row.J_b));
  // Shorter than its rounding it has no direction.
  const bool none = !(length > SIMD_EPSILON);
  rows.addAngular(none ? Vec3(Vec3::Zero()) : row.J_b, row.C).max_speed =
      none ? Scalar(0) : max_speed * length;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
