// Purpose: the limit of the swing between two axes (document, section 3.2.6): the circular cone, in
// the document's form and in a conditioned one, and the cone over four quarter ellipses.
// Terms, world space: c_a and c_b the cone's axis in body a and in body b, J_a = -J_b.
//
// The ellipses' coordinate g is the distance of the swing's rotation vector sigma, as a point of
// the plane normal to c_a, from the boundary (rad; > 0 outside). Other coordinates with the same
// boundary, such as f - 1 with f^2 = (s_1/a)^2 + (s_2/b)^2, are a/b times too small or too large
// for a flat ellipse: a limit that looks ahead, inside by the thickness of the ellipse, would take
// the boundary for far off, and a correction would overshoot. The distance has a gradient of unit
// length in that plane, the ellipse's normal at the nearest point, so its row is
//   J_b = swing_row(sigma, c_a, n_1 e_1 + n_2 e_2),   1 <= |J_b| <= swing/sin(swing)
// and it costs four or five Newton steps (sixteen at most, of those tried). It is exact outside,
// and inside up to where two points of the boundary are as near: there the row is that of one of
// them. (With unequal spans on both sides of 0 only the quarter that sigma is in is looked at, so
// that deep inside the distance is that from the whole ellipse which this quarter is of.)
//
// Bullet's btConeTwistConstraint has this boundary with sigma in the frame of body b: exchange the
// bodies, and J_b becomes J_a. Its span 1 is that about the frame's z, its span 2 that about y.
#pragma once

#include <pintle/equations/dot.h>
#include <pintle/equations/swing_twist.h>

