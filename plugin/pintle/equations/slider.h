// Purpose: the slider's two linear rows (document, section 3.1.4): p_b moves along one axis of body
// a only. Its orientation is held by other rows.
//   C = {a.d, b.d}                                         m
//   J = [-u, -((r_a + d) x u), u, r_b x u], u = a, b
// Terms, world space: {a, b, c} a basis fixed in body a, c the axis; the anchors r_a, r_b and d.
// The rows are contact_row along a and b, and the coordinate along the axis, with its row for a
// limit or a motor, is contact_row along c: both levers reach p_b, so each is a gradient at any
// error and conserves angular momentum. position_curvature_conserving is the curvature of all
// three.
#pragma once

#include <pintle/equations/contact.h>

namespace pintle::equations {

/// The document's points m_a and m_b, halfway along the axis between the anchors.
template <class T>
Anchors<T> slider_middle(const Vector3<T>& c, const Anchors<T>& at) {
  const Vector3<T> half = c * (c.dot(at.d) / 2);                                          // (3.10)
  return {at.r_a + half, at.r_b - half, at.d - T(2) * half};                              // (3.11)
}

/// The document's row along u = a or b. Not the gradient of C, even where C = 0, unless both bodies
/// turn alike (as the orientation's rows have it) or d = 0.
template <class T>
LinearRow<T> slider_row_middle(const Vector3<T>& u, const Vector3<T>& c, const Anchors<T>& at) {
  return contact_row_world(u, slider_middle(c, at));                                      // (3.12)
}

}  // namespace pintle::equations
