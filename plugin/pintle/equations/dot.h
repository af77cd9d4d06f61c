// Purpose: the dot product of a direction of body a with one of body b as a constraint (document,
// section A.1.1); the cone, the wedge, the universal and the constant velocity joint are made of
// it.
//   C = u.v                u fixed in body a, v fixed in body b; world space
//   J_b = v x u, J_a = -J_b
#pragma once

#include <pintle/equations/quaternion_hinge.h>

namespace pintle::equations {

/// (A.1) with the derivatives w_a x u and w_b x v.
template <class T>
AngularRow<T> dot_row(const Vector3<T>& u, const Vector3<T>& v) {
  AngularRow<T> row;
  row.C = u.dot(v);
  row.J_b = cross(v, u);                                                                 // (A.1)
  return row;
}

/// d^2/dt^2 of u as seen from body b, at constant w_a and w_b: its product with any v of body b is
/// that of u.v.
template <class T>
Vector3<T> dot_acceleration(const Vector3<T>& u, const Vector3<T>& w_a, const Vector3<T>& w_b) {
  const Vector3<T> du = cross(w_a, u);
  return cross(w_a, du) + cross(w_b, Vector3<T>(cross(w_b, u) - T(2) * du));
}

/// d^2/dt^2 of u.v at constant w_a and w_b.
template <class T>
T dot_curvature(const Vector3<T>& u, const Vector3<T>& w_a, const Vector3<T>& v,
                const Vector3<T>& w_b) {
  return v.dot(dot_acceleration(u, w_a, w_b));
}

}  // namespace pintle::equations
