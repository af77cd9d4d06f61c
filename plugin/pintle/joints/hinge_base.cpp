#include <pintle/joints/hinge_base.h>

#include <pintle/joints/drawing.h>
#include <pintle/joints/hinge_rows.h>

#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

btVector3 tangent(const btVector3& axis) {
  btVector3 x(0, 0, 0), y(0, 0, 0);
  btPlaneSpace1(axis, x, y);
  return x;
}

// The frame of b whose x is that of a, carried along by the shortest turn of axis a to axis b.
btMatrix3x3 follow(const btVector3& axis_a, const btVector3& axis_b, const btVector3& x_a) {
  // Near opposite axes the turn is rounding: what it makes of x_a is put right, or replaced.
  btVector3 x_b = quatRotate(shortestArcQuat(axis_a, axis_b), x_a);
  x_b -= axis_b * axis_b.dot(x_b);
  x_b = x_b.length() > btScalar(0.5) ? x_b.normalized() : tangent(axis_b);
  return columns(x_b, axis_b.cross(x_b), axis_b);
}

// Bullet's choice of the zero angle: by the world's axes of body a, taken as if they were its own.
btVector3 zeroDirection(const btRigidBody& a, const btVector3& axis) {
  const btMatrix3x3& R = a.getCenterOfMassTransform().getBasis();
  const btScalar projection = axis.dot(R.getColumn(0));
  if (projection >= 1 - SIMD_EPSILON) return -R.getColumn(2);
  if (projection <= -1 + SIMD_EPSILON) return R.getColumn(2);
  return axis.cross(R.getColumn(0)).cross(axis);
}

}  // namespace

HingeBase::HingeBase(btRigidBody& a, btRigidBody& b, RowCount max_rows, bool useReferenceFrameA)
    : FrameJoint(a, b, max_rows),
      m_sign(useReferenceFrameA ? Scalar(1) : Scalar(-1)),
      m_use_reference_frame_a(useReferenceFrameA) {}

HingeBase::HingeBase(btRigidBody& a, RowCount max_rows, bool useReferenceFrameA)
    : FrameJoint(a, max_rows),
      m_sign(useReferenceFrameA ? Scalar(1) : Scalar(-1)),
      m_use_reference_frame_a(useReferenceFrameA) {}

void HingeBase::begin(const btVector3& pivotInA, const btVector3& pivotInB,
                      const btVector3& axisInA, const btVector3& axisInB) {
  const btVector3 axis_a = direction("axisInA", axisInA), axis_b = direction("axisInB", axisInB);
  const btVector3 x = zeroDirection(m_rbA, axis_a).normalized();
  m_frame_a = btTransform(columns(x, axis_a.cross(x), axis_a), point("pivotInA", pivotInA));
  m_frame_b = btTransform(follow(axis_a, axis_b, x), point("pivotInB", pivotInB));
  remember(observe(BodyPair(m_rbA, m_rbB)), false);
}

void HingeBase::begin(const btVector3& pivotInA, const btVector3& axisInA) {
  const btVector3 axis_a = direction("axisInA", axisInA);
  const btVector3 axis_b = m_rbA.getCenterOfMassTransform().getBasis() * axis_a;
  const btVector3 x = tangent(axis_a);
  m_frame_a = btTransform(columns(x, axis_a.cross(x), axis_a), point("pivotInA", pivotInA));
  m_frame_b = btTransform(follow(axis_a, axis_b, x), m_rbA.getCenterOfMassTransform()(pivotInA));
  remember(observe(BodyPair(m_rbA, m_rbB)), false);
}

void HingeBase::begin(const btTransform& rbAFrame, const btTransform& rbBFrame) {
  m_frame_a = frame("rbAFrame", rbAFrame);
  m_frame_b = frame("rbBFrame", rbBFrame);
  remember(observe(BodyPair(m_rbA, m_rbB)), false);
}

void HingeBase::begin(const btTransform& rbAFrame) {
  m_frame_a = frame("rbAFrame", rbAFrame);
  m_frame_b =
      btTransform(rbAFrame.getBasis(), m_rbA.getCenterOfMassTransform()(rbAFrame.getOrigin()));
  remember(observe(BodyPair(m_rbA, m_rbB)), false);
}

