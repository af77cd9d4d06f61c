// Purpose: the slider (document, 3.1.4 + 3.2.3, 3.2.4), in the place of btSliderConstraint.
#pragma once

#include <pintle/joints/observed_joint.h>
#include <pintle/joints/posed_joint.h>
#include <pintle/rows/unwrapped_angle.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct Reach;

/// Body b slides along an axis of body a, and turns about it as far as its angular limits allow: by
/// default not at all. The axis is x of a joint frame in each body.
///
/// The position (m) is Bullet's: with `useLinearReferenceFrameA` how far the anchor of b is along
/// the axis from that of a, without it the other way round. The angle (rad) is the rotation of b
/// against a in either case; its limits may span any number of turns. As in Bullet the angular
/// motor turns the other way: a positive target velocity makes the angle fall.
///
/// The document's formulation of the rows across the axis is that of 3.1.4 if the angle is locked,
/// which it takes for granted, and the conditioned one if not.
///
/// Everything that btSliderConstraint has, under the same name, with the same signs and defaults.
///
/// \image html slider_joint.svg
class SliderJoint : public ObservedJoint<SliderJoint, PosedJoint> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  // --- btSliderConstraint ------------------------------------------------------------------------
  /// Joint frames in the bodies' frames, x the slide axis.
  SliderJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
              const btTransform& frameInB, bool useLinearReferenceFrameA = true);
  /// To the world, where the body is now. As in Bullet the body is b, and a is Bullet's fixed body.
  SliderJoint(btRigidBody& rbB, const btTransform& frameInB, bool useLinearReferenceFrameA = true);

  /// What the constructor was given.
  bool getUseLinearReferenceFrameA() const { return m_sign > 0; }
  /// m, in body a: its anchor, moved to the middle between the linear limits; that of b is fixed.
  btVector3 getAncorInA() const;
  /// m, in body b.
  btVector3 getAncorInB() const { return m_frame_b.getOrigin(); }

  /// lower <= position <= upper (m). lower = upper locks, lower > upper (as at first) frees, an
  /// infinite side is free.
  void setLowerLinLimit(btScalar lowerLimit);
  /// m; the other side of setLowerLinLimit.
  void setUpperLinLimit(btScalar upperLimit);
  /// m.
  btScalar getLowerLinLimit() const { return m_linear.low; }
  /// m.
  btScalar getUpperLinLimit() const { return m_linear.high; }
  /// lower <= accumulated angle <= upper (rad), over any number of turns. lower = upper (as at first,
  /// 0) locks, lower > upper frees, and so does (-pi, pi), as in Bullet; an infinite side is free. New limits of less than a turn hold,
  /// as in Bullet, in the turn that the joint is in: the accumulated angle changes by whole turns
  /// to lie inside them or as near as can be. Not if the turn was given by
  /// setAccumulatedAngularPos.
  void setLowerAngLimit(btScalar lowerLimit);
  /// rad; the other side of setLowerAngLimit.
  void setUpperAngLimit(btScalar upperLimit);
  /// rad.
  btScalar getLowerAngLimit() const { return m_angular.low; }
  /// rad.
  btScalar getUpperAngLimit() const { return m_angular.high; }

  ///@{
  /// As in Bullet, what they do:
  /// - softness LimLin, LimAng (>= 0, default 1): scales the speed at which a step corrects a broken limit, or a
  ///   locked angle, and the rebound;
  /// - softness OrthoLin, OrthoAng (>= 0, default 1): scales the ERP of the rows across the axis;
  /// - damping LimLin, LimAng (default 1): |1 - damping| is the rebound from a limit, of the speed with which it is
  ///   met. (Bullet's linear rebound has the wrong sign, and lets go of the limit.);
  /// - the others: nothing; kept to be read.
  ///
  /// A STOP_ERP that is set and the softness of the same rows are one number, as in Bullet.
  btScalar getSoftnessDirLin() const { return m_dir_lin.softness; }
  btScalar getRestitutionDirLin() const { return m_dir_lin.restitution; }
  btScalar getDampingDirLin() const { return m_dir_lin.damping; }
  btScalar getSoftnessDirAng() const { return m_dir_ang.softness; }
  btScalar getRestitutionDirAng() const { return m_dir_ang.restitution; }
  btScalar getDampingDirAng() const { return m_dir_ang.damping; }
  btScalar getSoftnessLimLin() const { return m_lim_lin.softness; }
  btScalar getRestitutionLimLin() const { return m_lim_lin.restitution; }
  btScalar getDampingLimLin() const { return m_lim_lin.damping; }
  btScalar getSoftnessLimAng() const { return m_lim_ang.softness; }
  btScalar getRestitutionLimAng() const { return m_lim_ang.restitution; }
  btScalar getDampingLimAng() const { return m_lim_ang.damping; }
  btScalar getSoftnessOrthoLin() const { return m_ortho_lin.softness; }
  btScalar getRestitutionOrthoLin() const { return m_ortho_lin.restitution; }
  btScalar getDampingOrthoLin() const { return m_ortho_lin.damping; }
  btScalar getSoftnessOrthoAng() const { return m_ortho_ang.softness; }
  btScalar getRestitutionOrthoAng() const { return m_ortho_ang.restitution; }
  btScalar getDampingOrthoAng() const { return m_ortho_ang.damping; }
  void setSoftnessDirLin(btScalar softness) { setSoftness(m_dir_lin, softness); }
  void setRestitutionDirLin(btScalar restitution) { setRestitution(m_dir_lin, restitution); }
  void setDampingDirLin(btScalar damping) { setDamping(m_dir_lin, damping); }
  void setSoftnessDirAng(btScalar softness) { setSoftness(m_dir_ang, softness); }
  void setRestitutionDirAng(btScalar restitution) { setRestitution(m_dir_ang, restitution); }
  void setDampingDirAng(btScalar damping) { setDamping(m_dir_ang, damping); }
  void setSoftnessLimLin(btScalar softness) { setSoftness(m_lim_lin, softness); }
  void setRestitutionLimLin(btScalar restitution) { setRestitution(m_lim_lin, restitution); }
  void setDampingLimLin(btScalar damping) { setDamping(m_lim_lin, damping); }
  void setSoftnessLimAng(btScalar softness) { setSoftness(m_lim_ang, softness); }
  void setRestitutionLimAng(btScalar restitution) { setRestitution(m_lim_ang, restitution); }
  void setDampingLimAng(btScalar damping) { setDamping(m_lim_ang, damping); }
  void setSoftnessOrthoLin(btScalar softness) { setSoftness(m_ortho_lin, softness); }
  void setRestitutionOrthoLin(btScalar restitution) { setRestitution(m_ortho_lin, restitution); }
  void setDampingOrthoLin(btScalar damping) { setDamping(m_ortho_lin, damping); }
  void setSoftnessOrthoAng(btScalar softness) { setSoftness(m_ortho_ang, softness); }
  void setRestitutionOrthoAng(btScalar restitution) { setRestitution(m_ortho_ang, restitution); }
  void setDampingOrthoAng(btScalar damping) { setDamping(m_ortho_ang, damping); }
  ///@}

  /// Velocity motor along the axis: target velocity (m/s) of the position, and the most force (N,
  /// >= 0). setPoweredLinMotor turns the motor, velocity motor or servo as it was set last, on or
  /// off.
  void setPoweredLinMotor(bool onOff);
  /// m/s, of the position.
  void setTargetLinMotorVelocity(btScalar targetLinMotorVelocity);
  /// N, >= 0.
  void setMaxLinMotorForce(btScalar maxLinMotorForce);
  /// Whether a motor or servo along the axis is on.
  bool getPoweredLinMotor() const { return m_linear.drive != Axis::Drive::off; }
  /// m/s.
  btScalar getTargetLinMotorVelocity() const { return m_linear.motor_velocity; }
  /// N.
  btScalar getMaxLinMotorForce() const { return m_linear.max_motor_force; }
  /// The same about the axis: the angle moves at minus the target velocity (rad/s); the most torque
  /// (N m, >= 0). A locked angle does not move.
  void setPoweredAngMotor(bool onOff);
  /// rad/s; the angle moves at minus this.
  void setTargetAngMotorVelocity(btScalar targetAngMotorVelocity);
  /// N m, >= 0.
  void setMaxAngMotorForce(btScalar maxAngMotorForce);
  /// Whether a motor or servo about the axis is on.
  bool getPoweredAngMotor() const { return m_angular.drive != Axis::Drive::off; }
  /// rad/s.
  btScalar getTargetAngMotorVelocity() const { return 0 - m_angular.motor_velocity; }
  /// N m.
  btScalar getMaxAngMotorForce() const { return m_angular.max_motor_force; }

  /// m, where the bodies are now.
  btScalar getLinearPos() const;
  /// rad, where the bodies are now. In [-pi, pi]; outside of limits of less than a turn, up to a turn
  /// more, on the side of the nearer one. With a limit beyond half a turn the accumulated angle.
  btScalar getAngularPos() const;

  ///@{
  /// Look at the bodies, or where calculateTransforms says that they are; the next four say what was
  /// seen then, or in the last step.
  void testLinLimits();
  void testAngLimits();
  ///@}

  ///@{
  /// Whether the limit was broken, and by how much (m, rad), above zero beyond the upper one.
  bool getSolveLinLimit() const { return getLinDepth() != 0; }
  btScalar getLinDepth() const { return depth(m_linear, m_seen_position); }
  bool getSolveAngLimit() const { return getAngDepth() != 0; }
  btScalar getAngDepth() const { return depth(m_angular, m_seen.value()); }
  ///@}

  ///@{
  /// Bullet's way to rows that converge; here it is setBlockRows.
  bool getUseFrameOffset() const { return getBlockRows(); }
  void setUseFrameOffset(bool frameOffsetOnOff) { setBlockRows(frameOffsetOnOff); }
  ///@}

  /// By axis, all >= 0:
  ///   STOP_ERP, STOP_CFM   0 (or -1): linear limit; 1, 2: rows across the axis; 3: angular limit and
  ///                        locked angle; 4, 5: the axes' directions
  ///   CFM                  0 (or -1): linear motor; 3: angular motor
  /// As in Bullet an axis below 0 is 0, and other parameters (ERP) and axes are ignored, and read as
  /// SIMD_INFINITY. NaN and infinity are refused for all.
  void setParam(int num, btScalar value, int axis = -1) override;
  /// What setParam set.
  btScalar getParam(int num, int axis = -1) const override;
  /// BT_SLIDER_FLAGS_* of the parameters that were set.
  virtual int getFlags() const { return m_flags; }
  /// The rows at other poses of the bodies; no more than getInfo1 announced. Velocities and masses are
  /// the bodies' own, whatever is given.
  void getInfo2NonVirtual(btConstraintInfo2* info, const btTransform& transA,
                          const btTransform& transB, const btVector3& linVelA,
                          const btVector3& linVelB, btScalar rbAinvMass, btScalar rbBinvMass);

  // --- beyond Bullet -----------------------------------------------------------------------------
  /// rad, with all turns since the joint was made: exact while no more than half a turn passes
  /// between two steps or calls.
  btScalar getAccumulatedAngularPos();
  /// Says which turn the joint is in, for instance after a teleport: the angle becomes the one that
  /// fits the pose and is nearest to `angle`.
  void setAccumulatedAngularPos(btScalar angle);
  /// Both limits of the accumulated angle (rad), as setLowerAngLimit and setUpperAngLimit set them: also -pi and pi, which
  /// set by these are no limit, as in Bullet.
  void setAccumulatedAngLimits(btScalar low, btScalar high);

  ///@{
  /// Makes a limit a spring and damper (document, 2.4): frequency (Hz) and damping ratio (>= 0; 1 is
  /// critical) of the coordinate as its bodies alone make it swing. Frequency 0: hard again.
  void setLinLimitSpring(btScalar frequency_hz, btScalar damping_ratio);
  void setAngLimitSpring(btScalar frequency_hz, btScalar damping_ratio);
  ///@}

  ///@{
  /// Holds a position (m) or an accumulated angle (rad) by a spring (frequency > 0 in Hz, damping
  /// ratio >= 0) of at most max_force (N) or max_torque (N m, both >= 0 or infinite), until told
  /// otherwise. Takes the place of the velocity motor.
  void setLinMotorServo(btScalar target, btScalar frequency_hz, btScalar damping_ratio,
                        btScalar max_force);
  void setAngMotorServo(btScalar target_angle, btScalar frequency_hz, btScalar damping_ratio,
                        btScalar max_torque);
  ///@}

  ///@{
  /// Dry friction of at most this force (N) or torque (N m), >= 0 or infinite. 0: none.
  void setLinFriction(btScalar max_force);
  void setAngFriction(btScalar max_torque);
  ///@}

  ///@{
  /// Impulses of the last step (N s), positive towards larger positions.
  btScalar getLinMotorImpulse() const { return axisImpulse(linear, Axis::motor); }
  btScalar getLinLimitImpulse() const { return axisImpulse(linear, Axis::limit); }
  btScalar getLinFrictionImpulse() const { return axisImpulse(linear, Axis::friction); }
  ///@}

  ///@{
  /// Impulses of the last step (N m s), positive towards larger angles (so a positive target velocity
  /// gives a negative one). A locked angle without a spring is held with the axes' directions, and
  /// has none of its own.
  btScalar getAngMotorImpulse() const { return axisImpulse(angular, Axis::motor); }
  btScalar getAngLimitImpulse() const { return axisImpulse(angular, Axis::limit); }
  btScalar getAngFrictionImpulse() const { return axisImpulse(angular, Axis::friction); }
  ///@}

  /// The frames, the stretch between the linear limits, and the range of the angle.
  void drawJoint(btIDebugDraw& drawer) const override;
  const char* name() const override { return "SliderJoint"; }

 protected:
  void framesChanged() override;
  const ErpCfm* groups() const override { return m_erp_cfm; }

 private:
  friend ObservedJoint;
  enum { angular, linear, axes };                          // the last one's impulse is known best
  enum { across, directions, locked_angle, group_count };  // Row::group

  /// What Bullet keeps for each of six cases.
  struct BulletTuning {
    Scalar softness = 1, restitution = Scalar(0.7), damping = 1, cfm = 0;
  };

  struct Observation;
  Observation observe(const PosePair& poses) const;
  UnwrappedAngle angle(const Observation& seen) const;
  void remember(const Observation& seen, bool in_step);
  /// Angular only: the angle's rows alone, nothing across or along the axis.
  void constrain(const Observation& seen, Rows& rows) const;
  void addLockRows(const Observation& seen, Rows& rows) const;
  void addDocumentAngularRows(const Observation& seen, Rows& rows) const;
  bool slideLimitActs(Scalar position, const Reach& reach) const;

  /// No axis of its own: it is one of the equalities.
  bool angleIsLocked() const { return m_angular.locked() && !(m_angular.hasLimitSpring()); }
  static Scalar depth(const Axis& axis, Scalar position) {
    if (!axis.limited()) return 0;
    return position > axis.high  ? position - axis.high
           : position < axis.low ? position - axis.low
                                 : Scalar(0);
  }
  unsigned char group(int i) const { return m_erp_cfm_differs ? static_cast<unsigned char>(i) : 0; }
  void setAngularLimits(Scalar low, Scalar high);
  void setSoftness(BulletTuning& tuning, Scalar softness);
  void setRestitution(BulletTuning& tuning, Scalar restitution);
  void setDamping(BulletTuning& tuning, Scalar damping);
  void tuningChanged();
  struct Slot;
  static Slot slot(int num, int axis);

  Axis m_linear, m_angular;
  AxisParameters m_linear_parameters, m_angular_parameters;
  UnwrappedAngle m_twist;  ///< of b against a, about x
  UnwrappedAngle m_seen;   ///< the last ones held against the limits
  Scalar m_seen_position = 0;
  Scalar m_sign;  ///< position = sign * (way of b's anchor from a's)
  BulletTuning m_dir_lin, m_dir_ang, m_lim_lin, m_lim_ang, m_ortho_lin, m_ortho_ang;
  ErpCfm m_erp_cfm[group_count];
  int m_flags = 0;
  bool m_turn_given = false;
  static constexpr RowCount row_count{6, axes};
};

extern template class ObservedJoint<SliderJoint, PosedJoint>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
