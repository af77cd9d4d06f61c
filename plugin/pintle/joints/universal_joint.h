// Purpose: the universal joint (document, 3.1.3 + 3.2.9), in the place of btUniversalConstraint.
#pragma once

#include <pintle/joints/observed_joint.h>
#include <pintle/joints/posed_joint.h>
#include <pintle/rows/unwrapped_angle.h>

#include <BulletDynamics/ConstraintSolver/btGeneric6DofConstraint.h>

#include <memory>

namespace pintle {
inline namespace PINTLE_PRECISION {

class AngularReach;

/// Two hinges at right angles: about axis 1, which is z of the joint frame in body a, and about
/// axis 2, which is y of the joint frame in body b. A spider between the bodies carries both.
///
/// Angles (rad) are Bullet's: angle 1 is the rotation of a against the spider about axis 1, angle 2
/// that of the spider against b about axis 2; both are zero when the joint frames coincide. (Off
/// their right angle by C, Bullet's differ from those of a spider by C sin(angle 2).) Bullet
/// numbers the axes of its six degrees of freedom: 5 is that of angle 1 and 4 that of angle 2, for
/// getAngle and getAxis 2 and 1; and as there setUpperLimit and setLowerLimit take angle 2 first.
/// Limits may span any number of turns, of both angles; nothing happens at 90 degrees but that a
/// bent shaft has no lever to turn the other one there.
///
/// Everything that btUniversalConstraint has, under the same name, with the same signs and
/// defaults, but what would free the position or drive it (getTranslationalLimitMotor).
///
/// \image html universal_joint.svg
class UniversalJoint : public ObservedJoint<UniversalJoint, PosedJoint> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  // --- btUniversalConstraint ---------------------------------------------------------------------
  /// Anchor (m) and axes in the world, where the bodies are now. Axes are made unit; they must be
  /// at right angles, to within 1e-3.
  UniversalJoint(btRigidBody& rbA, btRigidBody& rbB, const btVector3& anchor,
                 const btVector3& axis1, const btVector3& axis2);
  /// Joint frames in the bodies' frames.
  UniversalJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                 const btTransform& frameInB);
  /// To the world, where the body is now.
  UniversalJoint(btRigidBody& rbA, const btTransform& frameInA);

  ///@{
  /// The anchors in body a and in body b, where they are now (m, world).
  btVector3 getAnchor() const { return getCalculatedTransformA().getOrigin(); }
  btVector3 getAnchor2() const { return getCalculatedTransformB().getOrigin(); }
  ///@}

  ///@{
  /// As in Bullet the axes as they were given, in the world of that moment.
  const btVector3& getAxis1() const { return m_axis1; }
  const btVector3& getAxis2() const { return m_axis2; }
  ///@}

  ///@{
  /// rad, in [-pi, pi].
  btScalar getAngle1() const { return getAngle(2); }
  btScalar getAngle2() const { return getAngle(1); }
  ///@}

  ///@{
  /// As in Bullet the first bound is that of angle 2 and the second that of angle 1, whatever their
  /// names say.
  void setUpperLimit(btScalar ang1max, btScalar ang2max);
  void setLowerLimit(btScalar ang1min, btScalar ang2min);
  ///@}

  /// Axes in the world (unit or not, at right angles), through the anchor that the constructor was
  /// given: as in Bullet where that point of the world is, not where the bodies took it.
  void setAxis(const btVector3& axis1, const btVector3& axis2);

  // --- btGeneric6DofConstraint -------------------------------------------------------------------
  using PosedJoint::calculateTransforms;
  /// What the joint says of itself is again what holds now.
  void calculateTransforms() { forgetPoses(); }
  /// Called by nothing, and nothing to do.
  virtual void calcAnchorPos() {}
  /// rad: 2 angle 1, 1 angle 2, in [-pi, pi]; 0 the error by which the axes are off their right
  /// angle.
  btScalar getAngle(int axis_index) const;
  /// World: 1 axis 2, 0 the normal of both axes, 2 the z of body b, as Bullet has it.
  btVector3 getAxis(int axis_index) const;
  /// Of anchor b, along the axes of frame a (m).
  btScalar getRelativePivotPosition(int axis_index) const;
  /// low <= angle <= high (rad) of axis 5 (angle 1) or 4 (angle 2), over any number of turns. low =
  /// high locks, low > high frees, and so does (-pi, pi), as in Bullet; an infinite side is free. A new limit of less than a turn holds
  /// in the turn that the joint is in, unless setAccumulatedAngle said which that is. Defaults:
  /// +-(pi - 0.01) and +-(pi/2 - 0.01). Axes 0 to 3 are held: 0 and 0 only.
  void setLimit(int axis, btScalar lo, btScalar hi);
  ///@{
  /// All 0, and can be set to nothing else.
  void setLinearLowerLimit(const btVector3& linearLower);
  void setLinearUpperLimit(const btVector3& linearUpper);
  void getLinearLowerLimit(btVector3& linearLower) const { linearLower.setZero(); }
  void getLinearUpperLimit(btVector3& linearUpper) const { linearUpper.setZero(); }
  ///@}

