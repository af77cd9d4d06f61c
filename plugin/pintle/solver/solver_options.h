// Purpose: tolerances and bounds of the exact solver, each with its unit, its default, and what it is for.
#pragma once

#include <pintle/precision.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Tolerances and bounds of the exact solver. `check` says what each may be.
struct SolverOptions {
  /// m and rad: how far a joint may be from its goal by the velocities with which the step ends. The energy that a solve creates
  /// does not depend on it. A row stays on its piece of its law up to as much.
  double newton_tolerance = sizeof(Scalar) > 4 ? 1e-9 : 1e-6;
  /// m and rad: how far a joint may be open. What is more is closed by moving poses.
  double pose_tolerance = sizeof(Scalar) > 4 ? 1e-9 : 1e-6;
  /// m and rad: what is open by less is as good as closed, where rounding leaves no more.
  double loose_pose_tolerance = sizeof(Scalar) > 4 ? 1e-7 : 1e-6;
  /// Iterations of the first tier, and of the correction of poses.
  int max_iterations = 30;
  /// Factors that moving the poses of a component may take in a step, each of where the last one has led, a quarter of them for equalities alone; as
  /// many for its velocities at the end; to find which rows with bounds act, a search may take half as many. What is left open goes on in the next step. From 2 on, bodies may go the way of
  /// the step in parts, and velocities may be solved for again, where the load that was found makes a body unstable with the inertia
  /// that was foreseen.
  int max_factors = 20;
  /// Such a factor is kept while a step with it leaves less than this part open.
  double contraction = 0.3;
  /// Steps with a new one are halved down to this part.
  double least_part = 1. / 64;
  /// m and rad: what a pass over contacts or rows with bounds may still change.
  double contact_tolerance = 1e-5;
  /// Passes over all rows one by one, where nothing else is left and nothing touches. Those over contacts and rows with bounds are as many as the
  /// world's iterations.
  int max_sweeps = 100;
  /// Blocks of three rows: contacts follow paths of up to so many through the factor of the joints, from a body to the root. Those of
  /// chains, rings and trees are hardly ever longer: they grow with the logarithm of the joints. Longer ones, of nets of some hundred bodies, are
  /// followed where all of them take no more memory than the matrix of the joints. Else, as under a net that lies on the ground, it is quicker
  /// to solve the joints after each pass.
  int longest_path = 64;
  /// Softness of the joints of loops, relative to their own K, while they bear nothing: rows that repeat each other share their
  /// impulse, and those that contradict each other give way.
  double dependent_softness = 1e-8;
  /// newton_tolerance is so many times the most by which they give under the load that they bear. So what gives is less than what a
  /// solve may leave.
  double dependent_margin = 10;
  /// Of rows of one joint that repeat each other: the least pivot, relative to K.
  double least_pivot = 1e-13;
  /// Of the largest recent kinetic energy of a component: what its joints may have taken or given in sum.
  double ledger_share = 0.01;
  /// (w dt)^2 of a body that swings about its joints' load by w rad/s, up to which it is left as it is. Explicit steps are stable
  /// below unstable_swing. A faster one gets as much inertia as makes it swing no faster: no step resolves it.
  double stable_swing = 2;
  /// Gravity acts half before and half after bodies move (Verlet), and bodies with any of Bullet's gyroscopic flags turn as free rotors do: so motion
  /// is of second order, and free fall exact. This is for bodies that nothing touches: alone, or with joints that give nothing. Others move as
  /// Bullet moves them.
  bool second_order = false;
};

/// Throws std::invalid_argument, with the field, its value and what is wrong, if one is out of its range.
void check(const SolverOptions& options);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
