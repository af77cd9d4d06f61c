#include <pintle/solver/exact_multi_body_joint_solver.h>

#include <initializer_list>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

/// While it lives, an array is empty. Its elements stay.
template <class Array>
class Hidden {
 public:
  explicit Hidden(Array& array) : m_array(array), m_size(array.size()) {
    m_array.resizeNoInitialize(0);
  }
  ~Hidden() { m_array.resizeNoInitialize(m_size); }
  Hidden(const Hidden&) = delete;
  Hidden& operator=(const Hidden&) = delete;

 private:
  Array& m_array;
  const int m_size;
};

}  // namespace

void ExactMultiBodyJointSolver::solveMultiBodyGroup(
    btCollisionObject** bodies, int numBodies, btPersistentManifold** manifolds, int numManifolds,
    btTypedConstraint** constraints, int numConstraints,
    btMultiBodyConstraint** multiBodyConstraints, int numMultiBodyConstraints,
    const btContactSolverInfo& info, btIDebugDraw* drawer, btDispatcher* dispatcher) {
  enter(dispatcher, bodies, numBodies, manifolds, numManifolds, constraints, numConstraints, info);
  btMultiBodyConstraintSolver::solveMultiBodyGroup(
      bodies, numBodies, manifolds, numManifolds, constraints, numConstraints, multiBodyConstraints,
      numMultiBodyConstraints, info, drawer, dispatcher);
  leave();
}

bool ExactMultiBodyJointSolver::hasOthers() const {
  return m_multiBodyNonContactConstraints.size() > 0 ||
         m_multiBodyNormalContactConstraints.size() > 0;
}

std::function<void(int number)> ExactMultiBodyJointSolver::passOverOthers(
    const btContactSolverInfo& info) {
  if (!hasOthers()) return {};
  startFromMultiBodies();
  return [this, &info](
             int number) {  // without the contacts of rigid bodies, which joints are solved with
    const Hidden contacts(m_tmpSolverContactConstraintPool),
        friction(m_tmpSolverContactFrictionConstraintPool),
        rolling(m_tmpSolverContactRollingFrictionConstraintPool);
    btMultiBodyConstraintSolver::solveSingleIteration(number, nullptr, 0, nullptr, 0, nullptr, 0,
                                                      info, nullptr);
  };
}

// Of the impulses that Bullet begins with, those of contacts between rigid bodies are left out.
void ExactMultiBodyJointSolver::startFromMultiBodies() {
  for (int i = 0; i < m_tmpSolverBodyPool.size(); ++i) {
    m_tmpSolverBodyPool[i].m_deltaLinearVelocity.setZero();
    m_tmpSolverBodyPool[i].m_deltaAngularVelocity.setZero();
  }
  const auto push = [&](const btMultiBody* instead, int body, const btVector3& normal,
                        const btVector3& angular, btScalar impulse) {
    if (instead != nullptr || body < 0) return;
    btSolverBody& to = m_tmpSolverBodyPool[body];
    to.internalApplyImpulse(normal * to.internalGetInvMass(), angular, impulse);
  };
  for (int i = 0; i < m_multiBodyNormalContactConstraints.size(); ++i) {
    const btMultiBodySolverConstraint& row = m_multiBodyNormalContactConstraints[i];
    push(row.m_multiBodyA, row.m_solverBodyIdA, row.m_contactNormal1, row.m_angularComponentA,
         row.m_appliedImpulse);
    push(row.m_multiBodyB, row.m_solverBodyIdB, row.m_contactNormal2, row.m_angularComponentB,
         row.m_appliedImpulse);
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