  ///@{
  /// Of (nothing: 0, angle 2, angle 1).
  void setAngularLowerLimit(const btVector3& angularLower);
  void setAngularUpperLimit(const btVector3& angularUpper);
  void getAngularLowerLimit(btVector3& angularLower) const;
  void getAngularUpperLimit(btVector3& angularUpper) const;
  ///@}

  /// Axes 0 to 3 are held: limited.
  bool isLimited(int limitIndex) const;
  /// Limit and motor of angle 1 (index 2), angle 2 (1) and of the axis that is held (0), as Bullet has
  /// them, for as long as the joint lives. Written to, the fields have effect from the next step, call
  /// of a setter or of this on; they show what the setters do.
  ///   m_loLimit, m_hiLimit   rad: setLimit
  ///   m_enableMotor, m_targetVelocity (rad/s), m_maxMotorForce (N m, >= 0): enableMotor
  ///   m_bounce               >= 0: setLimitBounce
  ///   m_stopERP, m_stopCFM, m_normalCFM   >= 0; as in Bullet without effect before setParam of them
  ///   m_currentPosition, m_currentLimit, m_currentLimitError   as the last step found them
  ///   the others             as in Bullet without effect
  /// What is no setting (NaN, a bound below 0) goes back to what it was. Index 0 has the three
  /// parameters only.
  btRotationalLimitMotor* getRotationalLimitMotor(int index);
  /// Looks at the angle and its limit now (fields m_current..): whether limit or motor acts.
  bool testAngularLimitMotor(int axis_index);
  ///@{
  /// Kept, and without effect.
  bool getUseLinearReferenceFrameA() const { return m_use_linear_reference_frame_a; }
  void setUseLinearReferenceFrameA(bool linearReferenceFrameA) {
    m_use_linear_reference_frame_a = linearReferenceFrameA;
    ///@}
  }
  /// As in Bullet without effect.
  bool m_useSolveConstraintObsolete = false;
  ///@{
  /// Bullet's way to rows that converge; here it is setBlockRows.
  bool getUseFrameOffset() const { return getBlockRows(); }
  void setUseFrameOffset(bool frameOffsetOnOff) { setBlockRows(frameOffsetOnOff); }
  ///@}

  /// STOP_ERP and STOP_CFM of axis 4 or 5: its limit; of 0 to 3: all that is held, one value for
  /// them. CFM of axis 4 or 5: its motor; of 0 to 3: no effect, as in Bullet. >= 0. As in Bullet
  /// other axes (-1, too) and parameters (ERP) are ignored, and read as 0. NaN and infinity are
  /// refused for all.
  void setParam(int num, btScalar value, int axis = -1) override;
  /// What setParam set; unset it is 0.
  btScalar getParam(int num, int axis = -1) const override;
  /// BT_6DOF_FLAGS_* of the parameters that were set, three bits an axis.
  virtual int getFlags() const { return m_flags; }
  /// The rows at other poses of the bodies; no more than getInfo1 announced. The velocities are the
  /// bodies' own, whatever is given.
  void getInfo2NonVirtual(btConstraintInfo2* info, const btTransform& transA,
                          const btTransform& transB, const btVector3& linVelA,
                          const btVector3& linVelB, const btVector3& angVelA,
                          const btVector3& angVelB);

  // --- beyond Bullet -----------------------------------------------------------------------------
  // In all of these `axis` is 5 (angle 1) or 4 (angle 2).
  ///@{
  /// rad, as setLimit set it.
  btScalar getLowerLimit(int axis) const { return limitOf(indexOf(axis)).low; }
  btScalar getUpperLimit(int axis) const { return limitOf(indexOf(axis)).high; }
  ///@}