namespace pintle::equations {

/// The document's row: C >= 0 inside the half angle phi (rad), in (0, pi). |J| is the sine of the
/// swing: nothing at 0 and at pi.
template <class T>
AngularRow<T> cone_dot_row(const Vector3<T>& c_a, const Vector3<T>& c_b, T phi) {
  using std::cos;
  AngularRow<T> row = dot_row(c_a, c_b);                                         // (3.36), (3.39)
  row.C -= cos(phi);                                                                     // (3.37)
  return row;
}

/// The conditioned form: C = swing - phi, rad, > 0 outside; a unit row at any swing.
template <class T>
AngularRow<T> cone_row(const Swing<T>& s, const Vector3<T>& c_a, T phi) {
  return {swing_axis(s, c_a), s.angle - phi};
}

/// The largest swings (rad, > 0) about +e_1, -e_1, +e_2 and -e_2.
template <class T>
struct SwingSpans {
  T above_1, below_1, above_2, below_2;
};

/// Signed distance from an ellipse, > 0 outside, and its gradient.
template <class T>
struct EllipseDistance {
  T distance, n_0, n_1;
};

/// Of the point (s_0, s_1), both >= 0, from the ellipse with the semiaxes e_0 >= e_1 > 0. The
/// nearest point is e_i (n_0, n_1) with n_0 = r z_0/(u + r - 1), n_1 = z_1/u, z_i = s_i/e_i, r =
/// (e_0/e_1)^2 and u > 0 such that n_0^2 + n_1^2 = 1: a convex, falling function of u, so that
/// Newton's method from the left of its root rises to it. u - 1 is the distance but for a factor.
template <class T>
EllipseDistance<T> ellipse_distance(T s_0, T s_1, T e_0, T e_1) {
  using std::sqrt;
  const T z_0 = s_0 / e_0, z_1 = s_1 / e_1, r = (e_0 / e_1) * (e_0 / e_1);
  const T f = sqrt(z_0 * z_0 + z_1 * z_1);
  const bool outside = f > T(1);
  // Two lower bounds of u; for a circle one of them is the root.
  const T round = outside ? f : r * f + (T(1) - r), flat = outside ? r * z_0 + (T(1) - r) : z_1;
  T u = round > flat ? round : flat, n_0 = T(0), n_1 = T(1);
  for (int i = 0; u > T(0) && i < 30; ++i) {
    n_0 = r * z_0 / (u + (r - T(1)));
    n_1 = z_1 / u;
    const T slope = n_0 * n_0 / (u + (r - T(1))) + n_1 * n_1 / u;
    const T next = u + (n_0 * n_0 + n_1 * n_1 - T(1)) / (T(2) * slope);
    // The first step may fall: rounding may have lifted the bounds above the root.
    if (i > 0 && !(next > u)) break;
    u = next;
  }
  if (!(u > T(0)) && r > T(1)) {
    // On the long axis between the centres of curvature: both sides are as near, and one will do.
    n_0 = r * z_0 / (r - T(1));
    n_1 = n_0 < T(1) ? sqrt(T(1) - n_0 * n_0) : T(0);
  }
  if ((u > T(1)) != outside) u = T(1);
  const T g_0 = n_0 / e_0, g_1 = n_1 / e_1, length = sqrt(g_0 * g_0 + g_1 * g_1);
  return {(u - T(1)) * e_1 * e_1 * length, g_0 / length, g_1 / length};
}

/// (s_1/a)^2 + (s_2/b)^2 of the quarter that the point (s_1, s_2) is in: above 1 outside.
template <class T>
T cone_ratio2(T s_1, T s_2, const SwingSpans<T>& spans) {
  const T z_1 = s_1 / (s_1 < T(0) ? spans.below_1 : spans.above_1);
  const T z_2 = s_2 / (s_2 < T(0) ? spans.below_2 : spans.above_2);
  return z_1 * z_1 + z_2 * z_2;
}

/// The distance g of the point (s_1, s_2) from the four quarters, and its gradient n.
template <class T>
struct ConeDistance {
  T distance, n_1, n_2;
};

template <class T>
ConeDistance<T> cone_distance(T s_1, T s_2, const SwingSpans<T>& spans) {
  const T sign_1 = s_1 < T(0) ? T(-1) : T(1), sign_2 = s_2 < T(0) ? T(-1) : T(1);
  const T a = s_1 < T(0) ? spans.below_1 : spans.above_1;
  const T b = s_2 < T(0) ? spans.below_2 : spans.above_2;
  const bool long_1 = a >= b;
  const EllipseDistance<T> to = long_1 ? ellipse_distance<T>(sign_1 * s_1, sign_2 * s_2, a, b)
                                       : ellipse_distance<T>(sign_2 * s_2, sign_1 * s_1, b, a);
  return {to.distance, sign_1 * (long_1 ? to.n_0 : to.n_1), sign_2 * (long_1 ? to.n_1 : to.n_0)};
}

/// C = g, rad, > 0 outside; e_1 and e_2 unit vectors normal to c_a and to each other, in body a.
template <class T>
AngularRow<T> elliptic_cone_row(const Swing<T>& s, const Vector3<T>& c_a, const Vector3<T>& e_1,
                                const Vector3<T>& e_2, const SwingSpans<T>& spans) {
  const auto to = cone_distance<T>(s.sigma.dot(e_1), s.sigma.dot(e_2), spans);
  return {swing_row(s, c_a, Vector3<T>(to.n_1 * e_1 + to.n_2 * e_2)), to.distance};
}

/// The tangent to the boundary that the next dt leads to, with w = w_b - w_a: C = n.(s - P), n and P
/// of the point s + dt ds/dt. The boundary is convex and lies behind it; a limit that looks half a
/// step ahead follows the boundary around, tips and flat quarters included, where the nearest point
/// of now is soon far behind. Forces may add `push` (rad) to the motion: the point is taken farther
/// out by as much. At rest in a tip sharper than that the normal then turns as slowly as the step can
/// follow, and the tip does not rattle; it yields by less than push.
template <class T>
AngularRow<T> elliptic_cone_row_ahead(const Swing<T>& s, const Vector3<T>& c_a,
                                      const Vector3<T>& e_1, const Vector3<T>& e_2,
                                      const SwingSpans<T>& spans, const Vector3<T>& w, T dt,
                                      T push) {
  using std::sqrt;
  const Vector3<T> row_1 = swing_row(s, c_a, e_1), row_2 = swing_row(s, c_a, e_2);
  const T s_1 = s.sigma.dot(e_1), s_2 = s.sigma.dot(e_2);
  T p_1 = s_1 + dt * row_1.dot(w), p_2 = s_2 + dt * row_2.dot(w);
  const T length2 = p_1 * p_1 + p_2 * p_2;
  if (length2 > T(1e-12)) {
    const T stretch = T(1) + push / sqrt(length2);
    p_1 *= stretch;
    p_2 *= stretch;
  }
  const auto to = cone_distance<T>(p_1, p_2, spans);
  return {to.n_1 * row_1 + to.n_2 * row_2,
          to.distance - to.n_1 * (p_1 - s_1) - to.n_2 * (p_2 - s_2)};
}

}  // namespace pintle::equations
