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
///
/// From the sums of a x a' and of a.a' over the frames' axes, which are enough while it is small, in
/// any basis. R: a function that returns the rotation in the same basis (F_b F_a^T in the world,
/// F_a^T F_b in the frames), called if they are not.
template <class T, class Rotation>
Vector3<T> orientation_error(const Vector3<T>& crossed, T trace, const Rotation& R) {
  // The antisymmetric part of R is the axis times the sine.
  const Vector3<T> x = T(0.5) * crossed;
  const T sin2 = x.dot(x);
  if (sin2 < T(1e-5) && trace > T(1)) return x * small_angle_over_sine(sin2);
  return rotation_vector(quaternion(R()));
}

/// The same from the frames, in the world.
template <class T>
Vector3<T> orientation_error(const Matrix3<T>& F_a, const Matrix3<T>& F_b) {
  const auto crossed = [&](int i) { return cross(F_a.col(i), F_b.col(i)); };
  const auto dot = [&](int i) { return F_a.col(i).dot(F_b.col(i)); };
  return orientation_error(Vector3<T>(crossed(0) + crossed(1) + crossed(2)),
                           dot(0) + dot(1) + dot(2),
                           [&] { return Matrix3<T>(F_b * F_a.transpose()); });
}

/// d^2/dt^2 of phi at constant w, for a lock that is satisfied: the turns exp(w_b t) and exp(-w_a t)
/// do not commute.
template <class T>
Vector3<T> orientation_curvature(const Vector3<T>& w_a, const Vector3<T>& w_b) {
  return cross(w_a, w_b);
}

}  // namespace pintle::equations