void HingeBase::framesChanged() {
  // Another zero: the turns counted from the old one mean nothing.
  m_twist = {};
  m_turn_given = false;
  updateState(BodyPair(m_rbA, m_rbB));
}

void HingeBase::setAxis(const btVector3& axisInA) {
  const btVector3 axis_a = direction("axisInA", axisInA), x_a = tangent(axis_a);
  const btTransform &A = m_rbA.getCenterOfMassTransform(), &B = m_rbB.getCenterOfMassTransform();
  const btVector3 axis_b = A.getBasis() * axis_a;
  const btMatrix3x3 world = follow(axis_a, axis_b, x_a);
  setFrames(btTransform(columns(x_a, axis_a.cross(x_a), axis_a), m_frame_a.getOrigin()),
            btTransform(B.getBasis().transpose() * world, B.inverse()(A(m_frame_a.getOrigin()))));
}

// --- angle ---------------------------------------------------------------------------------------

void HingeBase::testLimit(const btTransform& transA, const btTransform& transB) {
  m_tested = followed(m_twist, observe({transA, transB}).twist);
}

btScalar HingeBase::getLimitSign() {
  const Scalar angle = m_sign * m_tested.value();
  return !m_axis.limited() ? 0 : angle < m_axis.low ? 1 : angle > m_axis.high ? -1 : 0;
}

btScalar HingeBase::getHingeAngle() {
  return getHingeAngle(m_rbA.getCenterOfMassTransform(), m_rbB.getCenterOfMassTransform());
}

btScalar HingeBase::getHingeAngle(const btTransform& transA, const btTransform& transB) {
  // By the y axis of b, as Bullet measures it also while the axes are apart.
  const btVector3 y_b = transB.getBasis() * m_frame_b.getBasis().getColumn(1);
  const btVector3 x_a = transA.getBasis() * m_frame_a.getBasis().getColumn(0);
  const btVector3 y_a = transA.getBasis() * m_frame_a.getBasis().getColumn(1);
  return -m_sign * btAtan2(y_b.dot(x_a), y_b.dot(y_a));
}

btScalar HingeBase::getAccumulatedHingeAngle() {
  updateState(BodyPair(m_rbA, m_rbB));
  const btScalar within = getHingeAngle();
  return within + SIMD_2_PI * std::round((angle() - within) / SIMD_2_PI);
}

void HingeBase::setAccumulatedHingeAngle(btScalar accAngle) {
  m_twist.set(m_sign * finite("accumulated angle", accAngle));
  m_turn_given = true;
}

// --- settings ------------------------------------------------------------------------------------

void HingeBase::setLimit(btScalar low, btScalar high, btScalar softness, btScalar biasFactor,
                         btScalar relaxationFactor) {
  finite("softness", softness);
  notNegative("bias factor", biasFactor);
  notNegative("relaxation factor", relaxationFactor);
  const Axis before = m_axis;
  setAngleLimit(m_axis, low, high);
  m_limit_softness = softness;
  m_axis.bias = biasFactor;
  m_axis.relaxation = relaxationFactor;
  limitSet(before);
}

void HingeBase::setAccumulatedLimit(btScalar low, btScalar high) {
  const Axis before = m_axis;
  setAxisLimit(m_axis, low, high);
  limitSet(before);
}

void HingeBase::limitSet(const Axis& before) {
  limitChanged();
  if (!m_turn_given) turnTowardsLimit(m_twist, m_sign, before, m_axis);
}

void HingeBase::setLimitSpring(btScalar frequency_hz, btScalar damping_ratio) {
  setAxisSpring(m_axis, frequency_hz, damping_ratio);
  limitChanged();
}

void HingeBase::enableAngularMotor(bool enableMotor, btScalar targetVelocity,
                                   btScalar maxMotorImpulse) {
  setAxisMotor(m_axis, enableMotor, targetVelocity, maxMotorImpulse);
}

