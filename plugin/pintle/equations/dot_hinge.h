// Purpose: the rows that keep two hinge axes parallel by dot products (document, section 3.2.1).
//   C = {f.d, f.e}
//   J_b = {d x f, e x f}, J_a = -J_b
// Terms, world space: f the hinge axis of body a, d and e two tangents of the hinge axis of body b.
// The rows' singular values are 1 and |cos(swing)|: stuck at 90 degrees, and beyond they pull the
// axes to 180, where C = 0 too. The well conditioned form is that of quaternion_hinge.h.
#pragma once

#include <pintle/equations/orientation_lock.h>

namespace pintle::equations {

/// The row that keeps f, fixed in body a, and d, fixed in body b, perpendicular.
template <class T>
AngularRow<T> dot_hinge_row(const Vector3<T>& f, const Vector3<T>& d) {
  AngularRow<T> row;
  row.C = f.dot(d);                                                                       // (3.15)
  row.J_b = cross(d, f);                                                                  // (3.16)
  return row;
}

}  // namespace pintle::equations
