// Purpose: the rotation of one joint frame against the other as a twist followed by a swing
// (document, sections A.3.6 and A.3.7), and the exact rows of both.
//   p = q_swing q_twist      twist about c, then the shortest turn that takes c_a to c_b
//   th                       twist angle: that of `twist` (quaternion_hinge_limit.h), rad
//   s_e = sigma.e            component of the swing's rotation vector along an axis e normal to c_a
//   J_b(th)  = h/cos(swing/2), `twist_row` of the same file
//   J_b(s_e) = (n.e) n + (m.e) (swing cot(swing) m - swing c_a), n = unit(sigma), m = n x c_a
// Terms, world space: c_a and c_b the twist axes of the bodies (Bullet's cone twist has the frames'
// x there; any other will do), e fixed in body a, J_a = -J_b. For a swing as seen from body b
// exchange the bodies: the rows are then J_a. At a swing of pi every turn by pi about a normal of
// c_a is a shortest one. The vector form takes any tangent there, (A.25) no twist; each is
// definite, and all is finite.
#pragma once

#include <pintle/equations/quaternion_hinge_limit.h>

namespace pintle::equations {

/// The shortest rotation from the unit vector a to the unit vector b. (Half-way, in `swing`, the
/// document asks for |a + b| = 0 exactly, where it needs a threshold.)
template <class T>
Quaternion<T> shortest_rotation(const Vector3<T>& a, const Vector3<T>& b) {
  const Vector3<T> h = swing(a, b).h;
  return {a.dot(h), cross(a, h)};                                                        // (A.22)
}

/// The twist of q about the unit vector v. The document leaves out the vector v, and what to do at
/// a swing of pi: there is no twist left to find, and q is a swing.
template <class T>
Quaternion<T> twist_part(const Quaternion<T>& q, const Vector3<T>& v) {
  using std::sqrt;
  const T s = q.v.dot(v), norm2 = q.w * q.w + s * s;
  if (!(norm2 > T(1e-30))) return {T(1), Vector3<T>::Zero()};
  const T k = T(1) / sqrt(norm2);
  return {k * q.w, k * s * v};                                                           // (A.25)
}

/// q = swing twist, both unit. The document's factors the other way round: it swings first.
template <class T>
struct SwingTwist {
  Quaternion<T> swing, twist;
};

template <class T>
SwingTwist<T> swing_twist(const Quaternion<T>& q, const Vector3<T>& v) {
  const Quaternion<T> twist = twist_part(q, v);
  return {product(q, conjugate(twist)), twist};                                          // (A.24)
}

/// The twist angle (rad), in (-pi, pi].
template <class T>
T twist_angle(const Twist<T>& twist) {
  using std::atan2;
  return atan2(twist.y + T(0), twist.x + T(0));  // -0 is +0: half a turn is +pi, nothing is 0
}

/// The unit vector about which the swing turns; at no swing any tangent.
template <class T>
Vector3<T> swing_axis(const Swing<T>& s, const Vector3<T>& c_a) {
  // Squares below this are no longer normal numbers of a float.
  const bool turned = s.sigma.dot(s.sigma) > T(1e-36);
  return turned ? Vector3<T>(s.sigma / s.angle) : any_tangent(c_a);
}

/// J_b of s_e = sigma.e, linear in e: exact up to a swing of pi - 1e-5. It grows as
/// swing/sin(swing) across the swing; beyond, where that has no bound, only the part along the
/// swing is left.
template <class T>
Vector3<T> swing_row(const Swing<T>& s, const Vector3<T>& c_a, const Vector3<T>& e) {
  using std::cos;
  using std::sin;
  const T swing2 = s.angle * s.angle, along = s.sigma.dot(e);
  // (1 - swing cot(swing)) / swing^2, whose next term is below 1e-12 of the first.
  T k = T(1) / T(3) + swing2 / T(45);
  if (swing2 > T(1e-5)) {
    const T sine = sin(s.angle);
    if (!(sine > T(5e-6))) return along / swing2 * s.sigma;
    k = (T(1) - s.angle * cos(s.angle) / sine) / swing2;
  }
  return (T(1) - k * swing2) * e + k * along * s.sigma - cross(s.sigma, c_a).dot(e) * c_a;
}

}  // namespace pintle::equations
