// Purpose: a solver for Bullet's worlds of which joints hold to the last digits, and create no energy.
#pragma once

#include <pintle/solver/joint_solver.h>
#include <pintle/solver/uses_exact_solver.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Takes the place of `btSequentialImpulseConstraintSolver` in a world, with nothing else changed:
///
///     pintle::ExactJointSolver solver;
///     btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
///
/// All joints that hang together, of Pintle's and of Bullet's, are solved at once, by a sparse factorisation in double, in time and
/// memory that are linear in the joints of a tree. An island without joints is solved by Bullet's own code, to the same bits. Its
/// tolerances and bounds are SolverOptions; what it did in a step is in lastStep(), and a StepLog writes it down.
///
/// **Stock joints are upgraded.** A hinge, ball, slider, cone-twist or gear of Bullet's, or any of its joints of six degrees of freedom,
/// is solved as the joint of Pintle's that has its equations, with the settings that stand in the object, which stays as it is (SequentialJointSolver). What is said of Bullet's joints
/// below is of other classes, of clients' subclasses, and of all with setUpgradesBulletJoints(false).
///
/// **Joints hold.** At the end of a step that converges, every joint and limit is where it should be to 1e-9 m or rad (1e-6 in
/// single precision, and the rounding of positions), whatever its load: SolverOptions::pose_tolerance. Velocities are those with
/// which rows are met at the END of the step. Where nothing leads there, rows hold in velocity, and poses are moved for the rest.
/// What starts further apart comes together by its ERP, by poses alone: that gives no velocity. Bullet's joints tell no errors at
/// other poses than that of the start: those that hold a point are held there, too; others drift by what a step bends, and return
/// by their ERP.
///
/// **Joints do no work.** What the impulses of joints and limits have given a component in sum never exceeds 1 % of its largest recent
/// kinetic energy (SolverOptions::ledger_share). Where moving poses lifts bodies, velocities pay for it as far as they can. Motors,
/// servos, springs, and bodies that their owners move may do work. Linear and angular momentum stay, but for the angular momentum of
/// poses that are moved.
///
/// **Softness.** CFM of any size is exact. A soft equality is a spring and damper of its ERP and CFM, which starts without tension
/// wherever it is; so is a soft stop that is reached. What joints of loops say twice they share; where they contradict, they give way.
///
/// **Motors, limits, friction and thresholds** are solved with the joints: which of them are at a bound is found anew in each step. A
/// joint breaks at what it bears when all else is solved, and the step is then solved without it.
///
/// **Contacts** of jointed bodies are iterated as Bullet does it, for the world's number of iterations, each with what joints make of
/// it. Joints hold whatever contacts do; contacts are met as far as the iterations lead, and go on from there in the next step.
///
/// **Memory.** A step allocates only where islands grow or form anew, where a joint has more or less rows than before, or where more
/// iterations are taken than ever. What is at rest or swings on allocates nothing. What is kept of a
/// component is forgotten when a step does not solve it. The same calls give the same bits.
///
/// **Threads.** An instance is used from one thread at a time. An ExactJointSolverPool has several, which share what they keep of the
/// world. A btDiscreteDynamicsWorldMt is to have no solver of its own for large islands. usesExactSolver() tells whether a world
/// takes what it was given: a btMultiBodyDynamicsWorld needs an ExactMultiBodyJointSolver.
///
/// **Errors.** A step never throws. Bodies that hold NaN have no joints of Pintle's for the step; if numbers overflow, nothing acts in
/// it.
class ExactJointSolver : public JointSolver<btSequentialImpulseConstraintSolver> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
