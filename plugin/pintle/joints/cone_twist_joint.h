// Purpose: the ball joint with limits of swing and twist (document, 3.1.3 + 3.2.6, and the swing and
// twist of A.3.7), in the place of btConeTwistConstraint.
#pragma once

#include <pintle/joints/cone_twist_model.h>
#include <pintle/joints/joint_of.h>

#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A point of each body coincide, as in a shoulder. The rotation of a against b, from joint frame to
/// joint frame, is a twist about x followed by a swing about an axis normal to x. The swing stays in
/// a cone that is fixed in body b, the twist in a range.
///
/// Swing 1 is the component of the swing's rotation vector about the frame's z, swing 2 that about y
/// (rad). The cone is an ellipse of both: (swing 1 / span 1)^2 + (swing 2 / span 2)^2 <= 1. A swing
/// whose span is below the fix threshold (default 0.05 rad) is locked. With one swing locked the
/// other is the angle about y (z) of body a between the two x axes, as Bullet has it; with both
/// locked the joint turns about x only.
///
/// It is a btConeTwistConstraint: everything of that is Bullet's own, but for the rows, and but for what is below. A number that is
/// not finite is not used: the last good one stays (Joint::whyIgnored). What Bullet's numbers do:
/// - spans either side (rad): a swing span below the fix threshold locks, two of pi or more are free; a twist span of 0 locks, of
///   less frees, as does one of pi or more;
/// - softness (>= 0) times a span is where the limit is;
/// - a step takes away biasFactor / relaxationFactor^2 of what is beyond it (at most all); a relaxation factor of 0 turns both limits
///   off;
/// - damping: nothing; kept to be read;
/// - angular only: no position rows, which Bullet keeps;
/// - the motor turns a against b to its target: each step goes biasFactor of the way, and may apply
///   up to the maximal impulse (N m s; below 0: any) along it, and as much against what turns the
///   bodies out of the way. Normalized: the impulse that changes the spin of a alone by so much
///   (rad/s). Unlike Bullet's it brakes, keeps to the limits, and normalizes;
/// - ERP and CFM (setParam; >= 0): of the position by axes 0 to 2; the ERP of the others is the bias factor, their CFM that of limits
///   and motor.
///
/// \image html cone_twist_joint.svg
class ConeTwistJoint : public JointOf<btConeTwistConstraint, ConeTwistModel> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Joint frames in the bodies' frames, x the twist axis.
  ConeTwistJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& rbAFrame,
                 const btTransform& rbBFrame);
  /// To the world, as Bullet has it: the world's frame has the axes of `rbAFrame` as they stand, and
  /// lies at the world's origin. (setFrames puts it elsewhere.)
  ConeTwistJoint(btRigidBody& rbA, const btTransform& rbAFrame);

  // --- methods of Bullet's, for more limits, more digits, or as things are now --------------------
  ///@{
  /// Bullet's cone-twist hides those that are not const.
  using btTypedConstraint::getRigidBodyA;
  using btTypedConstraint::getRigidBodyB;
  ///@}
  ///@{
  /// The joint frames in the bodies' frames (m), x the twist axis.
  void setFrames(const btTransform& frameA, const btTransform& frameB) override;
  btTransform& getFrameOffsetA();
  btTransform& getFrameOffsetB();
  using btConeTwistConstraint::getFrameOffsetA;
  using btConeTwistConstraint::getFrameOffsetB;
  ///@}

  ///@{
  /// As Bullet's, and in the place of what setSwingLimits and setTwistLimit set: also by the spans that stand there.
  void setLimit(btScalar swingSpan1, btScalar swingSpan2, btScalar twistSpan,
                btScalar softness = 1.f, btScalar biasFactor = 0.3f,
                btScalar relaxationFactor = 1.0f);
  /// One of the spans: 3 is twist, 4 swing 2, 5 swing 1.
  void setLimit(int limitIndex, btScalar limitValue);
  ///@}

  /// The next four say what holds now,
  void calcAngleInfo();
  /// or at these poses of the bodies (world), until the next step or new frames. The inertias are not
  /// needed here.
  void calcAngleInfo2(const btTransform& transA, const btTransform& transB,
                      const btMatrix3x3& invInertiaWorldA, const btMatrix3x3& invInertiaWorldB);
  /// The size of the twist (rad, >= 0) now; as in Bullet 0 if it is free by a span below 0.
  btScalar getTwistAngle() const;
  ///@{
  /// Whether the twist, the swing is beyond its limit now. As in Bullet a locked swing always is.
  int getSolveTwistLimit();
  int getSolveSwingLimit() { return isPastSwingLimit(); }
  bool isPastSwingLimit();
  ///@}

  /// Bullet's. Memory for a motor is taken here, and not in a step.
  void enableMotor(bool b);
  ///@{
  /// q: the rotation of body a against body b, or of the joint frames (of any length but 0). What is beyond the limits is
  /// cut off. Takes the place of setMotorVelocity.
  void setMotorTarget(const btQuaternion& q);
  void setMotorTargetInConstraintSpace(const btQuaternion& q);
  ///@}

  /// A point of the cone's edge in the frame of b, `length` (m) from the pivot: where x of a would be
  /// after the largest swing about (0, cos(angle), -sin(angle)).
  btVector3 GetPointForAngle(btScalar angleInRadians, btScalar length) const;

  // --- beyond Bullet -----------------------------------------------------------------------------
  ///@{
  /// The joint frames in the world, at the bodies' poses of now.
  btTransform getCalculatedTransformA() const {
    return m_rbA.getCenterOfMassTransform() * getAFrame();
  }
  btTransform getCalculatedTransformB() const {
    return m_rbB.getCenterOfMassTransform() * getBFrame();
  }
  ///@}
  /// Spans that differ on both sides: min <= 0 <= max (rad) for each swing, the cone's edge made of
  /// four quarters of ellipses. A side is at least 1e-4 rad wide. Bullet's own getters and files have the larger side for both.
  void setSwingLimits(btScalar min_1, btScalar max_1, btScalar min_2, btScalar max_2);
  /// low <= twist <= high (rad), both within 2 pi of 0; equal ones lock. low > high, or a range of a
  /// turn or more: free. A twist outside is brought to the nearer end. Bullet's own getters and files have the larger side for both.
  void setTwistLimit(btScalar low, btScalar high);
  ///@{
  /// Makes a limit a spring and damper (document, 2.4): frequency (Hz) and damping ratio (>= 0) of
  /// the joint as its bodies alone make it swing. Frequency 0: a hard limit again.
  void setSwingLimitSpring(btScalar frequency_hz, btScalar damping_ratio);
  void setTwistLimitSpring(btScalar frequency_hz, btScalar damping_ratio);
  ///@}

  /// Makes the motor turn a against b at `velocity` (rad/s, along the axes of frame b), as far as the
  /// limits let it and until a target is set, with the same bound. (By a pointer to Bullet's class: another target.)
  void setMotorVelocity(const btVector3& velocity);
  /// Dry friction of at most max_torque (N m, >= 0 or infinite) about each of the axes of frame b.
  void setFriction(btScalar max_torque);

  ///@{
  /// rad, of a against b now: the components of the swing about z and y of frame b, and the twist in
  /// (-pi, pi].
  btScalar getSwing1() const;
  btScalar getSwing2() const;
  btScalar getTwist() const;
  ///@}

  ///@{
  /// Impulses of the last step (N m s): of the limits outwards (swing), along the twist; and of motor
  /// and friction on body a, in the world.
  btScalar getSwingLimitImpulse() const { return axisImpulse(swing_axis, Axis::limit); }
  btScalar getTwistLimitImpulse() const { return axisImpulse(twist_axis, Axis::limit); }
  btVector3 getMotorImpulse() const { return rotationImpulse(Axis::motor); }
  btVector3 getFrictionImpulse() const { return rotationImpulse(Axis::friction); }
  ///@}

 private:
  void readNow() const;
  ConeTwistReadings readings() const;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
