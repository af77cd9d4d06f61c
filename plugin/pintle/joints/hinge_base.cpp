#include <pintle/joints/hinge_base.h>

#include <pintle/bullet/complaints.h>
#include <pintle/bullet/frames.h>
#include <pintle/bullet/stock_limits.h>
#include <pintle/joints/hinge_rows.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

bool HingeBase::getAngularOnly() const { return isAngularOnly(*this); }

btVector3 HingeBase::unit(const btVector3& axis) {
  const btScalar length = axis.length();
  return length > 0 && isFinite(length) ? axis / length : axis;
}

void HingeBase::clear() { clearSettings(*this); }

void HingeBase::straightenFrames() {
  btTransform a, b;
  if (!orthonormalize(getAFrame(), hinge_axis, measured_axis, a) ||
      !orthonormalize(getBFrame(), hinge_axis, measured_axis, b))
    return;
  getAFrame() = a;
  getBFrame() = b;
  model().readFromBullet();
}

void HingeBase::setAxis(const btVector3& axisInA) {
  btVector3 axis = unit(axisInA);
  btHingeConstraint::setAxis(axis);
}

// --- limit ---------------------------------------------------------------------------------------

void HingeBase::setLimit(btScalar low, btScalar high, btScalar softness, btScalar biasFactor,
                         btScalar relaxationFactor) {
  btHingeConstraint::setLimit(low, high, softness, biasFactor, relaxationFactor);
  if (leavesAPosition(low, high)) model().keepLimit(low, high, false);
}

void HingeBase::setAccumulatedLimit(btScalar low, btScalar high) {
  model().keepLimit(low, high, true);
}

bool HingeBase::hasLimit() const {
  return model().hasOwnLimit() ? model().m_settings.axis.low < model().m_settings.axis.high
                               : btHingeConstraint::hasLimit();
}

btScalar HingeBase::getLowerLimit() const {
  return model().hasOwnLimit() ? model().m_settings.axis.low : btHingeConstraint::getLowerLimit();
}

btScalar HingeBase::getUpperLimit() const {
  return model().hasOwnLimit() ? model().m_settings.axis.high : btHingeConstraint::getUpperLimit();
}

void HingeBase::testLimit(const btTransform& transA, const btTransform& transB) {
  HingeModel& m = model();
  m.readFromBullet();
  m.showLimitAt(followed(m.m_twist, m.observe({transA, transB}).twist));
}

// --- motor ---------------------------------------------------------------------------------------

void HingeBase::enableAngularMotor(bool enableMotor, btScalar targetVelocity,
                                   btScalar maxMotorImpulse) {
  btHingeConstraint::enableAngularMotor(enableMotor, targetVelocity, maxMotorImpulse);
  model().m_settings.axis.chosen = Axis::Drive::velocity;
}

void HingeBase::setMotorTargetVelocity(btScalar motorTargetVelocity) {
  btHingeConstraint::setMotorTargetVelocity(motorTargetVelocity);
  model().m_settings.axis.chosen = Axis::Drive::velocity;
}

btScalar HingeBase::getMotorTargetVelocity() const { return motorVelocity(*this); }

void HingeBase::setMotorTarget(btScalar targetAngle, btScalar dt) {
  model().readFromBullet();
  const Axis& axis = model().m_settings.axis;
  const btScalar now = axis.limited() ? getAccumulatedHingeAngle() : getHingeAngle();
  if (axis.limited() && isNumber(targetAngle))
    targetAngle = btMax(axis.low, btMin(targetAngle, axis.high));
  setMotorTargetVelocity((targetAngle - now) / dt);
}

void HingeBase::setMotorTarget(const btQuaternion& qAinB, btScalar dt) {
  model().readFromBullet();
  const HingeSettings& settings = model().m_settings;
  const btQuaternion q =
      settings.frame_b.getRotation().inverse() * qAinB * settings.frame_a.getRotation();
  btScalar target = 2 * btAtan2(q.z(), q.w());
  if (target > SIMD_PI) target -= SIMD_2_PI;
  if (target < -SIMD_PI) target += SIMD_2_PI;
  setMotorTarget(target, dt);
}

void HingeBase::setMotorServo(btScalar target_angle, btScalar frequency_hz, btScalar damping_ratio,
                              btScalar max_torque) {
  HingeModel& m = model();
  m.setAxisServo(m.m_settings.axis, target_angle, frequency_hz, damping_ratio, max_torque);
  // Other numbers there are another motor: of those that are there the velocity motor is, if it comes again.
  btHingeConstraint::enableMotor(true);
  m.m_read_motor = {true, getMotorTargetVelocity(), getMaxMotorImpulse()};
  takeFinite(m.m_settings.axis.motor_velocity, m.m_read_motor.velocity, "", nullptr);
  takeBound(m.m_settings.axis.max_motor_impulse, m.m_read_motor.bound, "", nullptr);
}

void HingeBase::setFriction(btScalar max_torque) {
  model().setAxisFriction(model().m_settings.axis, max_torque);
}

void HingeBase::setLimitSpring(btScalar frequency_hz, btScalar damping_ratio) {
  model().setAxisSpring(model().m_settings.axis, frequency_hz, damping_ratio);
  model().limitChanged();
}

btScalar HingeBase::getMotorImpulse() const { return model().axisImpulse(0, Axis::motor); }
btScalar HingeBase::getLimitImpulse() const { return model().axisImpulse(0, Axis::limit); }
btScalar HingeBase::getFrictionImpulse() const { return model().axisImpulse(0, Axis::friction); }

// --- angle ---------------------------------------------------------------------------------------

btScalar HingeBase::getAccumulatedHingeAngle() {
  HingeModel& m = model();
  m.readFromBullet();
  m.updateState(BodyPair(m_rbA, m_rbB));
  const btScalar within = getHingeAngle();
  m_accumulatedAngle = within + SIMD_2_PI * std::round((m.angle() - within) / SIMD_2_PI);
  return m_accumulatedAngle;
}

void HingeBase::setAccumulatedHingeAngle(btScalar accAngle) {
  btHingeAccumulatedAngleConstraint::setAccumulatedHingeAngle(accAngle);
  if (!isFinite(accAngle)) return;
  HingeModel& m = model();
  m.readFromBullet();
  m.m_twist.set(m.m_sign * accAngle);
  m.m_turn_given = true;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
