#include <pintle/solver/exact_joint_solver.h>

#include <pintle/joints/joint.h>
#include <pintle/solver/end_of_step.h>
#include <pintle/solver/joint_system.h>

#include <stdexcept>
#include <string>

namespace pintle {
inline namespace PINTLE_PRECISION {

namespace {
constexpr int most_stiffenings = 6;
}

// What an island is solved with.
struct ExactJointSolver::Island {
  JointSystem joints;
  EndOfStep end;
  std::vector<double> error;  ///< of all rows, by block
  std::vector<Joint*> plain;  ///< joints whose rows are plain for this step
};

ExactJointSolver::ExactJointSolver() : m_island(std::make_unique<Island>()) {}
ExactJointSolver::~ExactJointSolver() = default;

void ExactJointSolver::setPositionIterations(int iterations) {
  if (iterations < 0)
    throw std::invalid_argument("pintle::ExactJointSolver: position iterations = " +
                                std::to_string(iterations) + ": must be >= 0");
  m_position_iterations = iterations;
}

void ExactJointSolver::convertJoints(btTypedConstraint** constraints, int numConstraints,
                                     const btContactSolverInfo& infoGlobal) {
  // Rows that are orthogonal within a joint serve a solver that takes one by one.
  std::vector<Joint*>& plain = m_island->plain;
  plain.clear();
  for (int i = 0; i < numConstraints; ++i) {
    auto* joint = dynamic_cast<Joint*>(constraints[i]);
    if (joint != nullptr && joint->getBlockRows()) {
      joint->setBlockRows(false);
      plain.push_back(joint);
    }
  }
  btSequentialImpulseConstraintSolver::convertJoints(constraints, numConstraints, infoGlobal);
  for (Joint* joint : plain) joint->setBlockRows(true);
}

btScalar ExactJointSolver::solveGroupCacheFriendlySetup(
    btCollisionObject** bodies, int numBodies, btPersistentManifold** manifoldPtr, int numManifolds,
    btTypedConstraint** constraints, int numConstraints, const btContactSolverInfo& infoGlobal,
    btIDebugDraw* debugDrawer) {
  btContactSolverInfo info = infoGlobal;
  if (numConstraints > 0) info.m_warmstartingFactor = 1;
  return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlySetup(
      bodies, numBodies, manifoldPtr, numManifolds, constraints, numConstraints, info, debugDrawer);
}

btScalar ExactJointSolver::solveGroupCacheFriendlyIterations(
    btCollisionObject** bodies, int numBodies, btPersistentManifold** manifoldPtr, int numManifolds,
    btTypedConstraint** constraints, int numConstraints, const btContactSolverInfo& infoGlobal,
    btIDebugDraw* debugDrawer) {
  JointSystem& joints = m_island->joints;
  if (!joints.gather(m_tmpSolverBodyPool, m_tmpSolverNonContactConstraintPool))
    return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyIterations(
        bodies, numBodies, manifoldPtr, numManifolds, constraints, numConstraints, infoGlobal,
        debugDrawer);
  solveGroupCacheFriendlySplitImpulseIterations(bodies, numBodies, manifoldPtr, numManifolds,
                                                constraints, numConstraints, infoGlobal,
                                                debugDrawer);
  joints.factorise();
  joints.begin(m_tmpSolverBodyPool);
  const bool bounded = !joints.all() || m_tmpSolverContactConstraintPool.size() > 0;
  // The force of the joints depends on the stiffness, which depends on the force.
  int stiffenings = 0;
  const auto stiffen = [&] {
    if (stiffenings == most_stiffenings ||
        !joints.stiffen(m_tmpSolverBodyPool, m_tmpSolverNonContactConstraintPool,
                        infoGlobal.m_timeStep))
      return false;
    ++stiffenings;
    if (bounded) {
      for (int i = 0; i < m_tmpSolverBodyPool.size(); ++i) {
        m_tmpSolverBodyPool[i].internalGetDeltaLinearVelocity().setZero();
        m_tmpSolverBodyPool[i].internalGetDeltaAngularVelocity().setZero();
      }
      joints.stiffenRows(m_tmpSolverBodyPool, m_tmpSolverNonContactConstraintPool, false);
      for (btConstraintArray* rows :
           {&m_tmpSolverContactConstraintPool, &m_tmpSolverContactFrictionConstraintPool,
            &m_tmpSolverContactRollingFrictionConstraintPool})
        joints.stiffenRows(m_tmpSolverBodyPool, *rows, true);
    }
    joints.begin(m_tmpSolverBodyPool);
    return true;
  };
  while (stiffen()) {
  }
  joints.settle();
  joints.write(m_tmpSolverBodyPool);

  // Each iteration is a pass of Bullet's over what has bounds, and an exact solution of the rest.
  if (bounded) {
    const int iterations = btMax(infoGlobal.m_numIterations, m_maxOverrideNumSolverIterations);
    for (int i = 0; i < iterations; ++i) {
      m_leastSquaresResidual =
          solveSingleIteration(i, bodies, numBodies, manifoldPtr, numManifolds, constraints,
                               numConstraints, infoGlobal, debugDrawer);
      joints.read(m_tmpSolverBodyPool);
      joints.solve();
      // What the contacts load the joints with grows with the iterations, less and less.
      if (i == 1 && stiffen()) joints.settle();
      joints.write(m_tmpSolverBodyPool);
      if (m_leastSquaresResidual <= infoGlobal.m_leastSquaresResidualThreshold) break;
    }
  }

  EndOfStep& end = m_island->end;
  for (int i = 0; i < m_position_iterations; ++i) {
    end.predict(m_tmpSolverBodyPool, infoGlobal);
    end.errors(joints.blocks(), m_tmpSolverNonContactConstraintPool, m_island->error);
    joints.correct(m_island->error);
    joints.write(m_tmpSolverBodyPool);
  }
  joints.writeImpulses(m_tmpSolverNonContactConstraintPool);
  return 0;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
