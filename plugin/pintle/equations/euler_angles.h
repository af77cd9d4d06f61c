// Purpose: Euler angles of any order of three different axes, their rows, and the pole where the outer two are one.
//   R_a^T R_b = R_k(t_k) R_j(t_j) R_i(t_i)
//   J_b(t_i) = (b_i - m a_k) / c^2,  J_b(t_j) = s (a_k x b_i) / c,  J_b(t_k) = (a_k - m b_i) / c^2,  J_a = -J_b
// Terms, world space: a_n and b_n the axes of the joint frames; i, j, k the first, middle and last axis, s = 1 if they are a
// cyclic order and -1 if not, m = a_k.b_i = -s sin(t_j), c = cos(t_j). Each pose has two triples: (t_i, t_j, t_k), and
// (t_i + pi, pi - t_j, t_k + pi), whose c is negative. `side` says which (1 or -1). Bullet's angles are minus those of side 1.
#pragma once

#include <pintle/notation.h>

#include <cmath>

namespace pintle::equations {

/// Numbers of the axes of a joint frame, in the order of an Euler triple.
struct EulerOrder {
  int first, middle, last;

  /// 1 if they are cyclic, else -1.
  int sign() const { return (first + 1) % 3 == middle ? 1 : -1; }
};

/// The axes that the angles are made of: i, j, k of each frame.
template <class T>
struct EulerAxes {
  Vector3<T> a_i, a_j, a_k, b_i, b_j, b_k;
  T s;  ///< 1 or -1
};

/// Each angle as a direction (x, y) in its plane, of the length |c|; the middle one's is 1.
template <class T>
struct EulerAngles {
  T x_i, y_i, x_j, y_j, x_k, y_k;
};

template <class T>
EulerAngles<T> euler_angles(const EulerAxes<T>& at, T side) {
  using std::sqrt;
  const Vector3<T> across = cross(at.a_k, at.b_i);
  const T m = at.a_k.dot(at.b_i), c2 = across.dot(across);
  const T c = c2 > T(0) ? sqrt(c2) : T(0);
  return {side * at.b_k.dot(at.a_k), side * at.s * at.b_j.dot(at.a_k), side * c,
          -at.s * m,                 side * at.b_i.dot(at.a_i),        side * at.s * at.b_i.dot(at.a_j)};
}

/// J_b of each angle.
template <class T>
struct EulerRows {
  Vector3<T> i, j, k;
};

/// Not for c = 0.
template <class T>
EulerRows<T> euler_rows(const EulerAxes<T>& at, T side) {
  using std::sqrt;
  const Vector3<T> across = cross(at.a_k, at.b_i);
  const T m = at.a_k.dot(at.b_i), c2 = across.dot(across);
  return {(at.b_i - m * at.a_k) / c2, across * (side * at.s / sqrt(c2)),
          (at.a_k - m * at.b_i) / c2};
}

}  // namespace pintle::equations
