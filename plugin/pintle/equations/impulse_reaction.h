// Purpose: the impulse-based reaction model (document, appendices B.2 and B.3): what an impulse
// does to two bodies, and the impulse of a collision with restitution. Terms: J the row of the
// contact (contact_row), K = inverse_effective_mass of J, J v the velocity at which the contact
// opens (m/s, negative as it closes), lambda along n on body b (N s).
#pragma once

#include <pintle/equations/effective_mass.h>
#include <pintle/equations/impulse.h>
#include <pintle/equations/velocity.h>

namespace pintle::equations {

/// J v: the rate of the row's position error.
template <class T>
T row_velocity(const Jacobian<T>& J, const Velocity<T>& v) {
  return J.L.dot(v.v_b - v.v_a) - J.A_a.dot(v.w_a) + J.A_b.dot(v.w_b);
}

/// The velocities after the impulse lambda of any row.
template <class T>
Velocity<T> after_impulse(const Velocity<T>& v, const InverseMass<T>& M, const Jacobian<T>& J,
                          T lambda) {
  Velocity<T> after;
  after.v_a = v.v_a - M.m_a * lambda * J.L;                                               // (B.6a)
  after.v_b = v.v_b + M.m_b * lambda * J.L;                                               // (B.6b)
  after.w_a = v.w_a - lambda * (M.I_a * J.A_a);                                           // (B.7a)
  after.w_b = v.w_b + lambda * (M.I_b * J.A_b);                                           // (B.7b)
  return after;
}

/// Velocity bias after which a contact opens at e times the velocity Jv at which it closed.
template <class T>
T restitution(T Jv, T e) {
  return e * Jv;                                                                          // (B.10)
}

/// The impulse of a collision with the coefficient of restitution e (0 to 1). On the way to it the
/// document has I_a for I_b; its denominator is K.
template <class T>
T reaction_impulse(T K, T Jv, T e) {
  return impulse(K, Jv, restitution(Jv, e));                                              // (B.13)
}

}  // namespace pintle::equations
