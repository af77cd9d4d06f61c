// Purpose: the base of all hinges: what btHingeConstraint and btHingeAccumulatedAngleConstraint have,
// but for the rows that keep the axes parallel.
#pragma once

#include <pintle/joints/frame_joint.h>
#include <pintle/rows/unwrapped_angle.h>

namespace pintle {
namespace equations {
template <class T>
struct Swing;
}

inline namespace PINTLE_PRECISION {

struct Acting;

/// One rotation about an axis common to two bodies. The axis is z of a joint frame in each body.
///
/// The hinge angle (rad) is Bullet's: with `useReferenceFrameA` false it is the rotation of a
/// against b, with true that of b against a. It is zero when the joint frames coincide. Limits and
/// accumulated angles may span any number of turns.
class HingeBase : public FrameJoint {
 public:
  // --- btHingeConstraint -------------------------------------------------------------------------
  ///@{
  /// The joint frames in the bodies' frames, z the hinge axis.
  const btTransform& getAFrame() const { return m_frame_a; }
  const btTransform& getBFrame() const { return m_frame_b; }
  btTransform& getAFrame() { return m_frame_a; }
  btTransform& getBFrame() { return m_frame_b; }
  ///@}

  /// A new axis in body a; the frame of b follows as Bullet sets it.
  void setAxis(const btVector3& axisInA);

  /// Velocity motor: target velocity (rad/s) along the hinge angle, and the most that it may apply
  /// in a step (N m s, >= 0).
  void enableAngularMotor(bool enableMotor, btScalar targetVelocity, btScalar maxMotorImpulse);
  /// Turns the motor, velocity motor or servo as it was set last, on or off.
  void enableMotor(bool enableMotor);
  /// N m s a step, >= 0.
  void setMaxMotorImpulse(btScalar maxMotorImpulse);
  /// rad/s, along the hinge angle.
  void setMotorTargetVelocity(btScalar motorTargetVelocity);
  /// The velocity that reaches the target (rad) in dt (s, > 0); to be called in each step. With a
  /// limit the angle is the accumulated one, clamped to the limit; without, that within the turn.
  void setMotorTarget(btScalar targetAngle, btScalar dt);
  /// The same; qAinB is the rotation of body a against body b.
  void setMotorTarget(const btQuaternion& qAinB, btScalar dt);
  /// Whether a motor or servo is on.
  bool getEnableAngularMotor() { return m_axis.drive != Axis::Drive::off; }
  /// rad/s.
  btScalar getMotorTargetVelocity() { return m_axis.motor_velocity; }
  /// N m s a step.
  btScalar getMaxMotorImpulse() { return m_axis.max_motor_impulse; }

  /// low <= accumulated angle <= high (rad), over any number of turns. low = high locks, low > high
  /// frees, and so does (-pi, pi), as in Bullet; an infinite side is free. The bias factor scales the speed of the correction, bias
  /// times relaxation is the rebound (0: none). As in Bullet the softness has no effect. A new
  /// limit of less than a turn holds, as in Bullet, in the turn that the joint is in: the
  /// accumulated angle changes by whole turns to lie inside it or as near as can be. Not if the
  /// turn was given by setAccumulatedHingeAngle.
  void setLimit(btScalar low, btScalar high, btScalar softness = 0.9f, btScalar biasFactor = 0.3f,
                btScalar relaxationFactor = 1.0f);
  /// The same limits and no others: also at -pi and pi.
  void setAccumulatedLimit(btScalar low, btScalar high);
  ///@{
  /// What setLimit set.
  btScalar getLimitSoftness() const { return m_limit_softness; }
  btScalar getLimitBiasFactor() const { return m_axis.bias; }
  btScalar getLimitRelaxationFactor() const { return m_axis.relaxation; }
  ///@}

  /// As in Bullet false also for low = high.
  bool hasLimit() const { return m_axis.low < m_axis.high; }
  /// rad, as setLimit set it.
  btScalar getLowerLimit() const { return m_axis.low; }
  /// rad, as setLimit set it.
  btScalar getUpperLimit() const { return m_axis.high; }
  /// Whether the angle at these poses would break the limit; changes only the answers to the next
  /// two.
  void testLimit(const btTransform& transA, const btTransform& transB);
  ///@{
  /// Whether the limit was broken when the joint last looked, and on which side: +1 low, -1 high.
  int getSolveLimit() { return getLimitSign() != 0; }
  btScalar getLimitSign();
  ///@}

  /// rad, in [-pi, pi].
  btScalar getHingeAngle();
  /// The same at other poses of the bodies (world).
  btScalar getHingeAngle(const btTransform& transA, const btTransform& transB);

  ///@{
  /// As in Bullet a flag that the constructor has used; changing it changes no sign.
  bool getUseReferenceFrameA() const { return m_use_reference_frame_a; }
  void setUseReferenceFrameA(bool useReferenceFrameA) {
    m_use_reference_frame_a = useReferenceFrameA;
  }
  ///@}
  ///@{
  /// Bullet's way to rows that converge; here it is setBlockRows.
  bool getUseFrameOffset() { return getBlockRows(); }
  void setUseFrameOffset(bool frameOffsetOnOff) { setBlockRows(frameOffsetOnOff); }
  ///@}

  /// ERP: position and axis rows, and the limit unless it has its own; CFM: the motor; STOP_ERP,
  /// STOP_CFM: the limit. >= 0. Axis -1 or 5. As in Bullet other axes and parameters are ignored, and
  /// read as 0. NaN and infinity are refused for all.
  void setParam(int num, btScalar value, int axis = -1) override;
  /// What setParam set; unset it is 0.
  btScalar getParam(int num, int axis = -1) const override;
  /// BT_HINGE_FLAGS_* of the parameters that were set.
  virtual int getFlags() const;

  ///@{
  /// The rows at other poses of the bodies; no more than getInfo1 announced. The velocities are the
  /// bodies' own, whatever is given. (Bullet has two more names for it.)
  void getInfo2NonVirtual(btConstraintInfo2* info, const btTransform& transA,
                          const btTransform& transB, const btVector3& angVelA,
                          const btVector3& angVelB);
  void getInfo2Internal(btConstraintInfo2* info, const btTransform& transA,
                        const btTransform& transB, const btVector3& angVelA,
                        const btVector3& angVelB);
  void getInfo2InternalUsingFrameOffset(btConstraintInfo2* info, const btTransform& transA,
                                        const btTransform& transB, const btVector3& angVelA,
                                        const btVector3& angVelB);
  ///@}

  // --- btHingeAccumulatedAngleConstraint ---------------------------------------------------------
  /// rad, with all turns since the joint was made: exact while no more than half a turn passes
  /// between two steps or calls.
  btScalar getAccumulatedHingeAngle();
  /// Says which turn the joint is in, for instance after a teleport: the angle becomes the one that
  /// fits the pose and is nearest to `accAngle`.
  void setAccumulatedHingeAngle(btScalar accAngle);

  // --- beyond Bullet -----------------------------------------------------------------------------
  /// Makes the limit a spring and damper (document, 2.4): frequency (Hz) and damping ratio (>= 0; 1
  /// is critical) of the hinge as its bodies alone make it swing. Frequency 0: a hard limit again.
  void setLimitSpring(btScalar frequency_hz, btScalar damping_ratio);
  /// Holds an accumulated angle (rad) by a spring (frequency > 0 in Hz, damping ratio >= 0) of at
  /// most max_torque (N m, >= 0 or infinite), until told otherwise. Takes the place of the velocity
  /// motor.
  void setMotorServo(btScalar target_angle, btScalar frequency_hz, btScalar damping_ratio,
                     btScalar max_torque);
  /// Dry friction of at most max_torque (N m, >= 0 or infinite). 0: none.
  void setFriction(btScalar max_torque);
  ///@{
  /// Impulses of the last step (N m s), positive towards larger hinge angles.
  btScalar getMotorImpulse() const { return axisImpulse(0, Axis::motor); }
  btScalar getLimitImpulse() const { return axisImpulse(0, Axis::limit); }
  btScalar getFrictionImpulse() const { return axisImpulse(0, Axis::friction); }
  ///@}

  /// The frames, and the range of the angle about the axis of b.
  void drawJoint(btIDebugDraw& drawer) const override;

 protected:
  HingeBase(btRigidBody& a, btRigidBody& b, RowCount max_rows, bool useReferenceFrameA);
  HingeBase(btRigidBody& a, RowCount max_rows,
            bool useReferenceFrameA);  ///< b is Bullet's fixed body

  // The rest of a constructor, as Bullet's hinge has it: the joint calls one of these in its own
  // body, where errors know its name.
  void begin(const btVector3& pivotInA, const btVector3& pivotInB, const btVector3& axisInA,
             const btVector3& axisInB);
  void begin(const btVector3& pivotInA, const btVector3& axisInA);
  void begin(const btTransform& rbAFrame, const btTransform& rbBFrame);
  void begin(const btTransform& rbAFrame);

  void framesChanged() override;
  /// Another limit was set.
  void limitSet(const Axis& before);
  /// The limit or its spring was set.
  virtual void limitChanged() {}

  // For the rows of the hinges: hinge_rows.h, inline.
  struct Observation;
  Observation observe(const PosePair& poses) const;
  void remember(const Observation& seen, bool in_step);
  Acting acting(const Observation& seen, const equations::Swing<Scalar>& swing,
                const Rows& rows) const;
  void addAxisRow(const Acting& acting, const equations::Swing<Scalar>& swing, Rows& rows) const;

  Axis m_axis;              ///< along the hinge angle
  UnwrappedAngle m_twist;   ///< of b against a, about z
  UnwrappedAngle m_tested;  ///< the last one held against the limit
  Scalar m_sign;            ///< hinge angle = sign * twist

 private:
  Scalar angle() const { return m_sign * m_twist.value(); }

  Scalar m_limit_softness = Scalar(0.9);
  bool m_turn_given = false;
  bool m_use_reference_frame_a;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
