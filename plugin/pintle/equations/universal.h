// Purpose: the row of the universal joint and its two angles (document, section 3.2.9).
//   C = z.y = 0,  J_b = y x z, J_a = -J_b
// Terms, world space: {x_a, y_a, z_a} and {x_b, y_b, z_b} the joint frames, z = z_a the hinge of
// body a, y = y_b that of body b, always at right angles. R_a^T R_b = Rz(alpha) Ry(beta) Rx(gamma),
// and C = cos(beta) sin(gamma). |J| is sqrt(1 - C^2), nothing where z and y have come together.
// gamma = pi satisfies C as well as gamma = 0: it is the same joint, turned by half a turn about
// both hinges.
#pragma once

#include <pintle/equations/angle_about.h>
#include <pintle/equations/dot.h>

namespace pintle::equations {

/// The document's row.
template <class T>
AngularRow<T> universal_dot_row(const Vector3<T>& z, const Vector3<T>& y) {
  return dot_row(z, y);
}

/// The conditioned form: C (rad, in [-pi/2, pi/2]) by which the angle between z and y is short of
/// pi/2, with a unit row that is its gradient anywhere. beta may be anything.
template <class T>
AngularRow<T> universal_row(const Vector3<T>& z, const Vector3<T>& y) {
  using std::atan2;
  using std::sqrt;
  const AngularRow<T> dot = dot_row(z, y);
  const T length2 = dot.J_b.dot(dot.J_b);
  if (!(length2 > T(1e-30))) return {any_tangent(z), dot.C > T(0) ? T(pi / 2) : T(-pi / 2)};
  const T length = sqrt(length2);
  return {dot.J_b / length, atan2(dot.C, length)};
}

/// The same for a joint that keeps beta within +-pi/2, as Bullet's does, where gamma = pi is an
/// error and no place to rest: C = cos(beta) gamma, rad, and J_b = cos(beta) J_b(gamma), a unit
/// row. It goes on to pi at half a turn. Beyond pi/2 it sees gamma = pi: an error of pi
/// |cos(beta)|, which begins with nothing, so that a limit may give a little.
template <class T>
AngularRow<T> universal_gamma_row(const Vector3<T>& z, const Vector3<T>& x_b,
                                  const Vector3<T>& z_b) {
  // Of z as body b sees it: -gamma, and the row of a body that is a here.
  const AngleAbout<T> to = angle_about(x_b, z_b, z);
  return {to.unit, -to.length * to.angle()};
}

/// d^2/dt^2 of C at constant w where C = 0, and gamma for the last form: that of all three.
template <class T>
T universal_curvature(const Vector3<T>& z, const Vector3<T>& y, const Vector3<T>& w_a,
                      const Vector3<T>& w_b) {
  return dot_curvature(z, w_a, y, w_b);
}

/// The angles of the two hinges by the spider between them, which both bodies see turn about one
/// axis: alpha as the direction of y about z, and beta as that of z about y. They are alpha and
/// beta wherever the joint holds, at any beta: forms with x_b have a singularity at pi/2. J_b is z of
/// alpha, and y of beta. Bullet's getAngle1() and getAngle2() are -alpha and -beta.
template <class T>
struct SpiderAngles {
  T alpha_x, alpha_y;  ///< alpha = atan2(alpha_y, alpha_x)
  T beta_x, beta_y;    ///< the same
};

template <class T>
SpiderAngles<T> spider_angles(T x_a_dot_y_b, T y_a_dot_y_b, T z_a_dot_x_b, T z_a_dot_z_b) {
  return {y_a_dot_y_b, -x_a_dot_y_b, z_a_dot_z_b, -z_a_dot_x_b};
}

}  // namespace pintle::equations
