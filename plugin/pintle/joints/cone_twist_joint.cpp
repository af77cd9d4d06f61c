#include <pintle/joints/cone_twist_joint.h>

#include <pintle/body_pair.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

ConeTwistJoint::ConeTwistJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& rbAFrame,
                               const btTransform& rbBFrame)
    : JointOf(row_count, rbA, rbB, rbAFrame, rbBFrame) {
  clearSettings(*this);
  showAngles(*this, readings().twist, false, false);
}

ConeTwistJoint::ConeTwistJoint(btRigidBody& rbA, const btTransform& rbAFrame)
    : JointOf(row_count, rbA, rbAFrame) {
  clearSettings(*this);
  showAngles(*this, readings().twist, false, false);
}

btTransform& ConeTwistJoint::getFrameOffsetA() { return frameA(*this); }
btTransform& ConeTwistJoint::getFrameOffsetB() { return frameB(*this); }

void ConeTwistJoint::setFrames(const btTransform& frameA, const btTransform& frameB) {
  m_seen = false;
  btConeTwistConstraint::setFrames(frameA, frameB);
}

void ConeTwistJoint::setLimit(btScalar swingSpan1, btScalar swingSpan2, btScalar twistSpan,
                              btScalar softness, btScalar biasFactor, btScalar relaxationFactor) {
  btConeTwistConstraint::setLimit(swingSpan1, swingSpan2, twistSpan, softness, biasFactor,
                                  relaxationFactor);
  spansWritten(3, 5);
}

void ConeTwistJoint::setLimit(int limitIndex, btScalar limitValue) {
  btConeTwistConstraint::setLimit(limitIndex, limitValue);
  if (limitIndex >= 3 && limitIndex <= 5) spansWritten(limitIndex, limitIndex);
}

void ConeTwistJoint::setSwingLimits(btScalar min_1, btScalar max_1, btScalar min_2,
                                    btScalar max_2) {
  const auto side = [this](const char* field, Scalar value, Scalar outwards) {
    if (outwards * number(field, value) < 0) reject(field, value, "must be min <= 0 <= max");
    return value;
  };
  const Scalar low_1 = side("swing 1 min", min_1, -1), high_1 = side("swing 1 max", max_1, 1);
  const Scalar low_2 = side("swing 2 min", min_2, -1), high_2 = side("swing 2 max", max_2, 1);
  keepSwings({low_1, high_1}, {low_2, high_2});
}

void ConeTwistJoint::setTwistLimit(btScalar low, btScalar high) {
  const auto check = [this](const char* field, Scalar value) {
    if (btFabs(number(field, value)) > Scalar(2 * pi) * (1 + SIMD_EPSILON))
      reject(field, value, "must be within 2 pi of 0");
  };
  check("twist low", low);
  check("twist high", high);
  keepTwist({low, high});
}

void ConeTwistJoint::setSwingLimitSpring(btScalar frequency_hz, btScalar damping_ratio) {
  setAxisSpring(m_settings.swing_limit, frequency_hz, damping_ratio);
}

void ConeTwistJoint::setTwistLimitSpring(btScalar frequency_hz, btScalar damping_ratio) {
  setAxisSpring(m_settings.twist_limit, frequency_hz, damping_ratio);
}

// --- motor and friction --------------------------------------------------------------------------

void ConeTwistJoint::enableMotor(bool b) {
  btConeTwistConstraint::enableMotor(b);
  readFromBullet();
}

void ConeTwistJoint::setMotorTarget(const btQuaternion& q) {
  setMotorTargetInConstraintSpace(getBFrame().getRotation().inverse() * q *
                                  getAFrame().getRotation());
}

void ConeTwistJoint::setMotorTargetInConstraintSpace(const btQuaternion& q) { setTarget(q); }

void ConeTwistJoint::setMotorVelocity(const btVector3& velocity) {
  setVelocity(point("motor velocity", velocity));
}

void ConeTwistJoint::setFriction(btScalar max_torque) {
  Axis friction;
  setAxisFriction(friction, max_torque);
  if (friction.max_friction > 0 || m_rotation) rotation().axis.max_friction = friction.max_friction;
}

// --- readings ------------------------------------------------------------------------------------

void ConeTwistJoint::readNow() const { const_cast<ConeTwistJoint*>(this)->readFromBullet(); }

// (Bullet's object keeps what the last step saw of its limits: a subclass may count its rows by that.)
ConeTwistReadings ConeTwistJoint::readings() const {
  readNow();
  return m_seen ? m_readings : look(BodyPair(m_rbA, m_rbB));
}

void ConeTwistJoint::calcAngleInfo() { m_seen = false; }

void ConeTwistJoint::calcAngleInfo2(const btTransform& transA, const btTransform& transB,
                                    const btMatrix3x3&, const btMatrix3x3&) {
  readNow();
  m_readings = look(PosePair(transA, transB));
  m_seen = true;
}

btScalar ConeTwistJoint::getTwistAngle() const { return readings().twist; }
int ConeTwistJoint::getSolveTwistLimit() { return readings().past_twist; }
bool ConeTwistJoint::isPastSwingLimit() { return readings().past_swing; }

btScalar ConeTwistJoint::getSwing1() const {
  readNow();
  return swingNow(2);
}

btScalar ConeTwistJoint::getSwing2() const {
  readNow();
  return swingNow(1);
}

btScalar ConeTwistJoint::getTwist() const {
  readNow();
  return twistNow();
}

btVector3 ConeTwistJoint::GetPointForAngle(btScalar angleInRadians, btScalar length) const {
  readNow();
  return pointForAngle(angleInRadians, length);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
