#include <pintle/joints/quaternion_hinge.h>

#include <pintle/body_pair.h>
#include <pintle/equations/position.h>
#include <pintle/equations/quaternion_hinge.h>
#include <pintle/equations/quaternion_hinge_limit.h>

#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

btMatrix3x3 columns(const btVector3& x, const btVector3& y, const btVector3& z) {
  return {x.x(), y.x(), z.x(), x.y(), y.y(), z.y(), x.z(), y.z(), z.z()};
}

// The frame of b whose x is that of a, carried along by the shortest turn of axis a to axis b.
btMatrix3x3 follow(const btVector3& axis_a, const btVector3& axis_b, const btVector3& x_a) {
  const btVector3 x_b = quatRotate(shortestArcQuat(axis_a, axis_b), x_a);
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

btVector3 tangent(const btVector3& axis) {
  btVector3 x, y;
  btPlaneSpace1(axis, x, y);
  return x;
}

// A bound for how much force and torque speed a body up about the hinge in a second (rad/s^2), if
// the hinge is all that holds it.
Scalar accelerationBound(const btRigidBody& body, const Vec3& h, const Vec3& r) {
  const Scalar m_inv = body.getInvMass();
  if (m_inv == 0) return 0;
  const MatrixView I_inv = view(body.getInvInertiaTensorWorld());
  const Scalar about_axis = h.dot(I_inv * h);
  if (!(about_axis > 0)) return 0;
  const Scalar lever = r.norm(), radius2 = m_inv / about_axis;
  return view(body.getTotalForce()).norm() * m_inv * lever / (lever * lever + radius2) +
         (I_inv * view(body.getTotalTorque())).norm();
}

}  // namespace

QuaternionHinge::QuaternionHinge(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
                                 const btVector3& pivotInB, const btVector3& axisInA,
                                 const btVector3& axisInB, bool useReferenceFrameA)
    : Joint(rbA, rbB, m_row_memory),
      m_sign(useReferenceFrameA ? Scalar(1) : Scalar(-1)),
      m_use_reference_frame_a(useReferenceFrameA) {
  const btVector3 axis_a = direction("axisInA", axisInA), axis_b = direction("axisInB", axisInB);
  const btVector3 x = zeroDirection(rbA, axis_a).normalized();
  m_frame_a = btTransform(columns(x, axis_a.cross(x), axis_a), point("pivotInA", pivotInA));
  m_frame_b = btTransform(follow(axis_a, axis_b, x), point("pivotInB", pivotInB));
  look(rbA.getCenterOfMassTransform(), rbB.getCenterOfMassTransform());
}

QuaternionHinge::QuaternionHinge(btRigidBody& rbA, const btVector3& pivotInA,
                                 const btVector3& axisInA, bool useReferenceFrameA)
    : Joint(rbA, m_row_memory),
      m_sign(useReferenceFrameA ? Scalar(1) : Scalar(-1)),
      m_use_reference_frame_a(useReferenceFrameA) {
  const btVector3 axis_a = direction("axisInA", axisInA);
  const btVector3 axis_b = rbA.getCenterOfMassTransform().getBasis() * axis_a;
  const btVector3 x = tangent(axis_a);
  m_frame_a = btTransform(columns(x, axis_a.cross(x), axis_a), point("pivotInA", pivotInA));
  m_frame_b = btTransform(follow(axis_a, axis_b, x), rbA.getCenterOfMassTransform()(pivotInA));
  look(rbA.getCenterOfMassTransform(), m_rbB.getCenterOfMassTransform());
}

QuaternionHinge::QuaternionHinge(btRigidBody& rbA, btRigidBody& rbB, const btTransform& rbAFrame,
                                 const btTransform& rbBFrame, bool useReferenceFrameA)
    : Joint(rbA, rbB, m_row_memory),
      m_frame_a(frame("rbAFrame", rbAFrame)),
      m_frame_b(frame("rbBFrame", rbBFrame)),
      m_sign(useReferenceFrameA ? Scalar(1) : Scalar(-1)),
      m_use_reference_frame_a(useReferenceFrameA) {
  look(rbA.getCenterOfMassTransform(), rbB.getCenterOfMassTransform());
}

QuaternionHinge::QuaternionHinge(btRigidBody& rbA, const btTransform& rbAFrame,
                                 bool useReferenceFrameA)
    : Joint(rbA, m_row_memory),
      m_frame_a(frame("rbAFrame", rbAFrame)),
      m_frame_b(rbAFrame.getBasis(), rbA.getCenterOfMassTransform()(rbAFrame.getOrigin())),
      m_sign(useReferenceFrameA ? Scalar(1) : Scalar(-1)),
      m_use_reference_frame_a(useReferenceFrameA) {
  look(rbA.getCenterOfMassTransform(), m_rbB.getCenterOfMassTransform());
}

