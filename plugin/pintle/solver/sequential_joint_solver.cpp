#include <pintle/solver/sequential_multi_body_joint_solver.h>

#include <pintle/upgrade/memory_of_worlds.h>
#include <pintle/upgrade/upgraded_joints.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

template <class BulletSolver>
UpgradingSolver<BulletSolver>::UpgradingSolver() : m_joints(new MemoryOfWorlds<UpgradedJoints>) {}
template <class BulletSolver>
UpgradingSolver<BulletSolver>::~UpgradingSolver() = default;

template <class BulletSolver>
std::string UpgradingSolver<BulletSolver>::whyIgnored(const btTypedConstraint& constraint) const {
  return (*m_joints)->whyIgnored(constraint);
}

template <class BulletSolver>
void UpgradingSolver<BulletSolver>::prepareSolve(int numBodies, int numManifolds) {
  (*m_joints)->beginStep();
  BulletSolver::prepareSolve(numBodies, numManifolds);
}

template <class BulletSolver>
btTypedConstraint** UpgradingSolver<BulletSolver>::beginSolve(const btDispatcher* world,
                                                              btTypedConstraint** constraints,
                                                              int numConstraints) {
  m_upgraded.clear();
  if (!m_upgrades) return constraints;
  if (world != nullptr) m_joints->enter(*world);
  (*m_joints)->find(constraints, numConstraints, m_upgraded);
  m_solved.assign(constraints, constraints + numConstraints);
  for (std::size_t i = 0; i < m_upgraded.size(); ++i) {
    if (m_upgraded[i] == nullptr) continue;
    m_upgraded[i]->beginSolve();
    m_solved[i] = m_upgraded[i];
  }
  return m_solved.data();
}

template <class BulletSolver>
void UpgradingSolver<BulletSolver>::endSolve() {
  for (UpgradedJoint* of : m_upgraded)
    if (of != nullptr) of->endSolve();
}

template <class BulletSolver>
btScalar UpgradingSolver<BulletSolver>::solveGroup(
    btCollisionObject** bodies, int numBodies, btPersistentManifold** manifolds, int numManifolds,
    btTypedConstraint** constraints, int numConstraints, const btContactSolverInfo& info,
    btIDebugDraw* drawer, btDispatcher* dispatcher) {
  btTypedConstraint** const solved = beginSolve(dispatcher, constraints, numConstraints);
  const btScalar result = BulletSolver::solveGroup(
      bodies, numBodies, manifolds, numManifolds, solved, numConstraints, info, drawer, dispatcher);
  endSolve();
  return result;
}

void SequentialMultiBodyJointSolver::solveMultiBodyGroup(
    btCollisionObject** bodies, int numBodies, btPersistentManifold** manifolds, int numManifolds,
    btTypedConstraint** constraints, int numConstraints,
    btMultiBodyConstraint** multiBodyConstraints, int numMultiBodyConstraints,
    const btContactSolverInfo& info, btIDebugDraw* drawer, btDispatcher* dispatcher) {
  btTypedConstraint** const solved = beginSolve(dispatcher, constraints, numConstraints);
  btMultiBodyConstraintSolver::solveMultiBodyGroup(
      bodies, numBodies, manifolds, numManifolds, solved, numConstraints, multiBodyConstraints,
      numMultiBodyConstraints, info, drawer, dispatcher);
  endSolve();
}

template class UpgradingSolver<btSequentialImpulseConstraintSolver>;
template class UpgradingSolver<btNNCGConstraintSolver>;
template class UpgradingSolver<btMultiBodyConstraintSolver>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
