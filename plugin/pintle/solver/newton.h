// Purpose: Newton's iteration for the velocities v with which a component of joints ends the step, and the impulses lambda:
//   M (v - v*) = G(v)^T lambda,   u(v) and lambda of each row on its law (axis_law.h)
// u the mean velocity of a row over the step. Where the impulses act is a tier's choice (Tier).
#pragma once

#include <pintle/solver/island.h>
#include <pintle/solver/linear/fronts.h>
#include <pintle/solver/solver_options.h>
#include <pintle/solver/turn.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

enum class Tier {
  start,    ///< rows of the start, which hold at the end of the step (SHAKE; Ryckaert 1977)
  gradient  ///< the discrete gradient (discrete_gradient.h): never gains
};

/// Where a body ends the step.
struct BodyAtEnd {
  Vector6d v;
  Turn turn;
  btTransform pose;
};

/// A row, if the step ends like this.
struct RowAtEnd {
  double u;       ///< its velocity
  RowJacobian J;  ///< du/dv
  RowJacobian G;  ///< along which its impulse acts
};

/// The state of the iteration of one component.
struct Iterate {
  /// s: rows hold at this time of the step. At its end, or earlier: with 0 in velocity, which is a linear problem. By the
  /// discrete gradient up to then joints never gain either.
  double horizon = 0;
  std::vector<BodyAtEnd> bodies;
  std::vector<RowAtEnd> rows;
  std::vector<double> lambda;  ///< N s, N m s
};

/// What the last iteration did.
struct NewtonReport {
  bool converged = false;
  int steps = 0, factors = 0;
  double error = 0;  ///< the largest, m or rad
};

struct Workspace {
  Iterate now, next;
  std::vector<LawPiece> pieces, next_pieces;
  std::vector<Matrix3d> stiffness;  ///< of each body: added to its inertia (tier start)
  std::vector<double> correction, simplified, residual;
  std::vector<int> sizes;
};

/// Bodies and rows of the component at velocities `at.bodies[].v`.
void moveTo(const Island& island, const Component& component, Tier tier, Iterate& at);

/// The factor of [M -J^T; J 0], J the rows that `acts` names, as they are at the end of the step that `work.now` leads to: of the
/// least motion, in the metric of the masses, that moves rows as asked. Returns false where there is none.
bool factoriseMotion(const Island& island, const Component& component, const SolverOptions& options,
                     const std::vector<char>& acts, Fronts& fronts, Workspace& work);

/// Solves the component from `work.now` (velocities and impulses) to there.
NewtonReport solve(const Island& island, const Component& component, Tier tier,
                   const SolverOptions& options, Fronts& fronts, Workspace& work);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
