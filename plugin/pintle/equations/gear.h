// Purpose: a gear (in no section of the document): a weighted sum of two coordinates is held, over any number of revolutions.
//   C = q_a + rho q_b - offset,  J = J(q_a) + rho J(q_b)
// A coordinate q is the angle of a hinge (quaternion_hinge_limit.h), the position of a slider (contact.h), or the rotation of one
// body about an axis n that is fixed in it, the integral of n.w. That integral is no function of a pose: it is the angle of a
// direction v of the body against a direction x across n that is carried along with n without a rotation about n
// (parallel transport), so that where n holds still it is the angle about n, and nothing piles up.
// Terms, world space: unit vectors n, x, v.
#pragma once

#include <pintle/notation.h>

#include <cmath>

namespace pintle::equations {

/// x, a unit vector across n, after the smallest rotation that brings n to `to`.
template <class T>
Vector3<T> carried(const Vector3<T>& x, const Vector3<T>& n, const Vector3<T>& to) {
  using std::sqrt;
  // Where n turns over, all rotations are as small.
  constexpr double kTurnedOver = 1e-12;
  const T sum = T(1) + n.dot(to);
  Vector3<T> moved = x;
  if (sum > T(kTurnedOver)) moved -= (n + to) * (to.dot(x) / sum);
  moved -= to * to.dot(moved);
  return moved / sqrt(moved.dot(moved));
}

/// The angle of v about n against x, in (-pi, pi].
template <class T>
T angle_against(const Vector3<T>& x, const Vector3<T>& n, const Vector3<T>& v) {
  using std::atan2;
  return atan2(v.dot(cross(n, x)) + T(0), v.dot(x));
}

}  // namespace pintle::equations