  /// The limits that setLimit sets, and no others: also at -pi and pi.
  void setAccumulatedLimit(int axis, btScalar lo, btScalar hi);
  /// rad, with all turns since the joint was made.
  btScalar getAccumulatedAngle(int axis) const;
  /// Says which turn the joint is in: the angle becomes the one that fits the pose and is nearest
  /// to `angle`.
  void setAccumulatedAngle(int axis, btScalar angle);
  /// Velocity motor: target speed of the angle (rad/s) and the most that it may apply (N m, >= 0 or
  /// infinite), Bullet's m_maxMotorForce. (Bullet drives the part of the speed along z of body b:
  /// cos(angle 2) times that of angle 1.)
  void enableMotor(int axis, bool on, btScalar velocity, btScalar max_torque);
  /// Turns the motor, velocity motor or servo as it was set last, on or off.
  void enableMotor(int axis, bool on);
  /// Holds an accumulated angle (rad) by a spring (frequency > 0 in Hz, damping ratio >= 0) of at
  /// most max_torque (N m, >= 0 or infinite), until told otherwise. Takes the place of the velocity
  /// motor.
  void setMotorServo(int axis, btScalar target_angle, btScalar frequency_hz, btScalar damping_ratio,
                     btScalar max_torque);
  /// Makes the limit a spring and damper (document, 2.4): frequency (Hz) and damping ratio (>= 0; 1
  /// is critical). Frequency 0: a hard limit again.
  void setLimitSpring(int axis, btScalar frequency_hz, btScalar damping_ratio);
  /// The part of its speed (>= 0) with which a limit sends the joint back. Default 0.
  void setLimitBounce(int axis, btScalar bounce);
  /// Dry friction of at most max_torque (N m, >= 0 or infinite). 0: none.
  void setFriction(int axis, btScalar max_torque);
  ///@{
  /// Impulses of the last step (N m s), positive towards larger angles.
  btScalar getMotorImpulse(int axis) const { return axisImpulse(indexOf(axis), Axis::motor); }
  btScalar getLimitImpulse(int axis) const { return axisImpulse(indexOf(axis), Axis::limit); }
  btScalar getFrictionImpulse(int axis) const { return axisImpulse(indexOf(axis), Axis::friction); }
  ///@}

  /// The frames, and as Bullet draws it the patch of a sphere in both ranges: all round where angle 1 has a
  /// turn or more, and angle 2 within a quarter of a turn.
  void drawJoint(btIDebugDraw& drawer) const override;
  const char* name() const override { return "UniversalJoint"; }

 protected:
  void framesChanged() override;

 private:
  friend ObservedJoint;
  // One of the two hinges: what acts along its angle, and what is remembered of it.
  struct Hinge {
    Axis axis;
    AxisParameters parameters;
    bool turn_given = false;
  };
  struct Observation;
  // alpha and beta of the equations: minus Bullet's angles.
  struct Angles {
    UnwrappedAngle alpha, beta;
    // The frames began more than a quarter of a turn apart about the normal of both axes, and have
    // not come back yet. A pose does not tell this from a beta of more than that.
    bool turned_over = false;
  };

  Observation observe(const PosePair& poses) const;
  void remember(Observation& seen, bool in_step);
  void constrain(const Observation& seen, Rows& rows) const;
  void follow(const Observation& seen, bool turns_fast, Angles& angles) const;
  void addHingeRow(int index, const Observation& seen, const AngularReach& reach,
                   bool look_at_limit, Rows& rows) const;
  /// Whether beta stays within a quarter of a turn: only then is turned_over an error.
  bool rightWayUp() const;
  int indexOf(int axis) const;
  Hinge& hinge(int axis) {
    takeLimitMotors();
    return m_hinges[indexOf(axis)];
  }
  const Hinge& hinge(int axis) const { return m_hinges[indexOf(axis)]; }
  UnwrappedAngle& angle(int index) { return index == 1 ? m_angles.alpha : m_angles.beta; }
  void setHingeLimit(int index, Scalar low, Scalar high);
  void limitSet(int index, const Axis& before);
  // The two ways between a client's fields and the settings.
  void takeLimitMotors();
  void showLimitMotors();
  void takeParameters(int index);
  /// As the client sees it.
  struct Limit {
    Scalar low, high;
  };
  Limit limitOf(int index) const;
  void setDefaults();
  btTransform frameOf(const btVector3& anchor, const btVector3& axis1,
                      const btVector3& axis2) const;

  Hinge m_hinges[2];  ///< of angle 2 (Bullet's axis 4) and angle 1 (5)
  Angles m_angles;
  btVector3 m_anchor, m_axis1, m_axis2;  ///< world, as given
  int m_flags = 0;
  Parameter m_held_motor_cfm;  ///< of the axes 0 to 3, which have no motor
  bool m_use_linear_reference_frame_a = true;
  struct LimitMotors {
    btRotationalLimitMotor fields[3], shown[3];  ///< as they are, and as they were shown
  };
  std::unique_ptr<LimitMotors> m_limit_motors;  ///< made when they are first asked for
  static constexpr RowCount row_count{6, 2};
};

extern template class ObservedJoint<UniversalJoint, PosedJoint>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
