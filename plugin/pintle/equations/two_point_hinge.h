// Purpose: a hinge of two position constraints on its axis (document, section 3.2.2, which has no
// formulas).
//   C = d_k = d + s_k (c_b - c_a), k = 1, 2                m, world
//   J: row u of point k is contact_row_world of u and point_on_axis(.., s_k)
// Terms, world space: the joint's anchors r_a, r_b and d; c_a and c_b the hinge axes of the bodies;
// s_1, s_2 (m) where the points lie on the axes; h = unit(c_a + c_b), p and q unit vectors normal
// to it.
//
// The points keep their distance on either body, so with C = 0 the six rows have rank 5: along the
// axis both points have the same row. Along h their errors are one at any violation, h.d_1 = h.d_2
// = h.d, as (c_b - c_a).h = 0. Hence the five rows: p and q of either point, and h of the joint's
// own anchors (s = 0), in which the choice between the two does not arise. At a swing of exactly
// pi, d_1 - d_2 lies in the axes, and neither form has a row that turns them.
#pragma once

#include <pintle/equations/contact.h>

namespace pintle::equations {

template <class T>
Anchors<T> point_on_axis(const Anchors<T>& at, const Vector3<T>& c_a, const Vector3<T>& c_b, T s) {
  return {at.r_a + s * c_a, at.r_b + s * c_b, at.d + s * (c_b - c_a)};
}

/// s_1 and s_2, in the order in which the solver should see the points: the last one is held best.
template <class T>
struct TwoPoints {
  T s_1, s_2;
};

/// The points on either side of the anchor. Far apart they hold the direction, close together the
/// place.
template <class T>
TwoPoints<T> points_about_anchor(T separation) {
  return {-separation / 2, separation / 2};
}

/// The document's better placement: one point is the axis's nearest to the centre of mass of a
/// body, whose lever to the anchor is r (c its axis; both in the world or both in the body). That
/// one holds the place, the other one the direction.
template <class T>
TwoPoints<T> points_from_nearest(const Vector3<T>& r, const Vector3<T>& c, T separation) {
  const T nearest = -r.dot(c);
  return {nearest + separation, nearest};
}

}  // namespace pintle::equations
