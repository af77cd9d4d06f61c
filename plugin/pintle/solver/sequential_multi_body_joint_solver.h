// Purpose: Bullet's iterations with Pintle's rows for the stock joints of a world of multibodies.
#pragma once

#include <pintle/solver/sequential_joint_solver.h>

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

extern template class UpgradingSolver<btMultiBodyConstraintSolver>;

/// Takes the place of `btMultiBodyConstraintSolver`, with nothing else changed. Stock joints of rigid bodies are upgraded as on
/// SequentialJointSolver; multibodies and their constraints are Bullet's.
class SequentialMultiBodyJointSolver : public UpgradingSolver<btMultiBodyConstraintSolver> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Bullet's world calls it.
  void solveMultiBodyGroup(btCollisionObject** bodies, int numBodies,
                           btPersistentManifold** manifolds, int numManifolds,
                           btTypedConstraint** constraints, int numConstraints,
                           btMultiBodyConstraint** multiBodyConstraints,
                           int numMultiBodyConstraints, const btContactSolverInfo& info,
                           btIDebugDraw* drawer, btDispatcher* dispatcher) override;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