void QuaternionHinge::setFrames(const btTransform& frameA, const btTransform& frameB) {
  frame("frameA", frameA);
  m_frame_b = frame("frameB", frameB);
  m_frame_a = frameA;
  // Another zero: the turns counted from the old one mean nothing.
  m_twist = {};
  m_turn_given = false;
  look(m_rbA.getCenterOfMassTransform(), m_rbB.getCenterOfMassTransform());
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

void QuaternionHinge::look(const btTransform& pose_a, const btTransform& pose_b) {
  const auto column = [](const btTransform& pose, const btTransform& frame, int i) -> Vec3 {
    return view(pose.getBasis()) * view(frame.getBasis()).col(i);
  };
  const auto twist = equations::twist<Vec3>(column(pose_a, m_frame_a, 0), column(pose_a, m_frame_a, 1),
                                            column(pose_b, m_frame_b, 0), column(pose_b, m_frame_b, 1));
  // Its length is 1 + cos(swing). With the axes all but opposite there is no twist to be seen, and
  // the last one stands; nor in a frame that its owner has spoiled.
  if (twist.x * twist.x + twist.y * twist.y > Scalar(0.01)) m_twist.update(twist.x, twist.y);
}

void QuaternionHinge::updateState(const BodyPair& pair) {
  look(pair.pose_a(), pair.pose_b());
  m_limit_sign = 0;
  if (m_axis.limited()) {
    const Scalar now = angle();
    m_limit_sign = now < m_axis.low ? Scalar(1) : now > m_axis.high ? Scalar(-1) : Scalar(0);
  }
}

void QuaternionHinge::testLimit(const btTransform& transA, const btTransform& transB) {
  updateState(BodyPair(m_rbA, transA, m_rbB, transB));
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
  look(m_rbA.getCenterOfMassTransform(), m_rbB.getCenterOfMassTransform());
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
  if (low != low) reject("lower limit", low, "must be a number");
  if (high != high) reject("upper limit", high, "must be a number");
  finite("softness", softness);
  notNegative("bias factor", biasFactor);
  notNegative("relaxation factor", relaxationFactor);
  const bool moved = low != m_axis.low || high != m_axis.high;
  m_axis.low = low;
  m_axis.high = high;
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
  notNegative("limit spring frequency", frequency_hz);
  notNegative("limit spring damping ratio", damping_ratio);
  m_axis.limit_spring = {SIMD_2_PI * frequency_hz, damping_ratio};
  m_half_sine_axis.limit_spring = m_axis.limit_spring;
}

void QuaternionHinge::enableAngularMotor(bool enableMotor, btScalar targetVelocity,
                                         btScalar maxMotorImpulse) {
  finite("motor target velocity", targetVelocity);
  m_axis.max_motor_impulse = bound("max motor impulse", maxMotorImpulse);
  m_axis.motor_velocity = targetVelocity;
  m_drive = Axis::Drive::velocity;
  this->enableMotor(enableMotor);
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
  const btQuaternion q =
      m_frame_b.getRotation().inverse() * qAinB * m_frame_a.getRotation();
  btScalar target = 2 * btAtan2(q.z(), q.w());
  if (target > SIMD_PI) target -= SIMD_2_PI;
  if (target < -SIMD_PI) target += SIMD_2_PI;
  setMotorTarget(target, dt);
}

void QuaternionHinge::setMotorServo(btScalar target_angle, btScalar frequency_hz,
                                    btScalar damping_ratio, btScalar max_torque) {
  finite("servo target angle", target_angle);
  positive("servo frequency", frequency_hz);
  notNegative("servo damping ratio", damping_ratio);
  m_axis.max_servo_force = bound("servo max torque", max_torque);
  m_axis.servo_target = target_angle;
  m_axis.servo_spring = {SIMD_2_PI * frequency_hz, damping_ratio};
  m_drive = Axis::Drive::servo;
  enableMotor(true);
}

void QuaternionHinge::setFriction(btScalar max_torque) {
  m_axis.max_friction = bound("friction max torque", max_torque);
}

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

// --- rows ----------------------------------------------------------------------------------------

// Whether the limit is broken, or may be reached in this step: at twice the speed of now, as the
// step may be longer than the last, and with the speed that forces add.
bool QuaternionHinge::limitActs(const BodyPair& pair, const Vec3& h, const Vec3& r_a,
                                const Vec3& r_b, Scalar angle) const {
  const Scalar distance = m_axis.distance(angle);
  if (distance <= 0 || m_axis.locked()) return true;
  if (distance > Scalar(pi / 2) || m_axis.limit_spring.angular_frequency > 0) return false;
  const Scalar dt = timeStep(), speed = 2 * m_sign * h.dot(pair.w_b() - pair.w_a());
  const Scalar gain = dt * (accelerationBound(pair.a(), h, r_a) + accelerationBound(pair.b(), h, r_b));
  return angle - m_axis.low <= dt * (gain - speed) || m_axis.high - angle <= dt * (gain + speed);
}

void QuaternionHinge::addRows(const BodyPair& pair, Rows& rows) const {
  const Vec3 r_a = pair.R_a() * view(m_frame_a.getOrigin());
  const Vec3 r_b = pair.R_b() * view(m_frame_b.getOrigin());
  const Vec3 c_a = pair.R_a() * view(m_frame_a.getBasis()).col(2);
  const Vec3 c_b = pair.R_b() * view(m_frame_b.getBasis()).col(2);
  const Vec3 d = equations::position_error(pair.x_a(), r_a, pair.x_b(), r_b);
  const auto swing = equations::swing(c_a, c_b);
  // Frames are open to their owner: what he has spoiled gets no rows.
  if (!BodyPair::is_finite(d.sum() + swing.sigma.sum() + swing.h.sum())) return;

  Scalar angle = 0;
  bool limit = false;
  // With c_a and c_b all but opposite the axis has no angle.
  if (m_axis.limited() && swing.h_scale < Scalar(20)) {
    angle = this->angle();
    limit = limitActs(pair, swing.h, r_a, r_b, angle);
  }
  const bool axis = m_axis.driven() || limit;
  if (getFormulation() == Formulation::document) {
    addDocumentRows(pair, r_a, r_b, d, limit && !m_axis.driven(), rows);
    if (limit && !m_axis.driven()) return;
  } else {
    addConditionedRows(pair, r_a, r_b, d, swing, rows);
  }
  if (axis && swing.h_scale < Scalar(20))
    rows.addAngularAxis(m_sign * equations::twist_row(c_a, c_b), m_axis.limited() ? angle : this->angle(),
                        m_axis, m_sign);
}

void QuaternionHinge::addConditionedRows(const BodyPair& pair, const Vec3& r_a, const Vec3& r_b,
                                         const Vec3& d, const equations::Swing<Scalar>& swing,
                                         Rows& rows) const {
  const Vec3 w_a = pair.w_a(), w_b = pair.w_b(), lever_a = r_a + d;
  // p towards the lighter body's centre, seen along the axis, as Bullet's hinge has it: the rows
  // are then nearly orthogonal in the mass metric as they are.
  Vec3 p = pair.inv_mass_a() * lever_a + pair.inv_mass_b() * r_b;
  const Scalar length2 = p.dot(p);
  p -= swing.h.dot(p) * swing.h;
  const Scalar across2 = p.dot(p);
  p = across2 > Scalar(1e-6) * length2 ? Vec3(p / std::sqrt(across2)) : any_tangent(swing.h);
  const Vec3 q = cross(swing.h, p);

  if (!m_angular_only) {
    const Vec3 curvature = equations::position_curvature(w_a, lever_a, w_b, r_b);
    for (const Vec3& u : {p, q, swing.h}) {
      const auto J = equations::position_row_conserving(u, r_a, d, r_b);
      rows.addEquality(J.L, J.A_a, J.A_b, u.dot(d)).curvature = u.dot(curvature);
    }
  }
  const Vec3 curvature = equations::swing_curvature(swing, w_a, w_b);
  const Scalar most = swing.angle > 0 ? getMaxCorrectionSpeed() / swing.angle : Scalar(0);
  for (const Vec3& u : {p, q}) {
    Row& row = rows.addAngular(u, u.dot(swing.sigma));
    row.curvature = u.dot(curvature);
    row.max_speed = most * std::abs(row.position);
  }
}

void QuaternionHinge::addDocumentRows(const BodyPair& pair, const Vec3& r_a, const Vec3& r_b,
                                      const Vec3& d, bool limit, Rows& rows) const {
  const Mat3 F = pair.R_a() * view(m_frame_a.getBasis());
  const Mat3 F_b = pair.R_b() * view(m_frame_b.getBasis());
  const auto p = equations::relative(equations::quaternion(F), equations::quaternion(F_b));
  if (!m_angular_only) {
    for (int i = 0; i < 3; ++i) {
      const auto J = equations::position_row<Scalar>(Vec3::Unit(i), r_a, r_b);
      rows.addEquality(J.L, J.A_a, J.A_b, d[i]);
    }
  }
  const Scalar across = std::hypot(p.v.x(), p.v.y());
  // Along the error the row turns 2/|w| times as fast as it says.
  const Scalar most = across > 0 ? getMaxCorrectionSpeed() * std::abs(p.w) / (2 * across) : Scalar(0);
  for (int i = 0; i < 2; ++i) {
    const auto row = equations::quaternion_hinge_row<Scalar>(p, F, Vec3::Unit(i));
    rows.addAngular(row.J_b, row.C).max_speed = most * std::abs(row.C);
  }
  if (limit) {
    const auto row =
        equations::quaternion_hinge_limit_row<Scalar>(p, F, Vec3::Unit(2), m_twist.turns());
    rows.addAngularAxis(m_sign * row.J_b, m_sign * row.C, m_half_sine_axis, m_sign);
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
