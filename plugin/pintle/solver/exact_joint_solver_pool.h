// Purpose: exact solvers for a world of several threads.
#pragma once

#include <pintle/solver/exact_joint_solver.h>

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorldMt.h>

#include <string>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Takes the place of `btConstraintSolverPoolMt`:
///
///     pintle::ExactJointSolverPool pool(4);  // as many as the task scheduler has threads
///     btDiscreteDynamicsWorldMt world(&dispatcher, &broadphase, &pool, nullptr, &configuration);
///
/// Any of its solvers solves any island, and the bits are those of one solver. (Bullet's own pool takes solvers of Pintle's, too. It does
/// not tell them when a step begins: there what a component goes on from may be another thing where a single step has left it out.)
class ExactJointSolverPool : public btConstraintSolverPoolMt {
 public:
  /// Of so many solvers: as many as the world has threads. Throws std::invalid_argument if that is less than 1.
  explicit ExactJointSolverPool(int count);

  /// Of all solvers, from the next step on. Throws std::invalid_argument, with the field, its value and what is wrong.
  void setOptions(const SolverOptions& options);
  /// What setOptions set.
  const SolverOptions& options() const { return m_solvers.front()->options(); }
  ///@{
  /// As ExactJointSolver has them, of all solvers.
  void setUpgradesBulletJoints(bool upgrades);
  bool getUpgradesBulletJoints() const { return m_solvers.front()->getUpgradesBulletJoints(); }
  std::string whyIgnored(const btTypedConstraint& constraint) const {
    return m_solvers.front()->whyIgnored(constraint);
  }
  ///@}
  /// What all of them did in the last step.
  StepReport lastStep() const { return m_solvers.front()->lastStep(); }

  /// Bullet's world calls it.
  void prepareSolve(int numBodies, int numManifolds) override;

 private:
  using Solvers = std::vector<ExactJointSolver*>;
  explicit ExactJointSolverPool(const Solvers& solvers);

  Solvers m_solvers;  ///< the base deletes them
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
