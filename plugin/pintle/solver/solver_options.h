// Purpose: every number that the passive solver chooses, with its unit, its default, and what it is for.
#pragma once

#include <pintle/precision.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct SolverOptions {
  /// m and rad: how far a joint may be from its goal by the velocities with which the step ends. The energy that a solve creates
  /// does not depend on it.
  double newton_tolerance = sizeof(Scalar) > 4 ? 1e-9 : 1e-6;
  /// m and rad: how far a joint may be open. What is more is closed by moving poses.
  double pose_tolerance = sizeof(Scalar) > 4 ? 1e-9 : 1e-6;
  /// Of the momentum: what is left of M (v - v*) = G^T lambda, against M v*.
  double momentum_tolerance = 1e-7;
  /// The same where Newton's iteration gets no further. In single precision joints measure angles to 1e-7 rad, and where G bends
  /// with them is known to a part of 1e-4.
  double stalled_momentum_tolerance = sizeof(Scalar) > 4 ? 1e-7 : 1e-4;
  /// Of the velocities: a correction below this is rounding.
  double rounding = 1e-10;
  /// Newton steps of a tier, and factors. The second tier follows where the first one gives up, and velocities alone where the
  /// second one does.
  int max_newton_iterations = 30;
  int max_first_tier_factors = 4;
  int max_second_tier_factors = 12;
  /// The same among contacts, where a step is solved no better than its friction: m and rad, and of the momentum.
  double contact_tolerance = 1e-5;
  double contact_momentum_tolerance = 1e-4;
  int max_contact_sweeps = 100;
  /// Newton steps in a row that may change which bounds act. Then it is found by projected Gauss-Seidel, which does not cycle.
  int max_set_changes = 3;
  int max_sweeps = 1000;
  /// Digits that a new factor gains. The last one is kept while its steps gain as many for less.
  double digits_of_factor = 2;
  /// Softness of the joints of loops, relative to their own 1 / K, while they bear nothing: rows that repeat each other share their
  /// impulse, and those that contradict each other give way. Under a load by a tenth of the tolerance.
  double dependent_softness = 1e-8;
  /// Of rows of one joint that repeat each other: the least pivot, relative to 1 / K.
  double least_pivot = 1e-13;
  /// Of the largest recent kinetic energy of a component: what its joints may have taken or given in sum.
  double ledger_share = 0.01;
  /// (w dt)^2 of a body that swings about its joints' load by w rad/s, up to which the first tier leaves it as it is. Explicit steps
  /// are stable below 4. A faster one gets as much inertia as makes it swing no faster: no step resolves it.
  double stable_swing = 2;
  /// m and rad: an error up to which poses are corrected by the factor with which the step was solved.
  double largest_residue = 1e-6;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
