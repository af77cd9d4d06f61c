// Purpose: the point distance constraint (document, section 3.1.1): a rod of length l between p_a
// and p_b, or as an inequality a rope or a strut.
//   C = |d| - l                                            m
//   J = [-n, -(r_a x n), n, r_b x n]
// Terms, world space: d = p_b - p_a, n = d/|d|, levers r_a and r_b to the anchors. The row's
// impulse lies in the line of the anchors, so it conserves angular momentum at any error. Its K is
// inverse_effective_mass.
#pragma once

#include <pintle/equations/position.h>

namespace pintle::equations {

template <class T>
struct Distance {
  Vector3<T> n;
  T length;  ///< |d|, m
};

/// Points that coincide have no direction: n is then the unit vector `fallback`.
template <class T>
Distance<T> distance(const Vector3<T>& d, const Vector3<T>& fallback) {
  using std::sqrt;
  // Scaled, so that the square neither vanishes nor overflows.
  const T scale = d.cwiseAbs().maxCoeff();
  if (!(scale > T(0))) return {fallback, T(0)};
  const Vector3<T> e = d / scale;
  const T size = sqrt(e.dot(e));
  return {e / size, scale * size};                                                        // (3.1)
}

template <class T>
LinearRow<T> distance_row(const Distance<T>& to, T l, const Vector3<T>& r_a,
                          const Vector3<T>& r_b) {
  LinearRow<T> row;
  row.C = to.length - l;                                                                  // (3.2)
  row.J = position_row(to.n, r_a, r_b);                                                   // (3.3)
  return row;
}

/// The part of d^2/dt^2 of |d| that points gain as they pass each other at the relative velocity v:
/// good for a step in which they pass by less than |d|. The other part is that of the centripetal
/// acceleration, n . position_curvature.
template <class T>
T passing_curvature(const Distance<T>& to, const Vector3<T>& v) {
  if (!(to.length > T(0))) return T(0);
  const Vector3<T> across = cross(to.n, v);
  return across.dot(across) / to.length;
}

}  // namespace pintle::equations
