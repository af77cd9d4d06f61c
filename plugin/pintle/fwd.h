// Purpose: the names of all joints and solvers, for headers that only point to them.
#pragma once

#include <pintle/precision.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

class AngularLimit;
class BallJoint;
class ConeTwistJoint;
class ConstantVelocityJoint;
class ContactJoint;
class DistanceJoint;
class DotHinge;
class FixedJoint;
class GearCoordinate;
class GearJoint;
class Generic6DofJoint;
class Generic6DofSpring2Joint;
class Generic6DofSpringJoint;
class Hinge2Joint;
class QuaternionHinge;
class SliderJoint;
class TwoPointHinge;
class UniversalJoint;
class WedgeJoint;

// Their bases, and what they hold.
class DrivenJoint;
class FrameJoint;
class HingeBase;
class Joint;
class PosedJoint;
class BallModel;
class ConeTwistModel;
class GearModel;
class HingeModel;
class QuaternionHingeModel;
class SixDofModel;
class SliderModel;
struct PoseDrive;
class StandaloneJoint;

// unstable/: for comparison only.
class CrossProductHinge;
class CrossProductMatrixHinge;
class SingleRowLock;

// solver/
class ExactJointSolver;
class ExactJointSolverPool;
class ExactMultiBodyJointSolver;
class SequentialJointSolver;
class SequentialMultiBodyJointSolver;
struct SolverOptions;
class StepLog;
struct StepReport;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
