// Purpose: the angular constraints that the document lists as unstable (sections 3.3.1 to 3.3.3),
// with their misprints corrected: for comparison, not for use.
// Terms, world space: c_a and c_b the hinge axes, q_a and q_b the quaternions of the joint frames.
#pragma once

#include <pintle/equations/dot_hinge.h>
#include <pintle/equations/position.h>

namespace pintle::equations {

/// A hinge in one row, which takes away two degrees of freedom: it can correct along one direction
/// at a time, and J = 0 where C = 0. (The document takes (w x r) x s for w x (r x s).)
template <class T>
AngularRow<T> cross_product_row(const Vector3<T>& c_a, const Vector3<T>& c_b) {
  const Vector3<T> x = cross(c_a, c_b);
  AngularRow<T> row;
  row.C = x.dot(x) / 2;                                                                   // (3.50)
  row.J_b = c_a.dot(c_b) * x;                                                             // (3.52)
  return row;
}

/// A hinge in three rows, this one along u, fixed in the world: C = u.(c_a x c_b),
/// J_a = [c_b]x [c_a]x, J_b = -[c_a]x [c_b]x, which are not opposite. Where C = 0 the rows have
/// rank 2 and K no inverse. Elsewhere it has one, whatever the document's determinants say, but for
/// a swing of 90 degrees: of unit inertias its determinant is sin^2(2 swing)/2.
template <class T>
LinearRow<T> cross_product_matrix_row(const Vector3<T>& u, const Vector3<T>& c_a,
                                      const Vector3<T>& c_b) {
  LinearRow<T> row;
  row.C = u.dot(cross(c_a, c_b));                                                         // (3.54)
  row.J.L = Vector3<T>::Zero();
  row.J.A_a = cross(c_a, cross(u, c_b));
  row.J.A_b = cross(c_b, cross(u, c_a));                                                  // (3.55)
  return row;
}

/// A lock in one row, which takes away three degrees of freedom; J = 0 where C = 0. The document
/// leaves out the factor 1/2 of the quaternion's derivative.
template <class T>
AngularRow<T> quaternion_dot_row(const Quaternion<T>& q_a, const Quaternion<T>& q_b) {
  AngularRow<T> row;
  row.C = q_a.w * q_b.w + q_a.v.dot(q_b.v) - T(1);                                        // (3.59)
  row.J_b = T(0.5) * product(q_a, conjugate(q_b)).v;                                      // (3.61)
  return row;
}

}  // namespace pintle::equations
