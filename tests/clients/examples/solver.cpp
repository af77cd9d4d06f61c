#include "solver.h"

#include <pintle/solver/exact_joint_solver.h>
#include <pintle/solver/sequential_joint_solver.h>

#include <cstdlib>
#include <string>

namespace examples {

bool isContender(const char* name) {
  const char* const its = std::getenv("PINTLE_EXAMPLES_SOLVER");
  return name == std::string(its != nullptr ? its : "stock");
}

namespace {

template <class Stock, class Upgraded>
btSequentialImpulseConstraintSolver* make() {
  if (isContender("exact")) return new pintle::ExactJointSolver;
  if (isContender("upgraded")) return new Upgraded;
  return new Stock;
}

}  // namespace

btSequentialImpulseConstraintSolver* makeSolver() {
  return make<btSequentialImpulseConstraintSolver, pintle::SequentialJointSolver>();
}

btSequentialImpulseConstraintSolver* makeNncgSolver() {
  return make<btNNCGConstraintSolver, pintle::UpgradingSolver<btNNCGConstraintSolver>>();
}

}  // namespace examples
