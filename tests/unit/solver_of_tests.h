// The solver that a run of the tests is about.
#pragma once

#include <gtest/gtest.h>

/// Whether joints of Pintle's are solved by ExactJointSolver or PassiveJointSolver. Stock joints never are: what is
/// compared is ours on it with stock as it is.
bool onExactSolver();
/// Of these PassiveJointSolver, of which joints that are open move poses: velocities close nothing.
bool onPassiveSolver();

/// A test of what only Bullet's own solver does; `why` the exact one does not.
#define PINTLE_SKIP_ON_EXACT_SOLVER(why) \
  if (onExactSolver()) GTEST_SKIP() << "On the exact solver: " << why
#define PINTLE_SKIP_ON_PASSIVE_SOLVER(why) \
  if (onPassiveSolver()) GTEST_SKIP() << "On the passive solver: " << why
