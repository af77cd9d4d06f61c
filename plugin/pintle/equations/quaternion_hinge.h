// Purpose: the two rows that keep two hinge axes parallel (document, section 3.2.4), in the
// document's form and in one that is as well conditioned at every error.
// Terms, world space: {a, b, c} the joint frame of body a, c_a and c_b the hinge axes of the bodies.
// J_a = -J_b everywhere and there is no linear part, so a row is its J_b.
#pragma once

#include <pintle/equations/orientation_lock.h>

#include <cmath>

namespace pintle::equations {

/// The document's row about the axis u of the joint frame, normal to the hinge's: two of the lock's
/// three rows, where p decides which angle is zero. The printed J is transposed. It vanishes along
/// the error as the error nears pi: J has singular values 1/2 and cos(swing/2)/2, and at pi the row
/// is stuck.
template <class T>
AngularRow<T> quaternion_hinge_row(const Quaternion<T>& p, const Matrix3<T>& F, const Vector3<T>& u) {
  return quaternion_row(p, F, u);                                               // (3.25), (3.28)
}

/// The conditioned form. A relative rotation is a swing between two halves of one twist,
/// Rz(th/2) exp(sigma) Rz(th/2), and the hinge holds sigma = 0:
///   swing = |sigma| = atan2(|c_a x c_b|, c_a.c_b), about n = unit(c_a x c_b)
///   h     = unit(c_a + c_b), normal to sigma: the axis about which the joint is free
///   J     = {n, (swing/2)/sin(swing/2) h x n}, C = {swing, 0}
/// Any two unit rows p, q normal to h with C = sigma.p, sigma.q are these rows times an invertible
/// matrix (C = 0 in the second one, so its factor is free): unit length at any error.
template <class T>
struct Swing {
  Vector3<T> sigma;  ///< rad, world: from c_a to c_b
  Vector3<T> h;
  T angle;           ///< |sigma|, in [0, pi]
  T h_scale;         ///< 1 / cos^2(swing/2) = 2 / (1 + c_a.c_b), infinite at pi
};

template <class T>
Swing<T> swing(const Vector3<T>& c_a, const Vector3<T>& c_b) {
  using std::atan2;
  using std::sqrt;
  const Vector3<T> x = cross(c_a, c_b), sum = c_a + c_b;
  const T sin2 = x.dot(x), sin_swing = sqrt(sin2), sum2 = sum.dot(sum);
  Swing<T> s;
  // |c_a + c_b| = 2 cos(swing/2). Within 1e-5 rad of pi the sum has no direction left
  // and neither has c_a x c_b: any turn by pi about a tangent of c_a is a shortest one.
  if (sum2 < T(1e-10)) {
    const Vector3<T> n = any_tangent(c_a);
    s.angle = T(pi);
    s.sigma = s.angle * n;
    s.h = cross(n, c_a);
    s.h_scale = T(4) / T(1e-10);
    return s;
  }
  s.h = sum * (T(1) / sqrt(sum2));                                                       // (A.23)
  s.h_scale = T(4) / sum2;
  if (sin2 < T(1e-5) && sum2 > T(2)) {
    const T ratio = small_angle_over_sine(sin2);
    s.sigma = x * ratio;
    s.angle = sin_swing * ratio;
    return s;
  }
  s.angle = atan2(sin_swing, c_a.dot(c_b));
  s.sigma = x * (sin_swing > T(0) ? s.angle / sin_swing : T(0));
  return s;
}

/// d^2/dt^2 of sigma along p and q = h x p, at constant w, for a hinge that is satisfied and turns at
/// w_b - w_a along h: the axes do not stay together if the pair turns across them meanwhile.
template <class T>
Eigen::Matrix<T, 2, 1, Eigen::DontAlign> swing_curvature(const Swing<T>& s, const Vector3<T>& p,
                                                         const Vector3<T>& q,
                                                         const Vector3<T>& w_a,
                                                         const Vector3<T>& w_b) {
  // rate (h x w) with w the mean of both
  const T half_rate = s.h.dot(w_b - w_a) / 2;
  const Vector3<T> w2 = w_a + w_b;
  return {-half_rate * q.dot(w2), half_rate * p.dot(w2)};
}

}  // namespace pintle::equations
