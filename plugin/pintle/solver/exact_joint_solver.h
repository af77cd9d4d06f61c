// Purpose: a solver for Bullet's worlds that solves all joints of an island together and exactly.
#pragma once

#include <pintle/precision.h>

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

#include <memory>

namespace pintle {
inline namespace PINTLE_PRECISION {

class ExactJointSolver : public btSequentialImpulseConstraintSolver {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  ExactJointSolver();
  ~ExactJointSolver() override;

  void setPositionIterations(int iterations);
  int getPositionIterations() const { return m_position_iterations; }

 protected:
  void convertJoints(btTypedConstraint** constraints, int numConstraints,
                     const btContactSolverInfo& infoGlobal) override;
  btScalar solveGroupCacheFriendlySetup(btCollisionObject** bodies, int numBodies,
                                        btPersistentManifold** manifoldPtr, int numManifolds,
                                        btTypedConstraint** constraints, int numConstraints,
                                        const btContactSolverInfo& infoGlobal,
                                        btIDebugDraw* debugDrawer) override;
  btScalar solveGroupCacheFriendlyIterations(btCollisionObject** bodies, int numBodies,
                                             btPersistentManifold** manifoldPtr, int numManifolds,
                                             btTypedConstraint** constraints, int numConstraints,
                                             const btContactSolverInfo& infoGlobal,
                                             btIDebugDraw* debugDrawer) override;

 private:
  struct Island;
  std::unique_ptr<Island> m_island;
  int m_position_iterations = 1;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
