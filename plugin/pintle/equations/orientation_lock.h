// Purpose: the rows that keep the orientation of b against a (document, section 3.2.3), in the
// document's form and in one without its singularity.
// Terms: p = conj(q_a f_a) (q_b f_b) = (w, v) the rotation of the joint frames (this is q_r
// conj(q_0)), F = R(q_a f_a). J_a = -J_b everywhere and there is no linear part, so a row is its
// J_b.
#pragma once

#include <pintle/equations/quaternion.h>

#include <cmath>

namespace pintle::equations {

/// One angular row: J_b and its position error C.
template <class T>
struct AngularRow {
  Vector3<T> J_b;
  T C;
};

/// The document's row about the axis u of the joint frame (any u; three of them for the lock),
/// without its matrices of four rows. It vanishes along the error as that nears pi, and a full step
/// is 2 tan(angle/2).
template <class T>
AngularRow<T> quaternion_row(const Quaternion<T>& p, const Matrix3<T>& F, const Vector3<T>& u) {
  AngularRow<T> row;
  row.C = p.v.dot(u);                                                                     // (3.22)
  row.J_b = T(0.5) * (F * (p.w * u + cross(p.v, u)));                                     // (3.24)
  return row;
}

/// angle / sin(angle) from the square of the sine, without the trigonometry: for sin2 < 1e-5, where
/// the next term is 5e-17.
template <class T>
T small_angle_over_sine(T sin2) {
  return T(1) + sin2 * (T(1) / T(6) + sin2 * (T(3) / T(40)));
}

/// The rotation vector (rad, up to pi long) of a unit quaternion of either sign.
template <class T>
Vector3<T> rotation_vector(Quaternion<T> q) {
  using std::atan2;
  using std::sqrt;
  if (q.w < T(0)) q = {-q.w, -q.v};
  const T sine = sqrt(q.v.dot(q.v));
  if (!(sine > T(0))) return T(2) * q.v;
  const T angle = T(2) * atan2(sine, q.w);                                                // (A.15)
  return q.v * (angle / sine);
}

/// The conditioned form's error phi (rad, world): exp(phi) turns the joint frame of a, whose axes
/// are the columns of F_a, into that of b. Its rows are J_b = u, C = phi.u for any three unit
/// vectors u: the exact Jacobian of phi times a matrix that leaves phi as it is, and as good at any
/// error. At exactly pi, where phi and -phi are one turn, it is one of them, the same one for the
/// same frames.
template <class T>
Vector3<T> orientation_error(const Matrix3<T>& F_a, const Matrix3<T>& F_b) {
  const Matrix3<T> R = F_b * F_a.transpose();
  const Vector3<T> x = T(0.5) * Vector3<T>(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  const T sin2 = x.dot(x);
  if (sin2 < T(1e-5) && R.trace() > T(1)) return x * small_angle_over_sine(sin2);
  return rotation_vector(quaternion(R));
}

}  // namespace pintle::equations
