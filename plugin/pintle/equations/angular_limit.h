// Purpose: the limit of the angle about an axis of body a (document, section 3.2.8).
//   C = theta - phi,  J_b = c_a, J_a = -J_b
// Terms, world space: {a_a, b_a, c_a} the joint frame of body a, a_b the x of that of body b, theta
// (rad, in (-pi, pi]) the angle of a_b about c_a. The printed row is the gradient only while a_b is
// normal to c_a: its error is the tangent of a_b's tilt, 0.18 at 10 degrees and 5.7 at 80. The
// exact one is that of angle_about(c_a, a_a, a_b), whose unit form is good at any tilt.
#pragma once

#include <pintle/equations/angle_about.h>
#include <pintle/equations/quaternion_hinge.h>

namespace pintle::equations {

template <class T>
struct Basis {
  Vector3<T> a, b, c;                                                                    // (3.45)
};

/// The document's row, of a limit phi (rad).
template <class T>
AngularRow<T> angular_limit_row(const Basis<T>& frame_a, const Vector3<T>& a_b, T phi) {
  AngularRow<T> row;
  row.C = angle_about(frame_a.c, frame_a.a, a_b).angle() - phi;                          // (3.46)
  row.J_b = frame_a.c;                                                                   // (3.47)
  return row;
}

}  // namespace pintle::equations
