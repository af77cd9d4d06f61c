#include <pintle/solver/uses_exact_solver.h>

#include <pintle/solver/exact_joint_solver.h>
#include <pintle/solver/exact_multi_body_joint_solver.h>
#include <pintle/solver/passive_joint_solver.h>

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorldMt.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyInplaceSolverIslandCallback.h>

#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

using Solvers = std::vector<const btConstraintSolver*>;

template <class Array>
Solvers listed(const Array& of) {
  Solvers all;
  for (int i = 0; i < of.size(); ++i) all.push_back(of[i].solver);
  return all;
}

// Bullet's pool keeps its solvers private. An explicit instantiation may name them (C++17, 17.7.2.12).
Solvers solversOf(const btConstraintSolverPoolMt& pool);
template <auto solvers>
struct Pool {
  friend Solvers solversOf(const btConstraintSolverPoolMt& pool) { return listed(pool.*solvers); }
};
template struct Pool<&btConstraintSolverPoolMt::m_solvers>;

// The solvers that worlds use, which are protected.
struct MultiBodyWorld : btMultiBodyDynamicsWorld {
  static const btConstraintSolver* solverOf(const btMultiBodyDynamicsWorld& world) {
    return (world.*&MultiBodyWorld::m_solverMultiBodyIslandCallback)->m_solver;
  }
};
struct MtWorld : btDiscreteDynamicsWorldMt {
  static const btConstraintSolver* solverOfLarge(const btDiscreteDynamicsWorldMt& world) {
    return world.*&MtWorld::m_constraintSolverMt;
  }
};

bool isExact(const btConstraintSolver* solver) {
  return dynamic_cast<const ExactJointSolver*>(solver) != nullptr ||
         dynamic_cast<const PassiveJointSolver*>(solver) != nullptr ||
         dynamic_cast<const ExactMultiBodyJointSolver*>(solver) != nullptr;
}

}  // namespace

bool usesExactSolver(const btDynamicsWorld& world) { return whyNotExact(world).empty(); }

std::string whyNotExact(const btDynamicsWorld& world) {
  const btConstraintSolver* const solver =
      const_cast<btDynamicsWorld&>(world).getConstraintSolver();  // which changes nothing
  if (const auto* of = dynamic_cast<const btMultiBodyDynamicsWorld*>(&world)) {
    if (dynamic_cast<const ExactMultiBodyJointSolver*>(MultiBodyWorld::solverOf(*of)) != nullptr)
      return {};
    return isExact(solver)
               ? "pintle: a btMultiBodyDynamicsWorld does not use the solver that "
                 "setConstraintSolver() "
                 "gives it. It takes a pintle::ExactMultiBodyJointSolver, by its constructor or by "
                 "setMultiBodyConstraintSolver()."
               : "pintle: the solver of this btMultiBodyDynamicsWorld is not a "
                 "pintle::ExactMultiBodyJointSolver.";
  }
  if (const auto* of = dynamic_cast<const btDiscreteDynamicsWorldMt*>(&world)) {
    const btConstraintSolver* const large = MtWorld::solverOfLarge(*of);
    if (large != nullptr && !isExact(large))
      return "pintle: this btDiscreteDynamicsWorldMt solves its large islands by another solver. "
             "Give its "
             "constructor nullptr for constraintSolverMt.";
  }
  if (const auto* pool = dynamic_cast<const btConstraintSolverPoolMt*>(solver)) {
    for (const btConstraintSolver* of : solversOf(*pool))
      if (!isExact(of))
        return "pintle: a solver of this world's btConstraintSolverPoolMt is not a "
               "pintle::ExactJointSolver. "
               "Make the pool of solvers of your own: btConstraintSolverPoolMt(solvers, count).";
    return {};
  }
  if (isExact(solver)) return {};
  return "pintle: the solver of this world is not a pintle::ExactJointSolver. Give one to its "
         "constructor or to "
         "setConstraintSolver().";
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
