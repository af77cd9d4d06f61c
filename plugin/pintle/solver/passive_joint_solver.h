// Purpose: a solver for Bullet's worlds of which joints cannot create energy, and which holds them to the last digits.
#pragma once

#include <pintle/precision.h>

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

#include <memory>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct SolverOptions;

/// What the last step of a solver did.
struct StepReport {
  int components = 0;
  int steps = 0, factors = 0;
  int second_tier = 0;    ///< times that a component was solved in velocity (block_gauss_seidel.h)
  int one_by_one = 0;     ///< times that rows were solved one by one
  int not_converged = 0;  ///< components, of which contacts or bounded rows were still changing
  double error = 0;       ///< m or rad: the largest left of a joint
};

class PassiveJointSolver : public btSequentialImpulseConstraintSolver {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  PassiveJointSolver();
  ~PassiveJointSolver() override;
  PassiveJointSolver(const PassiveJointSolver&) = delete;
  PassiveJointSolver& operator=(const PassiveJointSolver&) = delete;

  void prepareSolve(int numBodies, int numManifolds) override;

  SolverOptions& options();
  const StepReport& lastStep() const;
  /// Components of which something is kept for the next step.
  int getNumRemembered() const;

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
  btScalar solveGroupCacheFriendlyFinish(btCollisionObject** bodies, int numBodies,
                                         const btContactSolverInfo& infoGlobal) override;

 private:
  struct State;
  /// Friction is bounded by the contacts, which come first.
  void addContacts(btConstraintArray& pool, bool are_friction);

  std::unique_ptr<State> m_state;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
