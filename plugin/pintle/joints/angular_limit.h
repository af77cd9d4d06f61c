// Purpose: a limit, motor and friction of the angle about an axis of body a (document, 3.2.8), to be
// added to a joint that leaves the angle free.
#pragma once

#include <pintle/joints/frame_joint.h>
#include <pintle/joints/observed_joint.h>
#include <pintle/rows/unwrapped_angle.h>

namespace pintle {
namespace equations {
template <class T>
struct AngleAbout;
}

inline namespace PINTLE_PRECISION {

/// The angle about z of the joint frame in body a to x of that in body b, as seen along z. Nothing
/// holds the bodies together: add it to a BallJoint, a UniversalJoint, or alone.
///
/// The angle means less and less as x of b nears z of a: its axis of rotation then moves with the
/// tilt, and within 3 degrees the joint lets go of it, and takes it up again where it was. Where
/// the other angles pass 90 degrees use a WedgeJoint. Conditioned: the exact gradient of the angle.
/// Document: z of a, exact only while x of b is at right angles to it.
///
/// \image html angular_limit.svg
class AngularLimit : public ObservedJoint<AngularLimit, FrameJoint> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Joint frames in the bodies' frames; their origins are for drawing only.
  AngularLimit(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
               const btTransform& frameInB);
  /// To the world, where the frame is now.
  AngularLimit(btRigidBody& rbA, const btTransform& frameInA);

  /// low <= accumulated angle <= high (rad), over any number of turns. low = high locks, low > high
  /// frees, an infinite side is free. A new limit of less than a turn holds in the turn that the
  /// joint is in, unless setAccumulatedAngle has said which one that is.
  void setLimit(btScalar low, btScalar high);
  /// rad, as setLimit set it.
  btScalar getLowerLimit() const { return m_axis.low; }
  /// rad, as setLimit set it.
  btScalar getUpperLimit() const { return m_axis.high; }
  /// Makes the limit a spring and damper (document, 2.4): frequency (Hz) and damping ratio (>= 0; 1
  /// is critical) of the bodies as they alone would swing about the axis. Frequency 0: rigid again.
  void setLimitSpring(btScalar frequency_hz, btScalar damping_ratio);

  /// Turns b against a at target_velocity (rad/s), by at most max_impulse in a step (N m s, >= 0).
  void enableAngularMotor(bool enable, btScalar target_velocity, btScalar max_impulse);
  /// Holds an accumulated angle (rad) by a spring (frequency > 0 in Hz, damping ratio >= 0) of at
  /// most max_torque (N m, >= 0 or infinite), until told otherwise. Takes the place of the motor.
  void setMotorServo(btScalar target_angle, btScalar frequency_hz, btScalar damping_ratio,
                     btScalar max_torque);
  /// Turns the motor or servo, as it was set last, on or off.
  void enableMotor(bool enable);
  /// Whether a motor or servo is on.
  bool getEnableAngularMotor() const { return m_axis.drive != Axis::Drive::off; }
  /// Dry friction of at most max_torque (N m, >= 0 or infinite). 0: none.
  void setFriction(btScalar max_torque);

  /// rad, in [-pi, pi], as the bodies are now.
  btScalar getAngle() const;
  /// rad, with all turns since the joint was made: exact while the bodies turn against each other by
  /// less than half a turn between two steps.
  btScalar getAccumulatedAngle();
  /// Says which turn the joint is in: the angle becomes the one that fits the pose and is nearest.
  void setAccumulatedAngle(btScalar angle);

  ///@{
  /// Impulses of the last step (N m s), positive towards larger angles.
  btScalar getMotorImpulse() const { return axisImpulse(0, Axis::motor); }
  btScalar getLimitImpulse() const { return axisImpulse(0, Axis::limit); }
  btScalar getFrictionImpulse() const { return axisImpulse(0, Axis::friction); }
  ///@}

  /// The frames, and the range of the angle about the axis of a.
  void drawJoint(btIDebugDraw& drawer) const override;
  const char* name() const override { return "AngularLimit"; }

 protected:
  void framesChanged() override;

 private:
  friend ObservedJoint;
  // It is nothing else.
  using FrameJoint::getAngularOnly;
  using FrameJoint::setAngularOnly;

  struct Observation;
  Observation observe(const PosePair& poses) const;
  void remember(const Observation& seen, bool);
  void constrain(const Observation& seen, Rows& rows) const;

  Axis m_axis;
  UnwrappedAngle m_angle;
  bool m_turn_given = false;
  static constexpr RowCount row_count{1, 1};
};

extern template class ObservedJoint<AngularLimit, FrameJoint>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
