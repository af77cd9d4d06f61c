// Purpose: the limit of a direction to a wedge of the sphere (document, section 3.2.7), by planes
// as the document has it, and by the angle about the wedge's axis.
//   c_b stays between the half planes through w that c_a is in after a turn by phi_- and by phi_+
//   C = c_b.n >= 0,  J_b = c_b x n, J_a = -J_b          for each plane
// Terms, world space: w (the wedge's edge) and c_a fixed in body a, c_b in body b, unit vectors;
// c_a at any angle to w other than along it; n a plane's normal, fixed in body a, pointing inside.
// phi_+ - phi_- is from 0 to 2 pi, and 0 need not be between.
//
// Which rows a joint writes, all of them inequalities:
//   below pi      both planes, n_min and n_max: in the corner, along w, both act
//   from pi on    the plane of the half of the sphere that c_b is in (`nearer_plane`), and only
//                 while c_b is behind both: beyond the edge either is no limit
//   acute         and `middle` for a third plane: where c_b is behind both they pull it along the
//                 edge at first, this one over it
// Behind the edge (`behind_edge`) both planes turn c_b about w, against each other: from there the
// shortest way in leads over the nearer end of the edge (`edge_distance`).
// A plane's row is |c_b x n| long. `plane_distance` says the same as an angle: C the shortest turn
// of c_b onto the plane, its row a unit vector at any error.
// By the angle there is one row at any total angle (over 2 pi too, if the angle is unwrapped): with
// to = angle_about(w, c_a, c_b), psi its angle, the row is to.unit, and to.length (psi - phi) its
// error. With middle for c_a, psi is in (-pi, pi] for any wedge of up to 2 pi, and needs no state.
// It turns c_b about w, not along the shortest way, and near w does not see c_b go over the edge.
// Where c_b lies along w there is no angle and no error, and the row stays a unit vector.
#pragma once

#include <pintle/equations/angle_about.h>
#include <pintle/equations/dot.h>

namespace pintle::equations {

/// c_a turned by phi (rad) about w.
template <class T>
Vector3<T> wedge_side(const Vector3<T>& w, const Vector3<T>& c_a, T phi) {
  const Quaternion<T> q_w = rotation(w, phi);                                            // (3.42)
  return rotate(q_w, c_a);                                                               // (3.43)
}

/// The printed normal is that of the maximum; the minimum's is the opposite one.
template <class T>
Vector3<T> wedge_normal(const Vector3<T>& v, const Vector3<T>& w) {
  using std::sqrt;
  const Vector3<T> n = cross(v, w);
  const T length2 = n.dot(n);
  if (!(length2 > T(1e-30))) return any_tangent(w);
  return n / sqrt(length2);                                                              // (3.44)
}

/// The normals of the planes. `middle` is the direction halfway between both sides, normal to w,
/// and that of the document's extra plane: unit(n_min + n_max), for which it prints c_a. That is
/// right only for c_a in the middle. They are constant in body a.
template <class T>
struct Wedge {
  Vector3<T> n_min, n_max, middle;
};

template <class T>
Wedge<T> wedge(const Vector3<T>& w, const Vector3<T>& c_a, T phi_min, T phi_max) {
  return {-wedge_normal(wedge_side(w, c_a, phi_min), w),
          wedge_normal(wedge_side(w, c_a, phi_max), w),
          cross(w, wedge_normal(wedge_side(w, c_a, (phi_min + phi_max) / T(2)), w))};
}

template <class T>
AngularRow<T> wedge_row(const Vector3<T>& n, const Vector3<T>& c_b) {
  return dot_row(n, c_b);                                                        // (3.40), (3.41)
}

/// The conditioned form of the same: C = the angle from the plane to c_b (rad, in [-pi/2, pi/2]),
/// and J_b its exact gradient, a unit vector. `fallback`, normal to n, is the row where c_b lies
/// along n.
template <class T>
AngularRow<T> plane_distance(const AngularRow<T>& plane, const Vector3<T>& fallback) {
  using std::atan2;
  using std::sqrt;
  const T length2 = plane.J_b.dot(plane.J_b);
  AngularRow<T> row;
  if (!(length2 > T(1e-30))) {
    row.C = plane.C < T(0) ? T(-pi / 2) : T(pi / 2);
    row.J_b = fallback;
    return row;
  }
  const T length = sqrt(length2);
  row.C = atan2(plane.C, length);
  row.J_b = plane.J_b / length;
  return row;
}

/// The plane of the half of the sphere that c_b is in. The document asks by c_a for the middle,
/// which is right only while phi_- is in (-pi, 0) and phi_+ in (0, pi).
template <class T>
const Vector3<T>& nearer_plane(const Wedge<T>& wedge, const Vector3<T>& w, const Vector3<T>& c_b) {
  return cross(wedge.middle, w).dot(c_b) < T(0) ? wedge.n_max : wedge.n_min;
}

/// Whether c_b is farther than a quarter of a turn about w from both sides of a wedge below pi.
template <class T>
bool behind_edge(const Wedge<T>& wedge, const Vector3<T>& w, const Vector3<T>& c_b) {
  return cross(wedge.n_min, w).dot(c_b) < T(0) && cross(w, wedge.n_max).dot(c_b) < T(0);
}

/// C = minus the angle from c_b to the nearer end of the edge (rad, in [-pi/2, 0]), and J_b its exact
/// gradient, a unit vector; c_b is not along w.
template <class T>
AngularRow<T> edge_distance(const Vector3<T>& w, const Vector3<T>& c_b) {
  using std::atan2;
  const T along = w.dot(c_b);
  const Vector3<T> across = cross(c_b, along < T(0) ? Vector3<T>(-w) : w);
  const T length = across.norm();
  AngularRow<T> row;
  row.C = -atan2(length, along < T(0) ? T(-along) : along);
  row.J_b = across / length;
  return row;
}

}  // namespace pintle::equations
