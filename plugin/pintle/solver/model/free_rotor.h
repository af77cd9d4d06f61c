// Purpose: how a body turns that no torque acts on. Its angular momentum L stays, and so its angular velocity I^-1 L does not. Turns about its
// principal axes, each by dt L_i / I_i (of the momentum there), half about x and y, whole about z, and half about y and x again, keep L to
// rounding, and are of second order (Leimkuhler and Reich, Simulating Hamiltonian Dynamics, 8.2).
#pragma once

#include <pintle/solver/model/island.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The turn in a step of length dt, of a body whose principal axes are the columns of `axes`. `inverse_inertia`: about each, 1 / (kg m^2).
/// `w`: rad/s, at the start.
Matrix3d turnOfRotor(const Matrix3d& axes, const Vector3d& inverse_inertia, const Vector3d& w,
                     double dt);
/// The turn of a body in a step of length dt that it begins with w (rad/s): as a rotor, or by w alone, as Bullet turns it.
inline Matrix3d turnOfStep(const IslandBody& body, const Vector3d& w, double dt) {
  return body.isRotor() ? turnOfRotor(inDouble(body.start.getBasis()),
                                      inDouble(body.body->getInvInertiaDiagLocal()), w, dt)
                        : RotationOfStep(w, dt).matrix();
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
