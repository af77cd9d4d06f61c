// With PINTLE_TEST_SOLVER=exact the tests' worlds have that solver, unless they name another one.
#include "solver_of_tests.h"

#ifdef PINTLE_WITHOUT_EXACT_SOLVER  // a Bullet that is older

bool onExactSolver() { return false; }

#else

#include <pintle/joints/joint.h>
#include <pintle/solver/exact_joint_solver.h>
#include <scenes/world.h>

#include <algorithm>
#include <cstdlib>
#include <string>

namespace {

constexpr char variable[] = "PINTLE_TEST_SOLVER";

template <class Solver>
class ForOurs : public Solver {
  btScalar solveGroup(btCollisionObject** bodies, int numBodies, btPersistentManifold** manifolds,
                      int numManifolds, btTypedConstraint** constraints, int numConstraints,
                      const btContactSolverInfo& info, btIDebugDraw* drawer,
                      btDispatcher* dispatcher) override {
    const bool ours = std::any_of(
        constraints, constraints + numConstraints,
        [](btTypedConstraint* joint) { return dynamic_cast<pintle::Joint*>(joint) != nullptr; });
    return ours || numConstraints == 0
               ? Solver::solveGroup(bodies, numBodies, manifolds, numManifolds, constraints,
                                    numConstraints, info, drawer, dispatcher)
               : stock_.solveGroup(bodies, numBodies, manifolds, numManifolds, constraints,
                                   numConstraints, info, drawer, dispatcher);
  }

  btSequentialImpulseConstraintSolver stock_;
};

class SolverOfTests : public testing::Environment {
  void SetUp() override {
    const char* const name = std::getenv(variable);
    ASSERT_TRUE(name == nullptr || onExactSolver()) << variable << "=" << name;
    if (!onExactSolver()) return;
    scenes::default_solver() = [] {
      auto solver = std::make_unique<ForOurs<pintle::ExactJointSolver> >();
      solver->setUpgradesBulletJoints(false);  // stock's are there to compare with
      return solver;
    };
  }
};
[[maybe_unused]] const auto* const environment =
    testing::AddGlobalTestEnvironment(new SolverOfTests);

}  // namespace

bool onExactSolver() {
  const char* const name = std::getenv(variable);
  return name != nullptr && std::string(name) == "exact";
}

#endif
