#include <pintle/joints/quaternion_hinge.h>

#include <pintle/body_pair.h>
#include <pintle/equations/quaternion_hinge.h>
#include <pintle/equations/quaternion_hinge_limit.h>
#include <pintle/frame.h>
#include <pintle/joints/drawing.h>
#include <pintle/joints/turning.h>
#include <pintle/rows/limit_reach.h>
#include <pintle/rows/position_rows.h>

#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

btMatrix3x3 columns(const btVector3& x, const btVector3& y, const btVector3& z) {
  return {x.x(), y.x(), z.x(), x.y(), y.y(), z.y(), x.z(), y.z(), z.z()};
}

btVector3 tangent(const btVector3& axis) {
  btVector3 x, y;
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

// The joint frames in the world.
struct QuaternionHinge::Frames {
  Frame a, b;
  Vec3 c_a = a.c(), c_b = b.c();
};

inline QuaternionHinge::Frames QuaternionHinge::frames(const btTransform& pose_a,
                                                       const btTransform& pose_b) const {
  return {{pose_a, m_frame_a}, {pose_b, m_frame_b}};
}

QuaternionHinge::QuaternionHinge(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
                                 const btVector3& pivotInB, const btVector3& axisInA,
                                 const btVector3& axisInB, bool useReferenceFrameA)
    : FrameJoint(rbA, rbB, m_row_memory),
      m_sign(useReferenceFrameA ? Scalar(1) : Scalar(-1)),
      m_use_reference_frame_a(useReferenceFrameA) {
  const btVector3 axis_a = direction("axisInA", axisInA), axis_b = direction("axisInB", axisInB);
  const btVector3 x = zeroDirection(rbA, axis_a).normalized();
  m_frame_a = btTransform(columns(x, axis_a.cross(x), axis_a), point("pivotInA", pivotInA));
  m_frame_b = btTransform(follow(axis_a, axis_b, x), point("pivotInB", pivotInB));
  updateState({rbA, rbB});
}

QuaternionHinge::QuaternionHinge(btRigidBody& rbA, const btVector3& pivotInA,
                                 const btVector3& axisInA, bool useReferenceFrameA)
    : FrameJoint(rbA, m_row_memory),
      m_sign(useReferenceFrameA ? Scalar(1) : Scalar(-1)),
      m_use_reference_frame_a(useReferenceFrameA) {
  const btVector3 axis_a = direction("axisInA", axisInA);
  const btVector3 axis_b = rbA.getCenterOfMassTransform().getBasis() * axis_a;
  const btVector3 x = tangent(axis_a);
  m_frame_a = btTransform(columns(x, axis_a.cross(x), axis_a), point("pivotInA", pivotInA));
  m_frame_b = btTransform(follow(axis_a, axis_b, x), rbA.getCenterOfMassTransform()(pivotInA));
  updateState({rbA, m_rbB});
}

QuaternionHinge::QuaternionHinge(btRigidBody& rbA, btRigidBody& rbB, const btTransform& rbAFrame,
                                 const btTransform& rbBFrame, bool useReferenceFrameA)
    : FrameJoint(rbA, rbB, m_row_memory),
      m_sign(useReferenceFrameA ? Scalar(1) : Scalar(-1)),
      m_use_reference_frame_a(useReferenceFrameA) {
  m_frame_a = frame("rbAFrame", rbAFrame);
  m_frame_b = frame("rbBFrame", rbBFrame);
  updateState({rbA, rbB});
}

QuaternionHinge::QuaternionHinge(btRigidBody& rbA, const btTransform& rbAFrame,
                                 bool useReferenceFrameA)
    : FrameJoint(rbA, m_row_memory),
      m_sign(useReferenceFrameA ? Scalar(1) : Scalar(-1)),
      m_use_reference_frame_a(useReferenceFrameA) {
  m_frame_a = frame("rbAFrame", rbAFrame);
  m_frame_b =
      btTransform(rbAFrame.getBasis(), rbA.getCenterOfMassTransform()(rbAFrame.getOrigin()));
  updateState({rbA, m_rbB});
}

void QuaternionHinge::framesChanged() {
  // Another zero: the turns counted from the old one mean nothing.
  m_twist = {};
  m_turn_given = false;
  updateState({m_rbA, m_rbB});
}

void QuaternionHinge::setAxis(const btVector3& axisInA) {
  const btVector3 axis_a = direction("axisInA", axisInA), x_a = tangent(axis_a);
  const btTransform &A = m_rbA.getCenterOfMassTransform(), &B = m_rbB.getCenterOfMassTransform();
  const btVector3 axis_b = A.getBasis() * axis_a;
  const btMatrix3x3 world = follow(axis_a, axis_b, x_a);
  setFrames(btTransform(columns(x_a, axis_a.cross(x_a), axis_a), m_frame_a.getOrigin()),
            btTransform(B.getBasis().transpose() * world, B.inverse()(A(m_frame_a.getOrigin()))));
}

// --- angle ---------------------------------------------------------------------------------------

inline void QuaternionHinge::look(const Frames& at, UnwrappedAngle& angle) const {
  const Lanes dots = at.a.dots(at.b);
  const auto twist =
      equations::twist<Scalar>(dots[0], dots[1], at.a.b().dot(at.b.a()), at.a.a().dot(at.b.b()));
  followTwist(angle, twist, at.c_a + at.c_b, m_rbA, m_rbB, timeStep(), angularSpeed());
}

void QuaternionHinge::updateState(const BodyPair& pair) {
  look(frames(pair.pose_a(), pair.pose_b()), m_twist);
}

void QuaternionHinge::testLimit(const btTransform& transA, const btTransform& transB) {
  m_tested = m_twist;
  look(frames(transA, transB), m_tested);
}

btScalar QuaternionHinge::getLimitSign() {
  const Scalar angle = m_sign * m_tested.value();
  return !m_axis.limited() ? 0 : angle < m_axis.low ? 1 : angle > m_axis.high ? -1 : 0;
}

btScalar QuaternionHinge::getHingeAngle() {
  return getHingeAngle(m_rbA.getCenterOfMassTransform(), m_rbB.getCenterOfMassTransform());
}

btScalar QuaternionHinge::getHingeAngle(const btTransform& transA, const btTransform& transB) {
  // By the y axis of b, as Bullet measures it also while the axes are apart.
  const btVector3 y_b = transB.getBasis() * m_frame_b.getBasis().getColumn(1);
  const btVector3 x_a = transA.getBasis() * m_frame_a.getBasis().getColumn(0);
  const btVector3 y_a = transA.getBasis() * m_frame_a.getBasis().getColumn(1);
  return -m_sign * btAtan2(y_b.dot(x_a), y_b.dot(y_a));
}

btScalar QuaternionHinge::getAccumulatedHingeAngle() {
  updateState({m_rbA, m_rbB});
  const btScalar within = getHingeAngle();
  return within + SIMD_2_PI * std::round((angle() - within) / SIMD_2_PI);
}

void QuaternionHinge::setAccumulatedHingeAngle(btScalar accAngle) {
  m_twist.set(m_sign * finite("accumulated angle", accAngle));
  m_turn_given = true;
}

// --- settings ------------------------------------------------------------------------------------

void QuaternionHinge::setLimit(btScalar low, btScalar high, btScalar softness, btScalar biasFactor,
                               btScalar relaxationFactor) {
  finite("softness", softness);
  notNegative("bias factor", biasFactor);
  notNegative("relaxation factor", relaxationFactor);
  const bool moved = low != m_axis.low || high != m_axis.high;
  setAxisLimit(m_axis, low, high);
  m_limit_softness = softness;
  m_axis.bias = biasFactor;
  m_axis.relaxation = relaxationFactor;

  const auto half_sine = [](Scalar limit) {
    if (!BodyPair::is_finite(limit)) return limit;
    const Scalar turns = std::round(limit / SIMD_2_PI);
    return equations::half_sine(limit - turns * SIMD_2_PI, turns);
  };
  m_half_sine_axis = m_axis;
  m_half_sine_axis.drive = Axis::Drive::off;
  m_half_sine_axis.max_friction = 0;
  m_half_sine_axis.low = half_sine(low);
  m_half_sine_axis.high = half_sine(high);

  if (moved && !m_turn_given && m_axis.limited() && high - low < SIMD_2_PI) {
    const Scalar middle = (low + high) / 2, now = angle();
    m_twist.set(m_sign * (now + SIMD_2_PI * std::round((middle - now) / SIMD_2_PI)));
  }
}

void QuaternionHinge::setLimitSpring(btScalar frequency_hz, btScalar damping_ratio) {
  setAxisSpring(m_axis, frequency_hz, damping_ratio);
  m_half_sine_axis.limit_spring = m_axis.limit_spring;
}

void QuaternionHinge::enableAngularMotor(bool enableMotor, btScalar targetVelocity,
                                         btScalar maxMotorImpulse) {
  setAxisMotor(m_axis, enableMotor, targetVelocity, maxMotorImpulse);
  m_drive = Axis::Drive::velocity;
}

void QuaternionHinge::enableMotor(bool enableMotor) {
  m_axis.drive = enableMotor ? m_drive : Axis::Drive::off;
}

void QuaternionHinge::setMaxMotorImpulse(btScalar maxMotorImpulse) {
  m_axis.max_motor_impulse = bound("max motor impulse", maxMotorImpulse);
}

void QuaternionHinge::setMotorTargetVelocity(btScalar motorTargetVelocity) {
  m_axis.motor_velocity = finite("motor target velocity", motorTargetVelocity);
  m_drive = Axis::Drive::velocity;
  enableMotor(getEnableAngularMotor());
}

void QuaternionHinge::setMotorTarget(btScalar targetAngle, btScalar dt) {
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

void QuaternionHinge::setMotorTarget(const btQuaternion& qAinB, btScalar dt) {
  for (int i = 0; i < 4; ++i) finite("qAinB", qAinB[i]);
  const btQuaternion q = m_frame_b.getRotation().inverse() * qAinB * m_frame_a.getRotation();
  btScalar target = 2 * btAtan2(q.z(), q.w());
  if (target > SIMD_PI) target -= SIMD_2_PI;
  if (target < -SIMD_PI) target += SIMD_2_PI;
  setMotorTarget(target, dt);
}

void QuaternionHinge::setMotorServo(btScalar target_angle, btScalar frequency_hz,
                                    btScalar damping_ratio, btScalar max_torque) {
  setAxisServo(m_axis, target_angle, frequency_hz, damping_ratio, max_torque);
  m_drive = Axis::Drive::servo;
}

void QuaternionHinge::setFriction(btScalar max_torque) { setAxisFriction(m_axis, max_torque); }

void QuaternionHinge::setParam(int num, btScalar value, int axis) {
  if (axis != -1 && axis != 5) reject("parameter axis", axis, "a hinge has axis 5 (or -1)");
  switch (num) {
    case BT_CONSTRAINT_ERP: m_erp = {notNegative("ERP", value), true}; break;
    case BT_CONSTRAINT_CFM: m_motor_cfm = {notNegative("CFM", value), true}; break;
    case BT_CONSTRAINT_STOP_ERP: m_limit_erp = {notNegative("STOP_ERP", value), true}; break;
    case BT_CONSTRAINT_STOP_CFM: m_limit_cfm = {notNegative("STOP_CFM", value), true}; break;
    default: reject("parameter", num, "no such parameter");
  }
}

btScalar QuaternionHinge::getParam(int num, int axis) const {
  if (axis != -1 && axis != 5) reject("parameter axis", axis, "a hinge has axis 5 (or -1)");
  switch (num) {
    case BT_CONSTRAINT_ERP: return m_erp.value;
    case BT_CONSTRAINT_CFM: return m_motor_cfm.value;
    case BT_CONSTRAINT_STOP_ERP: return m_limit_erp.value;
    case BT_CONSTRAINT_STOP_CFM: return m_limit_cfm.value;
    default: reject("parameter", num, "no such parameter");
  }
}

int QuaternionHinge::getFlags() const {
  return (m_erp.is_set ? BT_HINGE_FLAGS_ERP_NORM : 0) |
         (m_motor_cfm.is_set ? BT_HINGE_FLAGS_CFM_NORM : 0) |
         (m_limit_erp.is_set ? BT_HINGE_FLAGS_ERP_STOP : 0) |
         (m_limit_cfm.is_set ? BT_HINGE_FLAGS_CFM_STOP : 0);
}

void QuaternionHinge::drawJoint(btIDebugDraw& drawer) const {
  FrameJoint::drawJoint(drawer);
  if (!drawsLimits(drawer) || m_axis.locked()) return;
  const btTransform tr = m_rbB.getCenterOfMassTransform() * m_frame_b;
  drawRange(drawer, tr.getOrigin(), tr.getBasis().getColumn(2), tr.getBasis().getColumn(0),
            m_dbgDrawSize, m_axis.low, m_axis.high);
}

// --- rows ----------------------------------------------------------------------------------------

PINTLE_FLATTEN void QuaternionHinge::prepare(const BodyPair& pair, Rows& rows) {
  const Frames at = frames(pair.pose_a(), pair.pose_b());
  look(at, m_twist);
  m_tested = m_twist;
  addRows(pair, at, m_twist, rows);
}

void QuaternionHinge::addRows(const BodyPair& pair, Rows& rows) const {
  const Frames at = frames(pair.pose_a(), pair.pose_b());
  UnwrappedAngle twist = m_twist;
  look(at, twist);
  addRows(pair, at, twist, rows);
}

inline void QuaternionHinge::addRows(const BodyPair& pair, const Frames& at,
                                     const UnwrappedAngle& twist, Rows& rows) const {
  const Vec3 d = equations::position_error(pair.x_a(), at.a.r(), pair.x_b(), at.b.r());
  const auto swing = equations::swing(at.c_a, at.c_b);
  // Also a frame that its owner has spoiled.
  if (!BodyPair::is_finite(d.sum() + swing.sigma.sum())) return;

  Acting axis;
  // With c_a and c_b all but opposite the axis has no angle.
  if ((m_axis.driven() || m_axis.limited()) && swing.h_scale < Scalar(20))
    axis = actingAngle(pair, m_axis, twist, swing.h, timeStep(), m_sign);
  if (getFormulation() == Formulation::document) {
    const bool half_sine = axis.limit && !m_axis.driven();
    addDocumentRows(pair, at, d, half_sine ? &twist : nullptr, rows);
    if (half_sine) return;
  } else {
    addConditionedRows(pair, at, d, swing, rows);
  }
  if (axis.row)
    rows.addAngularAxis(0, equations::twist_row(swing), axis.position, m_axis, axis.limit,
                        m_sign > 0 ? 1 : -1);
}

inline void QuaternionHinge::addConditionedRows(const BodyPair& pair, const Frames& at,
                                                const Vec3& d,
                                                const equations::Swing<Scalar>& swing,
                                                Rows& rows) const {
  const Vec3 w_a = pair.w_a(), w_b = pair.w_b();
  const Vec3 p = any_tangent(swing.h), q = cross(swing.h, p);
  const auto curvature = equations::swing_curvature(swing, p, q, w_a, w_b);
  const Scalar most = swing.angle > 0 ? getMaxCorrectionSpeed() / swing.angle : Scalar(0);
  const auto add = [&](const Vec3& u, Scalar second_derivative) {
    Row& row = rows.addAngular(u, u.dot(swing.sigma), second_derivative);
    row.max_speed = most * std::abs(row.position);
  };
  add(p, curvature[0]);
  add(q, curvature[1]);
  if (!m_angular_only) addConservingPositionRows(pair, at.a.r(), at.b.r(), d, rows);
}

void QuaternionHinge::addDocumentRows(const BodyPair& pair, const Frames& at, const Vec3& d,
                                      const UnwrappedAngle* limit, Rows& rows) const {
  const Mat3 F = pair.R_a() * view(m_frame_a.getBasis());
  const Mat3 F_b = pair.R_b() * view(m_frame_b.getBasis());
  const auto p = equations::relative(equations::quaternion(F), equations::quaternion(F_b));
  if (!BodyPair::is_finite(p.w + p.v.sum())) return;
  const Scalar across = std::hypot(p.v.x(), p.v.y());
  // Along the error the row turns 2/|w| times as fast as it says.
  const Scalar most =
      across > 0 ? getMaxCorrectionSpeed() * std::abs(p.w) / (2 * across) : Scalar(0);
  for (int i = 0; i < 2; ++i) {
    const auto row = equations::quaternion_hinge_row<Scalar>(p, F, Vec3::Unit(i));
    rows.addAngular(row.J_b, row.C).max_speed = most * std::abs(row.C);
  }
  if (!m_angular_only) addDocumentPositionRows(at.a.r(), at.b.r(), d, rows);
  if (limit) {
    const auto row =
        equations::quaternion_hinge_limit_row<Scalar>(p, F, Vec3::Unit(2), limit->turns());
    rows.addAngularAxis(0, row.J_b, m_sign * row.C, m_half_sine_axis, true,
                        m_sign > 0 ? 1 : -1);
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
