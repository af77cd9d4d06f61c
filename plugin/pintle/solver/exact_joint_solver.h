// Purpose: a solver for Bullet's worlds that solves all joints of an island together and exactly.
#pragma once

#include <pintle/precision.h>

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct StepOfRows;

/// Takes the place of `btSequentialImpulseConstraintSolver` in a world, with nothing else changed:
///
///     pintle::ExactJointSolver solver;
///     btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
///
/// All joint rows without bounds, of Pintle's joints and of Bullet's, are solved at once by a sparse
/// factorisation of K = J M^-1 J^T + gamma / dt (document, 2.12), in double, in time and memory that
/// are linear in the joints of a tree; softness (CFM) of any size is exact. Motors, friction and joints
/// that may break are solved with them while they are within their bounds, and so are limits of islands without
/// contacts; this active set is found anew in each step. Rows at a bound, contacts, and limits among contacts are
/// iterated as Bullet does it, for the world's number of iterations. The joints are solved within each iteration,
/// so that they hold whatever the contacts do. An island without joints is solved by Bullet's own code, to
/// the same bits.
///
/// Velocities are those with which the joints hold at the END of the step (setPositionIterations). If bodies
/// turn so far that more than 1e-4 m or rad remains, it is corrected by the rows of the predicted end:
/// J_end M^-1 J^T is factorised anew. Impulses act along the rows of the start, and so conserve momentum. A
/// component without such an end, or with none but at much more energy, is slowed down until it has one.
/// Joints that start further apart than a step of 1 m/s or 1 rad/s closes come together by their ERP.
///
/// Bodies that swing under their joints' load faster than a step resolves get the geometric stiffness of that
/// load, and lose the part of the swing that the step cannot follow. A component that would gain energy by
/// closing at once, as one that turns by radians a step, closes at up to 100 m/s and rad/s, and gets no more
/// energy than that takes. Rigid joints to static bodies do no work on a component that nothing touches and
/// that turns by 0.1 to 0.8 rad a step.
///
/// Joints of closed loops, and dependent rows, share their load by impulses of minimum norm. Bodies that hold
/// NaN have no joints for the step. If numbers overflow, nothing acts in the step. A step never throws; it
/// allocates only while islands grow or form anew. The same calls give the same bits; an instance keeps the
/// impulses of the last step. An instance is used from one thread at a time; `btConstraintSolverPoolMt` takes
/// several.
class ExactJointSolver : public btSequentialImpulseConstraintSolver {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  ExactJointSolver();
  ~ExactJointSolver() override;
  ExactJointSolver(const ExactJointSolver&) = delete;
  ExactJointSolver& operator=(const ExactJointSolver&) = delete;

  /// How often (>= 0) a step corrects its velocities by the joints' position errors at its end. Default 1. With
  /// 0 joints hold in velocity, and ERP corrects the drift. A correction that does not lessen a large error is
  /// halved, or given up. Throws std::invalid_argument.
  void setPositionIterations(int iterations);
  int getPositionIterations() const { return m_position_iterations; }

  /// The largest change of velocity (m/s, rad/s) in the last pass over the rows with bounds, of the last island
  /// that had joints and such rows: how far limits, motors, contacts and friction are from all being met.
  btScalar getComplementarityResidual() const { return m_complementarity_residual; }
  /// The memory that the solver keeps from step to step, bytes.
  size_t getMemory() const;

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

  /// Fills the joint's rows in Bullet's pool, from `first` on.
  void convertJoint(btTypedConstraint& joint, const StepOfRows& step, int first, int count);
  bool hasContacts() const { return m_tmpSolverContactConstraintPool.size() > 0; }
  bool hasBounds() const;
  bool stiffen(const btContactSolverInfo& info);
  template <class Pass>
  int solveIsland(const btContactSolverInfo& info, bool again, const Pass& pass);
  struct Pools;
  /// The pools of joints, contacts, friction and rolling friction.
  Pools allRows();
  void resetVelocities();
  void restart();
  void dropGainingWarmStarts();
  void findInPasses(btTypedConstraint** constraints, int numConstraints);
  void beginReactions();
  bool rejectGrowingErrors(double large);
  bool rejectLargeTurns(double dt);
  void computeEnergies();
  bool rejectUnheld(double dt);
  bool rejectEnergyGains(double gain, double speed);
  void undoRejected();
  bool slowRejected(double dt);
  void compensateChordEnergy(const btContactSolverInfo& info);
  void limitEnergyGain(const btContactSolverInfo& info);
  bool iteratePositions(const btContactSolverInfo& info);
  template <class Vector>
  void predictErrors(const btContactSolverInfo& info, Vector& largest);

  Island* m_island;
  int m_position_iterations = 1;
  btScalar m_complementarity_residual = 0;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
