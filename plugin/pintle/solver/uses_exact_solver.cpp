#include <pintle/solver/uses_exact_solver.h>

#include <pintle/solver/exact_multi_body_joint_solver.h>
#include <pintle/solver/joint_solver.h>

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorldMt.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyInplaceSolverIslandCallback.h>

#include <stdexcept>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

using OnRigidBodies = JointSolver<btSequentialImpulseConstraintSolver>;
using OnMultiBodies = JointSolver<btMultiBodyConstraintSolver>;

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
struct SolversOf {
  friend Solvers solversOf(const btConstraintSolverPoolMt& pool) { return listed(pool.*solvers); }
};
template struct SolversOf<&btConstraintSolverPoolMt::m_solvers>;

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

// What an exact solver did in its last step. Returns whether it is one.
bool report(const btConstraintSolver* solver, StepReport& to) {
  if (const auto* of = dynamic_cast<const OnRigidBodies*>(solver))
    to = of->lastStep();
  else if (const auto* of_multi_bodies = dynamic_cast<const OnMultiBodies*>(solver))
    to = of_multi_bodies->lastStep();
  else
    return false;
  return true;
}

struct Found {
  StepReport last_step;
  const char* why_not = nullptr;  ///< null: all are exact
};

Found find(const btMultiBodyDynamicsWorld& world, const btConstraintSolver* given) {
  Found found;
  const btConstraintSolver* const used = MultiBodyWorld::solverOf(world);
  if (report(used, found.last_step)) return found;
  found.why_not = used != given
                      ? "a btMultiBodyDynamicsWorld ignores setConstraintSolver(): give a "
                        "pintle::ExactMultiBodyJointSolver to its constructor or to "
                        "setMultiBodyConstraintSolver()"
                      : "the solver of this btMultiBodyDynamicsWorld is not a "
                        "pintle::ExactMultiBodyJointSolver";
  return found;
}

// Solvers of a pool report the same, once they have solved an island.
Found find(const btConstraintSolverPoolMt& pool) {
  Found found;
  for (const btConstraintSolver* of : solversOf(pool)) {
    StepReport by_this;
    if (!report(of, by_this))
      found.why_not =
          "a solver of this world's btConstraintSolverPoolMt is not a pintle::ExactJointSolver: "
          "give the world a pintle::ExactJointSolverPool";
    if (by_this.components > 0) found.last_step = by_this;
  }
  return found;
}

Found find(const btDynamicsWorld& world) {
  const btConstraintSolver* const solver =
      const_cast<btDynamicsWorld&>(world).getConstraintSolver();  // which changes nothing
  if (const auto* of = dynamic_cast<const btMultiBodyDynamicsWorld*>(&world))
    return find(*of, solver);
  Found found;
  if (const auto* of = dynamic_cast<const btDiscreteDynamicsWorldMt*>(&world)) {
    const btConstraintSolver* const large = MtWorld::solverOfLarge(*of);
    if (large != nullptr && !report(large, found.last_step)) {
      found.why_not =
          "this btDiscreteDynamicsWorldMt solves its large islands by another solver: give its "
          "constructor nullptr for constraintSolverMt";
      return found;
    }
  }
  if (const auto* pool = dynamic_cast<const btConstraintSolverPoolMt*>(solver)) return find(*pool);
  if (!report(solver, found.last_step))
    found.why_not =
        "the solver of this world is not a pintle::ExactJointSolver: give one to its constructor "
        "or to setConstraintSolver()";
  return found;
}

}  // namespace

bool usesExactSolver(const btDynamicsWorld& world) { return find(world).why_not == nullptr; }

std::string whyNotExact(const btDynamicsWorld& world) {
  const Found found = find(world);
  return found.why_not != nullptr ? std::string("pintle: ") + found.why_not : std::string();
}

StepReport lastStep(const btDynamicsWorld& world) {
  const Found found = find(world);
  if (found.why_not != nullptr)
    throw std::invalid_argument(std::string("pintle: ") + found.why_not);
  return found.last_step;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
