// Purpose: what an exact solver did in a step.
#pragma once

#include <pintle/precision.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Counts and energies are sums over the components of the world, which are what hangs together by joints and is awake; `tier`,
/// `residual` and `open` are those of the worst one.
struct StepReport {
  int components = 0;      ///< that were solved
  int newton_steps = 0;    ///< also passes over contacts and rows with bounds
  int factorisations = 0;  ///< of joints: what takes most of a step's time
  /// How it was solved. 1: joints hold at the end of the step, by velocities alone. 2: they hold in velocity, and poses are brought
  /// together; so among contacts, and where 1 would give energy. 3: rows are solved one by one, as Bullet solves them. 0: no joints.
  int tier = 0;
  int second_tier = 0;  ///< solves of tier 2
  int one_by_one = 0;   ///< and of tier 3
  /// Components of which joints or limits missed what they were to reach in this step by more than their tolerance.
  int not_converged = 0;
  /// Components of which the last pass changed contacts, or rows with bounds, by more than theirs.
  int unsettled = 0;
  /// Components that are left to forces alone, for all that contacts join: impulses lead to numbers that Bullet's precision does not
  /// hold. They are not converged, either.
  int overflowed = 0;
  /// Settings of upgraded stock joints that are not used, as their numbers are not finite, or below zero: the solver's whyIgnored()
  /// names them.
  int ignored_settings = 0;
  double residual =
      0;  ///< m or rad: the most by which a joint missed what it was to reach in this step
  double open = 0;  ///< m or rad: the most that a joint of Pintle's was open before the step
  /// J: what joints gave, without their motors and springs. They take what stops and friction take, and give what rounding and poses
  /// that are moved against the weight do.
  double work = 0;
  double ledger =
      0;  ///< J: `work` of all steps so far, as far as it is within a share of the kinetic energy that recent steps have left
  double ledger_limit = 0;  ///< J: what `ledger` may be in this step (SolverOptions::ledger_share)

  /// Of several components, or islands.
  StepReport& operator+=(const StepReport& of) {
    components += of.components;
    newton_steps += of.newton_steps;
    factorisations += of.factorisations;
    tier = std::max(tier, of.tier);
    second_tier += of.second_tier;
    one_by_one += of.one_by_one;
    not_converged += of.not_converged;
    unsettled += of.unsettled;
    overflowed += of.overflowed;
    ignored_settings += of.ignored_settings;
    residual = std::max(residual, of.residual);
    open = std::max(open, of.open);
    work += of.work;
    ledger += of.ledger;
    ledger_limit += of.ledger_limit;
    return *this;
  }
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
