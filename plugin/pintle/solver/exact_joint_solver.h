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
/// that may break are solved with them as long as they are within their bounds, and so are limits where nothing
/// touches; which are is found anew in each step. What is at a bound, and contacts with limits among them, are
/// iterated as Bullet does it, for the world's number of iterations, and the joints are solved within each
/// iteration: they hold whatever the contacts do. An island without joints is solved by Bullet's own code, to
/// the same bits.
///
/// Velocities are those with which the joints hold at the END of the step (setPositionIterations). Where bodies
/// turn so far that this leaves more than 1e-4 m or rad, it is corrected along the rows of the predicted end,
/// J_end M^-1 J^T, factorised anew; impulses are along the rows of the start, and keep momentum. A component that
/// has no such end, or none without much more energy, is slowed down until it has one. Joints that start further apart than a step of 1 m/s or 1 rad/s closes come together as their ERP
/// says. Bodies that swing under the load of their joints faster than a step resolves are given the
/// geometric stiffness of that load, and lose what of their swing could not be followed. What would
/// gain energy by being closed at once, as what turns by radians a step, is closed at up to 100 m/s and
/// rad/s, and gets no more energy by impulses than that takes. Rigid joints to what stands still give
/// a component no energy, and take none, where nothing touches it and it turns by 0.1 to 0.8 rad a step.
///
/// Joints of closed loops, and joints that say the same, share their load by impulses of least size.
/// Bodies that hold NaN have no joints for the step, and if numbers overflow nothing acts in it. A step
/// never throws; it allocates only while islands grow or form anew. The same calls give the same bits; of
/// the last step an instance remembers what its joints bore. An instance is used from one thread at a
/// time; `btConstraintSolverPoolMt` takes several.
class ExactJointSolver : public btSequentialImpulseConstraintSolver {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  ExactJointSolver();
  ~ExactJointSolver() override;
  ExactJointSolver(const ExactJointSolver&) = delete;
  ExactJointSolver& operator=(const ExactJointSolver&) = delete;

  /// How often (>= 0) a step corrects its velocities by what the joints would lack in position at its
  /// end. Default 1. With 0 joints hold in velocity, and drift is taken away as ERP says. A correction
  /// that does not lessen a large error is halved, or given up. Throws std::invalid_argument.
  void setPositionIterations(int iterations);
  int getPositionIterations() const { return m_position_iterations; }

  /// The largest change of velocity (m/s, rad/s) that the last pass over the rows with bounds still
  /// made, in the last island that had joints and any such rows: how far limits, motors, contacts and
  /// friction are from being met all at once.
  btScalar getComplementarityResidual() const { return m_complementarity_residual; }
  /// What the solver holds on to from step to step, bytes.
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

  /// The rows that Bullet's pool has from `first` on.
  void convertJoint(btTypedConstraint& joint, const StepOfRows& step, int first, int count);
  bool hasContacts() const { return m_tmpSolverContactConstraintPool.size() > 0; }
  bool hasBounds() const;
  bool stiffen(const btContactSolverInfo& info);
  template <class Pass>
  int solveIsland(const btContactSolverInfo& info, bool again, const Pass& pass);
  struct Pools;
  /// Of joints, and of contacts.
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
