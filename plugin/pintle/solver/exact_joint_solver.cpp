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

btScalar ExactJointSolver::solveGroupCacheFriendlyIterations(
    btCollisionObject** bodies, int numBodies, btPersistentManifold** manifoldPtr, int numManifolds,
    btTypedConstraint** constraints, int numConstraints, const btContactSolverInfo& infoGlobal,
    btIDebugDraw* debugDrawer) {
  JointSystem& joints = m_island->joints;
  if (!joints.gather(m_tmpSolverBodyPool, m_tmpSolverNonContactConstraintPool))
    return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyIterations(
        bodies, numBodies, manifoldPtr, numManifolds, constraints, numConstraints, infoGlobal,
        debugDrawer);
  joints.factorise();
  joints.read(m_tmpSolverBodyPool);
  joints.solve();
  // The force of the joints depends on the stiffness, which depends on the force.
  for (int i = 0; i < most_stiffenings; ++i) {
    if (!joints.stiffen(m_tmpSolverBodyPool, m_tmpSolverNonContactConstraintPool,
                        infoGlobal.m_timeStep))
      break;
    joints.solve();
  }
  joints.write(m_tmpSolverBodyPool);
  EndOfStep& end = m_island->end;
  for (int i = 0; i < m_position_iterations; ++i) {
    end.predict(m_tmpSolverBodyPool, infoGlobal);
    for (JointBlock& block : joints.blocks()) {
      double error[block_rows];
      end.errors(block, m_tmpSolverNonContactConstraintPool, error);
      for (int r = 0; r < block.rows; ++r) block.deficit[r] += error[r];
    }
    joints.solve();
    joints.write(m_tmpSolverBodyPool);
  }
  joints.writeImpulses(m_tmpSolverNonContactConstraintPool);
  return 0;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
