// Purpose: the slider (document, 3.1.4 + 3.2.3, 3.2.4), in the place of btSliderConstraint.
#pragma once

#include <pintle/bullet/stock_motor.h>
#include <pintle/bullet/stock_slider.h>
#include <pintle/joints/joint_of.h>
#include <pintle/joints/observed_joint.h>
#include <pintle/joints/seen_poses.h>
#include <pintle/rows/unwrapped_angle.h>

#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

class Complaints;
struct Reach;

/// Settings of a slider.
struct SliderSettings {
  btTransform frame_a;        ///< the joint frame in body a's frame (m), x the slide axis
  btTransform frame_b;        ///< the same in body b's
  Axis linear;                ///< along x
  Axis angular;               ///< about x
  Scalar sign = 1;            ///< position = sign * (way of b's anchor from a's)
  bool angular_only = false;  ///< the angle's rows alone, nothing across or along the axis
};

/// A slider of Bullet's as Pintle holds it. What stands in Bullet's object is read at the start of each step; what Bullet does not
/// have (limits of more than a turn, springs, servos, friction) is kept here.
class SliderModel : public ObservedJoint<SliderModel, Joint> {
 public:
  enum { angular, linear, axes };                ///< the last one's impulse is known best
  static constexpr RowCount row_count{6, axes};  ///< the most that it has

  /// Reads this constraint of Bullet's, which it is a part of, or which it stands for.
  SliderModel(btSliderConstraint& slider, RowCount max_rows);

  const char* name() const override { return "SliderJoint"; }
  /// The rows are solved as a block: Bullet's setUseFrameOffset, which stands for the same.
  void setBlockRows(bool block) override;
  bool getBlockRows() const override;
  /// The frames, the stretch between the linear limits, and the range of the angle.
  void drawJoint(btIDebugDraw& drawer) const override;

 protected:
  static int rowsOfStock(btSliderConstraint& slider);
  void hideLimits();
  const ErpCfm* groups() const override { return m_erp_cfm; }

 private:
  friend ObservedJoint;
  friend class SliderJoint;
  enum { across, directions, locked_angle, group_count };  // Row::group

  struct Observation;
  Observation observe(const PosePair& poses) const;
  UnwrappedAngle angle(const Observation& seen) const;
  void remember(const Observation& seen, bool in_step);
  void constrain(const Observation& seen, Rows& rows) const;
  void addLockRows(const Observation& seen, Rows& rows) const;
  void addDocumentAngularRows(const Observation& seen, Rows& rows) const;
  bool slideLimitActs(Scalar position, const Reach& reach) const;
  /// No axis of its own: it is one of the equalities.
  bool angleIsLocked() const {
    return m_settings.angular.locked() && !m_settings.angular.hasLimitSpring();
  }
  unsigned char group(int i) const { return m_erp_cfm_differs ? static_cast<unsigned char>(i) : 0; }

  btSliderConstraint& slider() const;
  PosePair seenPair() const;
  void read(Complaints* complaints) override;
  void readFrames(Complaints* complaints);
  void readSettings(Complaints* complaints);
  void readLimits(Complaints* complaints);
  void readTuning(Complaints* complaints);
  /// Limits by Pintle's own methods, which Bullet's object shows as far as it can.
  void keepAngularLimits(Scalar low, Scalar high, bool of_any_turn);
  void limitSet(const Axis& before);
  /// Leaves in Bullet's object what a step of its own would.
  void show(const Observation& seen);
  void forgetLooks() {
    m_seen_poses.forget();
    m_looks[linear].given = m_looks[angular].given = false;
  }

  /// A test of a limit that a client asked for since the last step.
  struct Look {
    bool given = false;
    Scalar depth = 0;  ///< m or rad beyond the limit, above zero beyond the upper one
  };

