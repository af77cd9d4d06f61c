// Purpose: the angle of a direction of body b about an axis of body a (document, section A.2.1),
// for the wedge, the angular limit and the angles of shafts.
//   angle = of v about w, right-handed, zero where v is on the reference's side of w
//   J_b   = w - (v.w) u/|u|^2, u = v - (v.w) w; J_a = -J_b
// Terms, world space: unit vectors w (axis) and reference fixed in body a, v fixed in body b. The
// reference may be at any angle to w. J_b is 1/|u| long: it has no bound where v comes to lie along
// w, and the angle is nothing there. |u| J_b is a unit vector everywhere, so rows are made of it,
// with |u| times the error for C.
#pragma once

#include <pintle/notation.h>

#include <cmath>

namespace pintle::equations {

/// Both coordinates of the direction: an angle that counts its turns needs them.
template <class T>
struct AngleAbout {
  T x, y;           ///< the angle is atan2(y, x)
  T length;         ///< |u|, the sine of the angle between v and w
  Vector3<T> unit;  ///< |u| J_b: of unit length

  /// rad, in (-pi, pi]; 0 where there is none.
  T angle() const {
    using std::atan2;
    return atan2(y + T(0), x + T(0));  // -0 is +0: half a turn is +pi, nothing is 0
  }
  /// The exact J_b, where there is one.
  Vector3<T> J_b() const { return unit / length; }
};

/// The document's {x, y, z} of (A.6) is left-handed: w x reference is its z, minus that of a
/// right-handed basis. Along w the row's direction is that at angle zero, so that it is definite.
template <class T>
AngleAbout<T> angle_about(const Vector3<T>& w, const Vector3<T>& reference, const Vector3<T>& v) {
  using std::sqrt;
  const Vector3<T> u = cross(cross(w, v), w), side = cross(w, reference);
  AngleAbout<T> to;
  to.x = reference.dot(u);
  to.y = side.dot(v);                                                                    // (A.6)
  const T length2 = u.dot(u), side2 = side.dot(side);
  // Squares below this are those of a float's rounding, or no longer normal numbers.
  constexpr double kNothing = 1e-30;
  if (length2 > T(kNothing)) {
    to.length = sqrt(length2);
    to.unit = to.length * w - v.dot(w) / to.length * u;
    return to;
  }
  to.x = to.y = to.length = T(0);
  const Vector3<T> zero =
      side2 > T(kNothing) ? Vector3<T>(cross(side, w) / sqrt(side2)) : any_tangent(w);
  to.unit = -v.dot(w) * zero;
  return to;
}

}  // namespace pintle::equations
