// Purpose: a solver for Bullet's worlds of multibodies that solves all joints of rigid bodies exactly.
#pragma once

#include <pintle/solver/joint_solver.h>
#include <pintle/solver/uses_exact_solver.h>

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

extern template class JointSolver<btMultiBodyConstraintSolver>;

/// Takes the place of `btMultiBodyConstraintSolver`, with nothing else changed:
///
///     pintle::ExactMultiBodyJointSolver solver;
///     btMultiBodyDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
///
/// Joints of rigid bodies hold as on ExactJointSolver. Multibodies, with their limits, motors and contacts, move as on
/// Bullet's solver, to the same bits where nothing with joints touches them. Where something does, the two take turns, and
/// joints come last: they hold whatever multibodies do to their bodies.
class ExactMultiBodyJointSolver : public JointSolver<btMultiBodyConstraintSolver> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Bullet's world calls it.
  void solveMultiBodyGroup(btCollisionObject** bodies, int numBodies,
                           btPersistentManifold** manifolds, int numManifolds,
                           btTypedConstraint** constraints, int numConstraints,
                           btMultiBodyConstraint** multiBodyConstraints,
                           int numMultiBodyConstraints, const btContactSolverInfo& info,
                           btIDebugDraw* drawer, btDispatcher* dispatcher) override;

 protected:
  bool hasOthers() const override;
  std::function<void(int number)> passOverOthers(const btContactSolverInfo& info) override;

 private:
  void startFromMultiBodies();
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
