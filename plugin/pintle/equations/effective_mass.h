// Purpose: the inverse effective mass of rows (document, section 2.2), for the general Jacobian
//   J = [-L, -A_a, L, A_b]
// of a constraint between two bodies. L is one vector, not two: a translation of both bodies together
// moves no joint.
#pragma once

#include <pintle/notation.h>

namespace pintle::equations {

/// m^-1 and I^-1 (world) of both bodies.
template <class T>
struct InverseMass {
  T m_a, m_b;                                                                             // (2.5)
  Matrix3<T> I_a, I_b;
};

template <class T>
struct Jacobian {
  Vector3<T> L, A_a, A_b;
};

/// One entry, J_i M^-1 J_j^T, of the inverse effective mass matrix. The document prints I_a for
/// I_b in the last term.
template <class T>
T inverse_effective_mass(const Jacobian<T>& i, const InverseMass<T>& M, const Jacobian<T>& j) {
  return i.L.dot(j.L) * (M.m_a + M.m_b) + i.A_a.dot(M.I_a * j.A_a) + i.A_b.dot(M.I_b * j.A_b);  // (2.6)
}

/// The same of one angular row, A_a = A_b = x and L = 0. The document inverts the product I x, and
/// not I.
template <class T>
T angular_inverse_effective_mass(const InverseMass<T>& M, const Vector3<T>& x) {
  return x.dot(M.I_a * x) + x.dot(M.I_b * x);                                            // (3.17)
}

}  // namespace pintle::equations
