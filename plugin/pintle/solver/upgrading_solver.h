// Purpose: one of Bullet's solvers with joints of Pintle's in the place of stock ones.
#pragma once

#include <pintle/precision.h>

#include <BulletDynamics/ConstraintSolver/btNNCGConstraintSolver.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

#include <memory>
#include <string>
#include <vector>

namespace pintle {
template <class Memory>
class MemoryOfWorlds;

inline namespace PINTLE_PRECISION {

class UpgradedJoint;
class UpgradedJoints;

/// One of Bullet's solvers that upgrades stock joints: SequentialJointSolver says how.
template <class BulletSolver>
class UpgradingSolver : public BulletSolver {
 public:
  UpgradingSolver();
  ~UpgradingSolver() override;
  UpgradingSolver(const UpgradingSolver&) = delete;
  UpgradingSolver& operator=(const UpgradingSolver&) = delete;

  /// Default true. False: the solver is Bullet's, to the same bits. Call it between steps.
  void setUpgradesBulletJoints(bool upgrades) { m_upgrades = upgrades; }
  /// The value that setUpgradesBulletJoints set.
  bool getUpgradesBulletJoints() const { return m_upgrades; }
  /// Which settings of a stock joint that is upgraded, or of a joint of Pintle's, are not used, and why (Joint::whyIgnored). Empty: all
  /// are, or the constraint is neither.
  std::string whyIgnored(const btTypedConstraint& constraint) const;

  /// Bullet's world calls it.
  void prepareSolve(int numBodies, int numManifolds) override;
  /// Bullet's world calls it for each island.
  btScalar solveGroup(btCollisionObject** bodies, int numBodies, btPersistentManifold** manifolds,
                      int numManifolds, btTypedConstraint** constraints, int numConstraints,
                      const btContactSolverInfo& info, btIDebugDraw* drawer,
                      btDispatcher* dispatcher) override;

 protected:
  /// The array to solve in the place of this one, until endSolve.
  btTypedConstraint** beginSolve(const btDispatcher* world, btTypedConstraint** constraints,
                                 int numConstraints);
  void endSolve();

 private:
  bool m_upgrades = true;
  std::unique_ptr<MemoryOfWorlds<UpgradedJoints>> m_joints;
  std::vector<UpgradedJoint*> m_upgraded;  ///< of this island, null where a joint is as it was
  std::vector<btTypedConstraint*> m_solved;
};

extern template class UpgradingSolver<btSequentialImpulseConstraintSolver>;
extern template class UpgradingSolver<btNNCGConstraintSolver>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
