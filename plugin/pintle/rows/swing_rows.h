// Purpose: the two rows that keep an axis of each body together (document, 3.2.4, conditioned), for every
// joint that has a hinge part.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/equations/quaternion_hinge.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// `swing`: from the axis of a to that of b. Returns the unit vectors that the rows are about.
inline std::array<Vec3, 2> addSwingRows(const equations::Swing<Scalar>& swing,
                                        Scalar max_correction_speed, Rows& rows,
                                        unsigned char group = 0) {
  const Vec3 p = any_tangent(swing.h), q = cross(swing.h, p);
  using Pair = Eigen::Matrix<Scalar, 2, 1, Eigen::DontAlign>;
  const Pair curvature = rows.curvature([&](const BodyPair& v) {
    return Pair(equations::swing_curvature<Scalar>(swing, p, q, v.w_a(), v.w_b()));
  });
  const Scalar speed_per_error = swing.angle > 0 ? max_correction_speed / swing.angle : Scalar(0);
  const auto add = [&](const Vec3& u, Scalar second_derivative) {
    Row& row = rows.addAngular(u, u.dot(swing.sigma), second_derivative);
    row.max_speed = speed_per_error * std::abs(row.position);
    row.group = group;
  };
  add(p, curvature[0]);
  add(q, curvature[1]);
  return {p, q};
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
