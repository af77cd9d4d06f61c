// Purpose: a row whose impulse does no work on a joint that ends the step as open as it began. The discrete gradient G of C
// over a step (Gonzalez 1996) lies between J of its start and J of its end, and
//   G d = C(end) - C(start),  d the displacement of the bodies in the step                (*)
// exactly, whatever the turn. An impulse lambda along G changes the kinetic energy by at most lambda . G v: nothing
// where C(end) = C(start).
//
// In closed form of points, distances and dot products, by the mean levers of the step: exp(phi) r - r = phi x V(phi) r.
#pragma once

#include <pintle/rows/row.h>
#include <pintle/rows/row_shape.h>
#include <pintle/solver/turn.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Of a body in a step: m, and the rotation vector in rad.
struct Displacement {
  Vector3d x, phi;
  Matrix3d mean;  ///< of its turn (turn.h)

  Displacement(const Vector3d& by, const Vector3d& turn)
      : Displacement(by, turn, meanOfTurn(turn)) {}
  Displacement(const Vector3d& by, const Vector3d& turn, const Matrix3d& mean_of_turn)
      : x(by), phi(turn), mean(mean_of_turn) {}
};

/// J as Row has it: [-L, -A_a, L, A_b].
struct Gradient {
  Vector3d L, A_a, A_b;

  double along(const Displacement& a, const Displacement& b) const {
    return L.dot(b.x - a.x) - A_a.dot(a.phi) + A_b.dot(b.phi);
  }
};

/// A row at the start of a step and at its end.
struct RowOfStep {
  const Row &start, &end;
  const RowShape &start_shape, &end_shape;
};

/// G of the row. `change`: C(end) - C(start), which the closed forms do not need.
Gradient discreteGradient(const RowOfStep& row, double change, const Displacement& a,
                          const Displacement& b);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
