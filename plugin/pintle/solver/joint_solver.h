// Purpose: one of Bullet's solvers, of which an IslandStep solves the joints, and the contacts of their islands.
#pragma once

#include <pintle/precision.h>
#include <pintle/solver/solver_options.h>
#include <pintle/solver/step_report.h>

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace pintle {
template <class Memory>
class MemoryOfWorlds;

inline namespace PINTLE_PRECISION {

class ExactJointSolverPool;
class IslandStep;
class UpgradedJoint;
class WorldMemory;

/// What ExactJointSolver and ExactMultiBodyJointSolver have in common.
template <class BulletSolver>
class JointSolver : public BulletSolver {
 public:
  JointSolver();
  ~JointSolver() override;
  JointSolver(const JointSolver&) = delete;
  JointSolver& operator=(const JointSolver&) = delete;

  /// From the next step on. Throws std::invalid_argument, with the field, its value and what is wrong.
  void setOptions(const SolverOptions& options);
  /// What setOptions set.
  const SolverOptions& options() const;
  /// Default true: stock joints are solved as those of Pintle's that replace their classes, and stay as they are
  /// (SequentialJointSolver says which). False: as rows that stock writes. Call it between steps.
  void setUpgradesBulletJoints(bool upgrades) { m_upgrades = upgrades; }
  /// The value that setUpgradesBulletJoints set.
  bool getUpgradesBulletJoints() const { return m_upgrades; }
  /// Which settings of a stock joint that is upgraded, or of a joint of Pintle's, are not used, and why (Joint::whyIgnored). Empty: all
  /// are, or the constraint is neither.
  std::string whyIgnored(const btTypedConstraint& constraint) const;
  /// What was done in the last step of the world: where several solvers share it, by all of them.
  StepReport lastStep() const;
  /// Components of which something is kept for the next step.
  int getNumRemembered() const;
  /// The memory that is kept from step to step, bytes: of the world, and what the solver works with.
  size_t getMemory() const;

  /// Bullet's world calls it.
  void prepareSolve(int numBodies, int numManifolds) override;
  /// Bullet's world calls it for each island.
  btScalar solveGroup(btCollisionObject** bodies, int numBodies, btPersistentManifold** manifolds,
                      int numManifolds, btTypedConstraint** constraints, int numConstraints,
                      const btContactSolverInfo& info, btIDebugDraw* drawer,
                      btDispatcher* dispatcher) override;

 protected:
  /// The island that follows is of this world, and has these joints.
  void enter(const btDispatcher* world, btCollisionObject** bodies, int numBodies,
             btPersistentManifold** manifolds, int numManifolds, btTypedConstraint** constraints,
             int numConstraints, const btContactSolverInfo& info);
  /// The island is solved.
  void leave();
  /// Rows that are neither joints nor contacts between rigid bodies act in this island.
  virtual bool hasOthers() const { return false; }
  /// One pass over those; empty if there are none.
  virtual std::function<void(int number)> passOverOthers(const btContactSolverInfo&) { return {}; }

  void convertJoints(btTypedConstraint** constraints, int numConstraints,
                     const btContactSolverInfo& info) override;
  btScalar solveGroupCacheFriendlySetup(btCollisionObject** bodies, int numBodies,
                                        btPersistentManifold** manifolds, int numManifolds,
                                        btTypedConstraint** constraints, int numConstraints,
                                        const btContactSolverInfo& info,
                                        btIDebugDraw* drawer) override;
  btScalar solveGroupCacheFriendlyIterations(btCollisionObject** bodies, int numBodies,
                                             btPersistentManifold** manifolds, int numManifolds,
                                             btTypedConstraint** constraints, int numConstraints,
                                             const btContactSolverInfo& info,
                                             btIDebugDraw* drawer) override;
  btScalar solveGroupCacheFriendlyFinish(btCollisionObject** bodies, int numBodies,
                                         const btContactSolverInfo& info) override;

 private:
  friend class ExactJointSolverPool;
  /// What either keeps of the world, the other one goes on from.
  void shareMemoryOf(const JointSolver& other);

  std::unique_ptr<IslandStep> m_islands;
  std::unique_ptr<MemoryOfWorlds<WorldMemory>> m_memory;
  bool m_has_joints = false;  ///< this island
  bool m_upgrades = true;
  std::vector<UpgradedJoint*> m_upgraded;  ///< of this island, null where a joint is as it was
  std::vector<int> m_touched;              ///< islands in which something touches something
};

extern template class JointSolver<btSequentialImpulseConstraintSolver>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
