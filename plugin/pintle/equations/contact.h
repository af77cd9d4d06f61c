// Purpose: the contact constraint (document, section 3.1.2): p_a and p_b lie in one plane of normal
// n; with lambda > 0 only, p_b stays on the side to which n points.
//   C = n.d                                                m
//   J = [-n, -(lever x n), n, r_b x n]
// Terms, world space: the anchors r_a, r_b and d = p_b - p_a, a unit vector n. The joints that hold
// two points along some directions only are made of these rows.
#pragma once

#include <pintle/equations/position.h>

namespace pintle::equations {

/// With n fixed in body a. The document's lever r_a leaves out that the plane turns with body a.
/// d^2/dt^2 of C is n . position_curvature_conserving.
template <class T>
LinearRow<T> contact_row(const Vector3<T>& n, const Anchors<T>& at) {
  return {position_row_conserving(n, at.r_a, at.d, at.r_b), n.dot(at.d)};
}

/// The document's row, with n fixed in the world. d^2/dt^2 of C is n . position_curvature.
template <class T>
LinearRow<T> contact_row_world(const Vector3<T>& n, const Anchors<T>& at) {
  return {position_row(n, at.r_a, at.r_b), n.dot(at.d)};                                  // (3.5)
}

}  // namespace pintle::equations