  SliderSettings m_settings;
  UnwrappedAngle m_twist;  ///< of b against a, about x
  SeenPoses m_seen_poses;
  Look m_looks[axes];
  StockSliderBits m_read;  ///< as Bullet's object was read last
  AxisParameters m_linear_parameters, m_angular_parameters;
  ErpCfm m_erp_cfm[max_groups];
  StockMotor m_read_linear_motor = {false, 0, 0}, m_read_angular_motor = {false, 0, 0};
  Scalar m_read_low = 0, m_read_high = 0;  ///< rad: of Bullet's object, when it was read
  bool m_turn_given = false;
};

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
/// It is a btSliderConstraint: everything of that is Bullet's own, but for the rows, and but for what is below. A number that is
/// not finite is not used: the last good one stays (Joint::whyIgnored). What Bullet's softness, restitution and damping do:
/// - softness LimLin, LimAng (>= 0, default 1): scales the speed at which a step corrects a broken limit, or a
///   locked angle, and the rebound;
/// - softness OrthoLin, OrthoAng (>= 0, default 1): scales the ERP of the rows across the axis;
/// - damping LimLin, LimAng (default 1): |1 - damping| is the rebound from a limit, of the speed with which it is
///   met. (Bullet's linear rebound has the wrong sign, and lets go of the limit.);
/// - the others: nothing; kept to be read.
///
/// A STOP_ERP that is set and the softness of the same rows are one number, as in Bullet.
///
/// \image html slider_joint.svg
class SliderJoint : public JointOf<btSliderConstraint, SliderModel> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Joint frames in the bodies' frames, x the slide axis.
  SliderJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
              const btTransform& frameInB, bool useLinearReferenceFrameA = true)
      : JointOf(row_count, rbA, rbB, frameInA, frameInB, useLinearReferenceFrameA) {}
  /// To the world, where the body is now. As in Bullet the body is b, and a is Bullet's fixed body.
  SliderJoint(btRigidBody& rbB, const btTransform& frameInB, bool useLinearReferenceFrameA = true)
      : JointOf(row_count, rbB, frameInB, useLinearReferenceFrameA) {}

  // --- methods of Bullet's, for more turns, or as things are now ---------------------------------
  ///@{
  /// Bullet's slider hides those that are not const.
  using btTypedConstraint::getRigidBodyA;
  using btTypedConstraint::getRigidBodyB;
  ///@}

  ///@{
  /// lower <= accumulated angle <= upper (rad), over any number of turns. lower = upper (as at first,
  /// 0) locks, lower > upper frees, and so does (-pi, pi), as in Bullet; an infinite side is free. New limits of less than a turn hold,
  /// as in Bullet, in the turn that the joint is in: the accumulated angle changes by whole turns
  /// to lie inside them or as near as can be. Not if the turn was given by
  /// setAccumulatedAngularPos. What lies beyond half a turn is known to this class alone: Bullet's own getters and files have no
  /// limit then.
  void setLowerAngLimit(btScalar lowerLimit);
  void setUpperAngLimit(btScalar upperLimit);
  btScalar getLowerAngLimit() const;
  btScalar getUpperAngLimit() const;
  ///@}
  ///@{
  /// m/s, of the position; rad/s, of which the angle moves at minus that.
  void setTargetLinMotorVelocity(btScalar targetLinMotorVelocity);
  void setTargetAngMotorVelocity(btScalar targetAngMotorVelocity);
  ///@}

  /// What the joint says of itself (frames, position, angle) is from here on what holds at these poses
  /// of the bodies (world), until the next step or new frames: else it is what holds now.
  void calculateTransforms(const btTransform& transA, const btTransform& transB);
  /// Joint frames in the bodies' frames (m).
  void setFrames(const btTransform& frameA, const btTransform& frameB);
  ///@{
  /// The joint frames in the world.
  const btTransform& getCalculatedTransformA() const;
  const btTransform& getCalculatedTransformB() const;
  ///@}
  /// m, in body a: its anchor, moved to the middle between the linear limits; that of b is fixed.
  btVector3 getAncorInA() const;
  /// m, in body b.
  btVector3 getAncorInB() const { return m_frameInB.getOrigin(); }
  /// m.
  btScalar getLinearPos() const;
  /// rad. In [-pi, pi]; outside of limits of less than a turn, up to a turn
  /// more, on the side of the nearer one. With a limit beyond half a turn the accumulated angle.
  btScalar getAngularPos() const;
  ///@{
  /// Look at the bodies, or where calculateTransforms says that they are. (Bullet's object keeps what the last step saw of its limits: a
  /// subclass may count its rows by that.)
  void testLinLimits();
  void testAngLimits();
  ///@}
  ///@{
  /// As a test has seen it since the last step, else as that has. The depths (m, rad) are above zero beyond the upper limit.
  bool getSolveLinLimit();
  btScalar getLinDepth();
  bool getSolveAngLimit();
  btScalar getAngDepth();
  ///@}

  // --- beyond Bullet -----------------------------------------------------------------------------
  ///@{
  /// No rows across or along the axis: the bodies share a direction only.
  void setAngularOnly(bool angularOnly) { m_settings.angular_only = angularOnly; }
  bool getAngularOnly() const { return m_settings.angular_only; }
  ///@}
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
  /// otherwise. Takes the place of the velocity motor; Bullet's setPoweredLinMotor and setPoweredAngMotor turn it off and on.
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

 private:
  /// Frames that were set since the last step count.
  void refresh() const;
};

extern template class ObservedJoint<SliderModel, Joint>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
