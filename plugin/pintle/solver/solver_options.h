// Purpose: tolerances and bounds of the exact solver, each with its unit, its default, and what it is for.
#pragma once

#include <pintle/precision.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Of sums in double precision, beside the largest of what is added: less may be rounding.
constexpr double rounding_share = 1e-9;

/// Fraction of what the bodies of a contact would give way alone: where joints leave less of it, and the bodies have no way out
/// without their joints, equalities hold the contact. Robots whose links overlap at their joints stay as calm as on Bullet's solver from
/// 0.005 to 0.04, and may blow up at 0.003.
constexpr double held_share = 1e-2;

/// Times the impulses of the last step: with so many at most a solve begins, where these are too little still. By doubling a motor gives all
/// its bound to a wall within a second at 10 iterations, whatever that is; with 1 one of 100 N m s does not. Without a bound, 9 of 100 machines of
/// links that collide are wilder than on Bullet's solver, by up to 240 times its energy.
constexpr double max_warm_start = 2;

/// Of the velocities to which forces lead: less may be rounding, some thousands of roundings of one number.
constexpr double rounding_of_velocities = 1e-12;
/// Of the energy to which forces alone would lead: what joints give may be rounding, while it is less. Of each body it is twice as much as
/// of its velocity, and a few bodies add.
constexpr double rounding_of_work = 10 * rounding_of_velocities;

/// Of the inertia about an axis about which a body does not turn at all: so many times the least one. The body follows rows about that
/// axis by less than rounding_share, and in world space its matrix still has four digits of the least one.
constexpr double unturned_inertia = 1e12;

/// Of a row that its joint has along other directions at the end of the step: where each of those is less than this part of it, it has
/// turned away from all of them, and is taken as it was at the start.
constexpr double least_part_along = 0.1;

/// (w dt)^2 of a swing of w rad/s, from which on explicit steps are not stable: there a root of z^2 + ((w dt)^2 - 2) z + 1 = 0 leaves
/// the unit circle.
constexpr double unstable_swing = 4;

/// Times newton_tolerance, over the length of a step: so fast rows may be where a step ends. A solve leaves them open by that tolerance, and what
/// closes it is no velocity of theirs. At 1 a taut cable of 30 links climbs in single precision, by 5 J a second; at 10 a limb that lies on
/// its limits quivers, at 1e-3 rad/s.
constexpr double end_margin = 3;

/// Rows that differ by less, relative to them, are the same: a step begins with those with which the last one ended, but for rounding.
constexpr double same_row = 1e-12;

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
