// The solver that a run of the tests is about.
#pragma once

#include <gtest/gtest.h>

/// Whether joints of Pintle's are solved by ExactJointSolver, on which joints that are open move poses: velocities close nothing.
/// Stock joints never are: what is compared is ours on it with stock as it is.
bool onExactSolver();

/// A test of what only Bullet's own solver does; `why` the exact one does not.
#define PINTLE_SKIP_ON_EXACT_SOLVER(why) \
  if (onExactSolver()) GTEST_SKIP() << "On the exact solver: " << why