void HingeBase::enableMotor(bool enableMotor) { m_axis.enable(enableMotor); }

void HingeBase::setMaxMotorImpulse(btScalar maxMotorImpulse) {
  m_axis.max_motor_impulse = bound("max motor impulse", maxMotorImpulse);
}

void HingeBase::setMotorTargetVelocity(btScalar motorTargetVelocity) {
  m_axis.motor_velocity = finite("motor target velocity", motorTargetVelocity);
  m_axis.choose(Axis::Drive::velocity);
}

void HingeBase::setMotorTarget(btScalar targetAngle, btScalar dt) {
  finite("motor target angle", targetAngle);
  positive("dt", dt);
  btScalar now;
  if (m_axis.limited()) {
    now = getAccumulatedHingeAngle();
    targetAngle = btMax(m_axis.low, btMin(targetAngle, m_axis.high));
  } else {
    now = getHingeAngle();
  }
  setMotorTargetVelocity((targetAngle - now) / dt);
}

void HingeBase::setMotorTarget(const btQuaternion& qAinB, btScalar dt) {
  for (int i = 0; i < 4; ++i) finite("qAinB", qAinB[i]);
  const btQuaternion q = m_frame_b.getRotation().inverse() * qAinB * m_frame_a.getRotation();
  btScalar target = 2 * btAtan2(q.z(), q.w());
  if (target > SIMD_PI) target -= SIMD_2_PI;
  if (target < -SIMD_PI) target += SIMD_2_PI;
  setMotorTarget(target, dt);
}

void HingeBase::setMotorServo(btScalar target_angle, btScalar frequency_hz, btScalar damping_ratio,
                              btScalar max_torque) {
  setAxisServo(m_axis, target_angle, frequency_hz, damping_ratio, max_torque);
}

void HingeBase::setFriction(btScalar max_torque) { setAxisFriction(m_axis, max_torque); }

void HingeBase::setParam(int num, btScalar value, int axis) {
  finite(parameterName(num), value);
  if (axis != -1 && axis != 5) return;
  if (num == BT_CONSTRAINT_CFM)
    m_motor_cfm = notNegative("CFM", value);
  else
    FrameJoint::setParam(num, value, axis);
}

btScalar HingeBase::getParam(int num, int axis) const {
  if (axis != -1 && axis != 5) return 0;
  return num == BT_CONSTRAINT_CFM ? m_motor_cfm.orElse(0) : FrameJoint::getParam(num, axis);
}

int HingeBase::getFlags() const {
  return (m_erp.isSet() ? BT_HINGE_FLAGS_ERP_NORM : 0) |
         (m_motor_cfm.isSet() ? BT_HINGE_FLAGS_CFM_NORM : 0) |
         (m_limit_erp.isSet() ? BT_HINGE_FLAGS_ERP_STOP : 0) |
         (m_limit_cfm.isSet() ? BT_HINGE_FLAGS_CFM_STOP : 0);
}

void HingeBase::getInfo2NonVirtual(btConstraintInfo2* info, const btTransform& transA,
                                   const btTransform& transB, const btVector3&, const btVector3&) {
  getInfo2At(info, transA, transB);
}

void HingeBase::getInfo2Internal(btConstraintInfo2* info, const btTransform& transA,
                                 const btTransform& transB, const btVector3&, const btVector3&) {
  getInfo2At(info, transA, transB);
}

void HingeBase::getInfo2InternalUsingFrameOffset(btConstraintInfo2* info, const btTransform& transA,
                                                 const btTransform& transB, const btVector3&,
                                                 const btVector3&) {
  getInfo2At(info, transA, transB);
}

void HingeBase::drawJoint(btIDebugDraw& drawer) const {
  FrameJoint::drawJoint(drawer);
  if (!drawsLimits(drawer) || m_axis.locked()) return;
  const btTransform tr = m_rbB.getCenterOfMassTransform() * m_frame_b;
  drawRange(drawer, tr.getOrigin(), tr.getBasis().getColumn(2), tr.getBasis().getColumn(0),
            m_dbgDrawSize, m_axis.low, m_axis.high);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
