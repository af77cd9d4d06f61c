// Purpose: the impulse that satisfies one row, rigid or soft (document, section 2).
//   lambda  impulse of the row, in the document's sign (body b positive)
//   K       J M^-1 J^T of the row: its inverse effective mass
//   Jv      velocity of the row before the impulse
//   c       position error of the row, dt the time step
// Units are those of the row: m and N s for a linear one, rad and N m s for an angular one.
#pragma once

namespace pintle::equations {

/// The impulse after which J v + b = 0.
template <class T>
T impulse(T K, T Jv, T b) {
  return (Jv + b) / -K;                                                                   // (2.4)
}

/// The same as a force over the whole step, which most other works call lambda.
template <class T>
T force(T K, T Jv, T b, T dt) {
  return impulse(K, Jv, b) / dt;                                                          // (B.5)
}

/// Velocity bias that corrects the fraction beta of the error c in one step.
template <class T>
T baumgarte(T c, T beta, T dt) {
  return c / dt * beta;                                                                   // (2.7)
}

/// The softness gamma and the Baumgarte factor beta of a spring, as they stand in
/// J v + gamma lambda / dt + beta c / dt = 0: the implicit Euler step of a spring and damper.
template <class T>
struct Softness {
  T gamma;
  T beta;
};

/// From stiffness k and damping d. The document does not give gamma and beta; these follow from
/// lambda / dt = -k (c + dt J v) - d J v. k = d = 0 is no spring, and has no softness.
template <class T>
Softness<T> softness(T k, T d, T dt) {
  return {T(1) / (dt * k + d), dt * k / (dt * k + d)};                                    // (2.9)
}

/// The same from the angular frequency w (rad/s, > 0) and the damping ratio z (>= 0) that the
/// row alone would have: k = w^2 / K, d = 2 z w / K. Written so that K may be anything and w large.
template <class T>
Softness<T> softness_by_frequency(T w, T z, T dt, T K) {
  const T s = dt * w + 2 * z;
  return {K / (w * s), dt * w / s};
}

/// K of a soft row. In block form gamma/dt belongs on the diagonal only.
template <class T>
T soft_effective_mass(T K, T gamma, T dt) {
  return K + gamma / dt;                                                                 // (2.12)
}

/// The impulse of a soft row: K is that of soft_effective_mass.
template <class T>
T soft_impulse(T K, T Jv, T beta, T c, T dt) {
  return (-Jv - beta * c / dt) / K;                                                      // (2.13)
}

}  // namespace pintle::equations
