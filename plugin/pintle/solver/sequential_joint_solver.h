// Purpose: Bullet's iterations with Pintle's rows for the stock joints of a world, which stay as they are.
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
  /// What setUpgradesBulletJoints set.
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

/// Takes the place of `btSequentialImpulseConstraintSolver` in a world, with nothing else changed:
///
///     pintle::SequentialJointSolver solver;
///     btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
///
/// A constraint whose class is exactly `btHingeConstraint`, `btHingeAccumulatedAngleConstraint`, `btPoint2PointConstraint`,
/// `btSliderConstraint` or `btConeTwistConstraint` is solved as the joint of Pintle's that replaces the class (QuaternionHinge,
/// BallJoint, SliderJoint, ConeTwistJoint), with the settings that stand in the object at the start of the step. The result is that
/// joint's, to the bit.
///
/// The object, its address, its type and its file stay. A step leaves there what one of Bullet's leaves: applied impulse, feedback,
/// the enabled flag of a joint that breaks, and what getters tell of angles, positions and limits.
///
/// - A client's subclass keeps its own rows, and so does any other class.
/// - A joint that sleeps, is removed for a step, or is made anew starts anew: its angle counts from the turn in which it is.
/// - Stock's settings have stock's ranges: a range of a turn or more is free. Pintle's own (springs, servos, friction, more turns)
///   need an object of Pintle's.
/// - A number that is not finite is not used: the last good one stays, and whyIgnored says which.
///
/// UpgradingSolver<btNNCGConstraintSolver> is the same on that solver.
class SequentialJointSolver : public UpgradingSolver<btSequentialImpulseConstraintSolver> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
