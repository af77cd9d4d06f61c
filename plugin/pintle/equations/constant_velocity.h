// Purpose: the row of the constant velocity joint, its bend and its shaft (document,
// section 3.2.10).
//   C = y_a.z_b - z_a.y_b = -4 w v.x,  J_b = z_b x y_a - y_b x z_a, J_a = -J_b
// Terms: {x, y, z} the joint frames, x along the shafts; p = conj(q_a f_a) (q_b f_b) = (w, v) their
// rotation and F = R(q_a f_a), as for quaternion_row. Everything else is in world space.
// The joint holds v.x = 0: no twist about x, so that p bends the shaft and does nothing else. The
// document's C is zero at w = 0 too, which is no joint, and its row is 2 cos(bend/2) long.
// The bend is swing(x_a, x_b), and cone_row limits it.
#pragma once

#include <pintle/equations/angle_about.h>
#include <pintle/equations/dot.h>

namespace pintle::equations {

template <class T>
struct CrossAxes {
  Vector3<T> y, z;
};

/// The document's row.
template <class T>
AngularRow<T> constant_velocity_dot_row(const CrossAxes<T>& a, const CrossAxes<T>& b) {
  const AngularRow<T> plus = dot_row(a.y, b.z), minus = dot_row(a.z, b.y);
  AngularRow<T> row;
  row.C = plus.C - minus.C;                                                              // (3.48)
  row.J_b = plus.J_b - minus.J_b;                                                        // (3.49)
  return row;
}

/// The conditioned form: C = 2 asin(v.x), the angle (rad, up to pi) of the shortest turn that
/// satisfies the joint, and a unit row that is its gradient, at any bend and at any error. Where
/// the joint is satisfied that is unit(x_a + x_b), the axis halfway along the bend. Either sign of
/// p will do.
template <class T>
AngularRow<T> constant_velocity_row(const Quaternion<T>& p, const Matrix3<T>& F,
                                    const Vector3<T>& x) {
  using std::atan2;
  using std::sqrt;
  const AngularRow<T> half = quaternion_row(p, F, x);
  const T length2 = T(4) * half.J_b.dot(half.J_b);
  // A twist by pi and no bend: back about x, either way.
  if (!(length2 > T(1e-30))) return {F * x, half.C < T(0) ? T(-pi) : T(pi)};
  const T length = sqrt(length2);
  return {half.J_b * (T(2) / length), T(2) * atan2(half.C, length)};
}

/// d^2/dt^2 of the conditioned C at constant w, where C = 0, from its row: none while w_a, w_b and
/// the row are in one plane, as they are of a shaft that turns at a constant bend.
template <class T>
T constant_velocity_curvature(const Vector3<T>& J_b, const Vector3<T>& w_a, const Vector3<T>& w_b) {
  return -J_b.dot(cross(w_a, w_b));
}

/// The angle of the shaft: the direction of the bend, as body a sees it. While both bodies turn at W
/// along their own shaft and the bend stands still in the world, this angle grows at W. `length` is
/// the sine of the bend: a motor of the shaft has its torque from the bend, and none without.
template <class T>
AngleAbout<T> shaft_angle(const Vector3<T>& x_a, const Vector3<T>& y_a, const Vector3<T>& x_b) {
  AngleAbout<T> azimuth = angle_about(x_a, y_a, x_b);
  azimuth.y = -azimuth.y;
  azimuth.unit = -azimuth.unit;
  return azimuth;
}

}  // namespace pintle::equations
