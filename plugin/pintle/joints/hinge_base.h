// Purpose: the base of all hinges: btHingeAccumulatedAngleConstraint, with what Pintle adds to it.
#pragma once

#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>

#include <pintle/precision.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

class HingeModel;

/// One rotation about an axis common to two bodies. The axis is z of a joint frame in each body. Everything of Bullet's hinge is
/// Bullet's own, by pointers to Bullet's classes too; the rows are Pintle's.
///
/// The hinge angle (rad) is Bullet's: with `useReferenceFrameA` false it is the rotation of a
/// against b, with true that of b against a. It is zero when the joint frames coincide. Limits and
/// accumulated angles may span any number of turns.
///
/// Bullet's methods take what they take there. A number that is not finite is not used: the last good one stays
/// (Joint::whyIgnored). Bullet's getFrameOffset and setUseFrameOffset stand for setBlockRows.
class HingeBase : public btHingeAccumulatedAngleConstraint {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();
  using btHingeAccumulatedAngleConstraint::btHingeAccumulatedAngleConstraint;

  // --- methods of Bullet's, for more turns, or const ---------------------------------------------
  using btHingeConstraint::getFrameOffsetA;
  using btHingeConstraint::getFrameOffsetB;
  /// The joint frame in body a's frame.
  const btTransform& getFrameOffsetA() const { return getAFrame(); }
  /// The joint frame in body b's frame.
  const btTransform& getFrameOffsetB() const { return getBFrame(); }
  ///@{
  /// The joint frames in the world, at the bodies' poses of now.
  btTransform getCalculatedTransformA() const {
    return m_rbA.getCenterOfMassTransform() * getAFrame();
  }
  btTransform getCalculatedTransformB() const {
    return m_rbB.getCenterOfMassTransform() * getBFrame();
  }
  ///@}
  /// What setAngularOnly set.
  bool getAngularOnly() const;

  /// A new axis in body a; the frame of b follows as Bullet sets it.
  void setAxis(const btVector3& axisInA);

  /// low <= accumulated angle <= high (rad), over any number of turns. low = high locks, low > high
  /// frees, and so does (-pi, pi), as in Bullet; an infinite side is free. The bias factor scales the speed of the correction, bias
  /// times relaxation is the rebound (0: none). As in Bullet the softness has no effect. A new
  /// limit of less than a turn holds, as in Bullet, in the turn that the joint is in: the
  /// accumulated angle changes by whole turns to lie inside it or as near as can be. Not if the
  /// turn was given by setAccumulatedHingeAngle. One of a turn or more is known to this class alone: Bullet's own
  /// getters and files have none then.
  void setLimit(btScalar low, btScalar high, btScalar softness = 0.9f, btScalar biasFactor = 0.3f,
                btScalar relaxationFactor = 1.0f);
  /// The same limits and no others: also at -pi and pi. Throws std::invalid_argument if one is not a number.
  void setAccumulatedLimit(btScalar low, btScalar high);
  /// As in Bullet false also for low = high.
  bool hasLimit() const;
  /// rad, as setLimit set it.
  btScalar getLowerLimit() const;
  /// rad, as setLimit set it.
  btScalar getUpperLimit() const;
  /// Whether the angle at these poses would break the limit; changes only the answers of getSolveLimit and
  /// getLimitSign (+1 low, -1 high), which are else those of the last step.
  void testLimit(const btTransform& transA, const btTransform& transB);

  /// Velocity motor: target velocity (rad/s) along the hinge angle, and the most that it may apply
  /// in a step (N m s).
  void enableAngularMotor(bool enableMotor, btScalar targetVelocity, btScalar maxMotorImpulse);
  /// rad/s, along the hinge angle.
  void setMotorTargetVelocity(btScalar motorTargetVelocity);
  /// rad/s. (Bullet 2.85 spells it otherwise.)
  btScalar getMotorTargetVelocity() const;
  /// The velocity that reaches the target (rad) in dt (s, > 0); to be called in each step. With a
  /// limit the angle is the accumulated one, clamped to the limit; without, that within the turn.
  void setMotorTarget(btScalar targetAngle, btScalar dt);
  /// The same; qAinB is the rotation of body a against body b.
  void setMotorTarget(const btQuaternion& qAinB, btScalar dt);

  /// rad, with all turns since the joint was made: exact while no more than half a turn passes
  /// between two steps or calls.
  btScalar getAccumulatedHingeAngle();
  /// Says which turn the joint is in, for instance after a teleport: the angle becomes the one that
  /// fits the pose and is nearest to `accAngle`. (By a pointer to Bullet's class it does nothing.)
  void setAccumulatedHingeAngle(btScalar accAngle);

  // --- beyond Bullet -----------------------------------------------------------------------------
  /// Makes the limit a spring and damper (document, 2.4): frequency (Hz) and damping ratio (>= 0; 1
  /// is critical) of the hinge as its bodies alone make it swing. Frequency 0: a hard limit again.
  void setLimitSpring(btScalar frequency_hz, btScalar damping_ratio);
  /// Holds an accumulated angle (rad) by a spring (frequency > 0 in Hz, damping ratio >= 0) of at
  /// most max_torque (N m, >= 0 or infinite), until told otherwise. Takes the place of the velocity
  /// motor; Bullet's enableMotor turns it off and on.
  void setMotorServo(btScalar target_angle, btScalar frequency_hz, btScalar damping_ratio,
                     btScalar max_torque);
  /// Dry friction of at most max_torque (N m, >= 0 or infinite). 0: none.
  void setFriction(btScalar max_torque);
  ///@{
  /// Impulses of the last step (N m s), positive towards larger hinge angles.
  btScalar getMotorImpulse() const;
  btScalar getLimitImpulse() const;
  btScalar getFrictionImpulse() const;
  ///@}

 protected:
  /// The axis made unit, if it has a direction.
  static btVector3 unit(const btVector3& axis);
  /// Sets to 0 what Bullet leaves as the memory was.
  void clear();
  /// Bullet makes a frame of an axis whose x and y need not be unit vectors.
  void straightenFrames();

 private:
  virtual HingeModel& model() = 0;
  const HingeModel& model() const { return const_cast<HingeBase*>(this)->model(); }
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
