// Purpose: contacts and friction on bodies that joints hold: projected Gauss-Seidel on the contacts alone, each of which sees how
// the joints answer (the Schur complement of Newton's equations). Each Newton step is solved together with the contacts.
#pragma once

#include <pintle/solver/newton.h>

#include <BulletDynamics/ConstraintSolver/btSolverConstraint.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A row of Bullet's: u = J v, u + softness p = target, lower <= p <= upper.
struct ContactRow {
  std::array<int, 2> body;  ///< of the island; -1: one that does not move
  RowJacobian J;
  double target, softness, lower, upper;
  int normal;       ///< of friction: the row whose impulse bounds it; -1: its bounds are its own
  double friction;  ///< of friction: its coefficient
  double impulse;   ///< N s
  btSolverConstraint* from;

  /// Its impulse at which it is satisfied, where it has the velocity u now.
  double meet(double u, double K) const {
    return std::min(std::max(impulse - (u + softness * impulse - target) / (K + softness), lower),
                    upper);
  }
};
/// Friction by its contact's impulse.
inline void boundFriction(const std::vector<ContactRow>& rows, ContactRow& row) {
  if (row.normal < 0) return;
  row.upper = row.friction * rows[size_t(row.normal)].impulse;
  row.lower = -row.upper;
}

/// A component among contacts.
struct ContactPart {
  const Component* component;
  Fronts* fronts;
  Workspace* work;  ///< `now`: where it begins
};

/// Solves contacts with all components that they touch, by the discrete gradient. `velocities`: of all bodies of the island, m/s
/// and rad/s: of those without joints they are found here.
NewtonReport solveAmongContacts(const Island& island, std::vector<ContactPart>& parts,
                                std::vector<ContactRow>& rows, const SolverOptions& options,
                                std::vector<Vector6d>& velocities);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
