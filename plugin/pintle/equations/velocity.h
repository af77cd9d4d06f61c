// Purpose: the velocities of two bodies (document, section 1.2: v) and of the points at their
// anchors (appendix B.2). World space; r_a and r_b are levers from the centres of mass.
#pragma once

#include <pintle/notation.h>

namespace pintle::equations {

template <class T>
struct Velocity {
  Vector3<T> v_a, w_a, v_b, w_b;  ///< m/s, rad/s
};

/// Velocity of the point at r of a body.
template <class T>
Vector3<T> point_velocity(const Vector3<T>& v, const Vector3<T>& w, const Vector3<T>& r) {
  return v + cross(w, r);                                                                 // (B.8)
}

/// Velocity of the point at r_b of body b, relative to that at r_a of body a.
template <class T>
Vector3<T> relative_velocity(const Velocity<T>& v, const Vector3<T>& r_a, const Vector3<T>& r_b) {
  return point_velocity(v.v_b, v.w_b, r_b) - point_velocity(v.v_a, v.w_a, r_a);           // (B.9)
}

}  // namespace pintle::equations
