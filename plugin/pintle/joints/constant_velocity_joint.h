// Purpose: the constant velocity joint (document, 3.1.3 + 3.2.10).
#pragma once

#include <pintle/joints/frame_joint.h>
#include <pintle/joints/observed_joint.h>
#include <pintle/rows/far_limit.h>
#include <pintle/rows/unwrapped_angle.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Two shafts that meet in a point, at any bend below 180 degrees in any direction, and turn each
/// at the speed of the other: no twist between them. Each shaft is x of the joint frame in its
/// body. It has no counterpart in Bullet.
///
/// \image html constant_velocity_joint.svg
class ConstantVelocityJoint : public ObservedJoint<ConstantVelocityJoint, FrameJoint> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Pivots (m) and shafts in the bodies' frames; shafts are made unit. There is no twist where the
  /// bodies are now.
  ConstantVelocityJoint(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
                        const btVector3& pivotInB, const btVector3& shaftInA,
                        const btVector3& shaftInB);
  /// Joint frames in the bodies' frames, x along the shafts. There is no twist where y and z of the
  /// two are as they would be after a bend of coinciding frames.
  ConstantVelocityJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                        const btTransform& frameInB);
  /// To the world, where the body is now.
  ConstantVelocityJoint(btRigidBody& rbA, const btTransform& frameInA);

  /// The angle between the shafts (rad, in [0, pi]).
  btScalar getBend() const;
  /// The error: the angle by which one shaft has turned further than the other (rad, in [-pi, pi],
  /// body b against a).
  btScalar getTwist() const;
  /// The most that the joint may bend (rad, >= 0; pi, infinity or more: anything, the default).
  void setBendLimit(btScalar max_bend);
  /// rad, as setBendLimit set it.
  btScalar getBendLimit() const { return m_bend.high; }
  /// Makes the limit a spring and damper (document, 2.4): frequency (Hz) and damping ratio (>= 0; 1
  /// is critical). Frequency 0: a hard limit again.
  void setBendLimitSpring(btScalar frequency_hz, btScalar damping_ratio);
  /// The part of its speed (>= 0) with which the limit sends the joint back. Default 0.
  void setBendLimitBounce(btScalar bounce);
  /// Dry friction of at most max_torque (N m, >= 0 or infinite) against a change of the bend's
  /// angle; its direction may turn. 0: none.
  void setBendFriction(btScalar max_torque);
  /// Velocity motor of the bend's angle: target speed (rad/s) and the most that it may apply (N m, >= 0
  /// or infinite). A straight joint has no direction to bend in; to straighten one, take a servo.
  void enableBendMotor(bool on, btScalar velocity, btScalar max_torque);
  /// Turns the bend's motor, velocity motor or servo as it was set last, on or off.
  void enableBendMotor(bool on);
  /// Holds a bend (rad, 0 to pi) by a spring (frequency > 0 in Hz, damping ratio >= 0) of at most
  /// max_torque (N m, >= 0 or infinite), until told otherwise.
  void setBendServo(btScalar target_bend, btScalar frequency_hz, btScalar damping_ratio,
                    btScalar max_torque);

  /// How far the shafts have turned under the bend (rad, with all turns since the joint was made):
  /// it grows at W while both turn at W about their own shafts, right-handed, and the bend stays
  /// where it is in the world. The joint sees its shafts turn by the bend only: a straight joint
  /// has no shaft angle, and one that bends the other way has turned by half a turn.
  btScalar getShaftAngle() const;
  /// Velocity motor of the shaft angle: target speed (rad/s) and the most that it may apply along
  /// the shafts (N m, >= 0 or infinite). It turns both shafts alike, against the bearings that keep
  /// their bend, as the pistons of a bent-axis motor do: the joint presses on body b across its
  /// shaft, with max_torque / sin(bend), and body a has what turns it from the reaction. Between
  /// bodies that nothing holds it makes the bend go round instead. While the sine of the bend is
  /// below minMotorSine there is no such lever, and no motor. Against bearings that are joints of
  /// their own Bullet's solver takes about 3 / sin(bend)^2 iterations to reach the speed under a
  /// load.
  void enableMotor(bool on, btScalar velocity, btScalar max_torque);
  /// Turns the motor, velocity motor or servo as it was set last, on or off.
  void enableMotor(bool on);
  /// Holds a shaft angle (rad, any number of turns) by a spring (frequency > 0 in Hz, damping ratio
  /// >= 0) of at most max_torque (N m, >= 0 or infinite) with the same lever, until told otherwise.
  void setMotorServo(btScalar target_angle, btScalar frequency_hz, btScalar damping_ratio,
                     btScalar max_torque);
  /// Dry friction of at most max_torque (N m, >= 0 or infinite) against the shafts' turning, with the
  /// same lever. 0: none.
  void setFriction(btScalar max_torque);
  /// The sine of the bend below which the shafts have no motor and no friction.
  static constexpr btScalar minMotorSine() { return btScalar(0.1); }

  ///@{
  /// Impulses of the last step (N m s): of the bend, negative as they straighten it; of motor and
  /// friction of the shafts, positive along the shaft angle.
  btScalar getBendLimitImpulse() const { return axisImpulse(0, Axis::limit); }
  btScalar getBendFrictionImpulse() const { return axisImpulse(0, Axis::friction); }
  btScalar getBendMotorImpulse() const { return axisImpulse(0, Axis::motor); }
  btScalar getMotorImpulse() const { return axisImpulse(1, Axis::motor); }
  btScalar getFrictionImpulse() const { return axisImpulse(1, Axis::friction); }
  ///@}

  /// The frames, and the cone of the bend.
  void drawJoint(btIDebugDraw& drawer) const override;
  const char* name() const override { return "ConstantVelocityJoint"; }

 protected:
  void framesChanged() override;

 private:
  friend ObservedJoint;
  struct Observation;
  Observation observe(const PosePair& poses) const;
  UnwrappedAngle shaftAngle(const Observation& seen) const;
  void remember(const Observation& seen, bool);
  void constrain(const Observation& seen, Rows& rows) const;
  bool bendMayReachLimit(const Observation& seen, Scalar cosine, const Rows& rows) const;

  static Axis freeBend();

  Axis m_bend = freeBend();  ///< along the bend: its limit has one side
  Axis m_shaft;              ///< along the shaft angle: the motor
  CosineLimit m_bend_look;   ///< the limit
  UnwrappedAngle m_shaft_angle;
  static constexpr RowCount row_count{6, 2};
};

extern template class ObservedJoint<ConstantVelocityJoint, FrameJoint>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
