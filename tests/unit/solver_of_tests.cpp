// With PINTLE_TEST_SOLVER=exact the tests' worlds have ExactJointSolver, unless they name another one.
#include <gtest/gtest.h>
#include <pintle/solver/exact_joint_solver.h>
#include <scenes/world.h>

#include <cstdlib>
#include <string>

namespace {

class SolverOfTests : public testing::Environment {
  void SetUp() override {
    const char* const name = std::getenv("PINTLE_TEST_SOLVER");
    if (name == nullptr) return;
    ASSERT_EQ(std::string(name), "exact");
    scenes::default_solver() = [] { return std::make_unique<pintle::ExactJointSolver>(); };
  }
};
[[maybe_unused]] const auto* const environment = testing::AddGlobalTestEnvironment(new SolverOfTests);

}  // namespace
