// Purpose: Bullet's iterations with Pintle's rows for the stock joints of a world, which stay as they are.
#pragma once

#include <pintle/solver/upgrading_solver.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Takes the place of `btSequentialImpulseConstraintSolver` in a world, with nothing else changed:
///
///     pintle::SequentialJointSolver solver;
///     btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
///
/// A constraint whose class is exactly `btHingeConstraint`, `btHingeAccumulatedAngleConstraint`, `btPoint2PointConstraint`,
/// `btSliderConstraint`, `btConeTwistConstraint`, `btFixedConstraint` or `btUniversalConstraint` is solved as a joint of Pintle's
/// (QuaternionHinge, BallJoint, SliderJoint, ConeTwistJoint; the last two, which are joints of six degrees of freedom, as
/// Generic6DofSpring2Joint and Generic6DofJoint), with the settings that stand in the object at the start of the step. The result is
/// that joint's, to the bit.
///
/// The object, its address, its type and its file stay. A step leaves there what one of Bullet's leaves: applied impulse, feedback,
/// the enabled flag of a joint that breaks, and what getters tell of angles, positions and limits.
///
/// - A client's subclass keeps its own rows, and so does any other class. (Joints of six degrees of freedom that are none of these are
///   upgraded by the exact solvers alone.)
/// - A joint that sleeps, is removed for a step, or is made anew starts anew, by its limits' turn. An accumulated angle is counted on.
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
