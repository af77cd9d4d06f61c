// Purpose: the angle of a hinge and the row of its limit (document, section 3.2.5), in the
// document's half-sine space and in plain radians.
// th is the rotation of b against a about the hinge axis c, p and F as in orientation_lock.h, and
// m the number of whole turns in th (th - 2 pi m in [-pi, pi]); J_a = -J_b.
#pragma once

#include <pintle/equations/quaternion_hinge.h>

namespace pintle::equations {

/// An angle in the document's half-sine space: l = sin(th/2) within half a turn, continued
/// monotonely over any number of turns by 2 for each. Needs the turns as state: a quaternion
/// repeats after two turns, whatever range the document claims.
template <class T>
T half_sine(T remainder, T turns) {
  using std::sin;
  return T(2) * turns + sin(remainder / 2);                                              // (3.31)
}

/// The document's coordinate and row about c. p is negated if w < 0, and J with it, so that the row
/// always pushes the same way. The two conditions printed for w < 0 are exchanged; written with
/// the turns m they are one: c_lim + 2 m. |J| = |w|/2: nothing at odd multiples of pi.
template <class T>
AngularRow<T> quaternion_hinge_limit_row(Quaternion<T> p, const Matrix3<T>& F, const Vector3<T>& c,
                                         T turns) {
  if (p.w < T(0)) p = {-p.w, -p.v};
  AngularRow<T> row = quaternion_row(p, F, c);                                           // (3.29)
  row.C += T(2) * turns;                                                                 // (3.35)
  return row;
}

/// Twist as a direction in the plane: th = atan2(y, x), both scaled by 1 + cos(swing), from the
/// products of the joint frames' axes: 2 atan2(v.c, w) of p without the quaternion.
template <class T>
struct Twist {
  T x, y;
};

template <class T>
Twist<T> twist(T a_a_dot_a_b, T b_a_dot_b_b, T b_a_dot_a_b, T a_a_dot_b_b) {
  return {a_a_dot_a_b + b_a_dot_b_b, b_a_dot_a_b - a_a_dot_b_b};
}

/// J_b of th: exactly c on a hinge that is satisfied, h / cos(swing/2) on one that is not.
template <class T>
Vector3<T> twist_row(const Swing<T>& s) {
  using std::sqrt;
  return s.h * sqrt(s.h_scale);
}

/// The same from the hinge axes alone.
template <class T>
Vector3<T> twist_row(const Vector3<T>& c_a, const Vector3<T>& c_b) {
  const Vector3<T> sum = c_a + c_b;
  const T sum2 = sum.dot(sum);
  return sum * (T(2) / (sum2 > T(1e-10) ? sum2 : T(1e-10)));
}

}  // namespace pintle::equations
