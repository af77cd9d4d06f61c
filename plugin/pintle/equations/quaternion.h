// Purpose: the quaternion identities (document, sections 3.2.3 and A.3) that the joints use.
#pragma once

#include <pintle/notation.h>

namespace pintle::equations {

/// a b, by scalar and vector parts.
template <class T>
Quaternion<T> product(const Quaternion<T>& a, const Quaternion<T>& b) {
  return {a.w * b.w - a.v.dot(b.v), a.w * b.v + b.w * a.v + cross(a.v, b.v)};            // (A.11)
}

/// The inverse of a unit quaternion.
template <class T>
Quaternion<T> conjugate(const Quaternion<T>& a) {
  return {a.w, -a.v};                                                                    // (A.13)
}

/// The rotation by `angle` (rad) about the unit vector `axis`.
template <class T>
Quaternion<T> rotation(const Vector3<T>& axis, T angle) {
  using std::cos;
  using std::sin;
  return {cos(angle / 2), sin(angle / 2) * axis};                                        // (A.10)
}

/// The rotation of a to b from one unit quaternion each, as seen from a.
template <class T>
Quaternion<T> relative(const Quaternion<T>& q_a, const Quaternion<T>& q_b) {
  return product(conjugate(q_a), q_b);                                                   // (3.19)
}

/// The unit quaternion, w >= 0, of a rotation matrix.
template <class M>
Quaternion<typename M::Scalar> quaternion(const M& R) {
  using T = typename M::Scalar;
  using std::sqrt;
  // Of the four ways to divide, the one with the largest divisor keeps the digits.
  const T trace = R(0, 0) + R(1, 1) + R(2, 2);
  Quaternion<T> q;
  if (trace > T(0)) {
    const T s = sqrt(trace + T(1)) * T(2);
    q.w = s / T(4);
    q.v = Vector3<T>(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1)) / s;
    return q;
  }
  const int i = R(0, 0) > R(1, 1) ? (R(0, 0) > R(2, 2) ? 0 : 2) : (R(1, 1) > R(2, 2) ? 1 : 2);
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  const T s = sqrt(R(i, i) - R(j, j) - R(k, k) + T(1)) * T(2);
  q.w = (R(k, j) - R(j, k)) / s;
  q.v[i] = s / T(4);
  q.v[j] = (R(j, i) + R(i, j)) / s;
  q.v[k] = (R(k, i) + R(i, k)) / s;
  if (q.w < T(0)) q = {-q.w, -q.v};
  return q;
}

/// The rotation of a vector by a unit quaternion.
template <class T>
Vector3<T> rotate(const Quaternion<T>& q, const Vector3<T>& x) {
  return x + T(2) * cross(q.v, Vector3<T>(cross(q.v, x) + q.w * x));
}

}  // namespace pintle::equations
