#include <pintle/joints/cone_twist_joint.h>

#include <pintle/body_pair.h>
#include <pintle/equations/angle_about.h>
#include <pintle/equations/cone_twist.h>
#include <pintle/equations/universal.h>
#include <pintle/frame.h>
#include <pintle/joints/drawing.h>
#include <pintle/joints/turning.h>
#include <pintle/rows/position_rows.h>
#include <pintle/rows/swing_rows.h>

#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Semiaxes (rad) that the ellipse is computed with. A strip is an ellipse as long as that.
constexpr Scalar min_span = Scalar(1e-4), max_span = Scalar(1e6);
// 1 + cos(swing) below which the twist has too few digits, and moves too fast, to be held.
constexpr Scalar min_twist_length = Scalar(0.005);
// Nearer to its target (rad) than this, or slower (rad/s), the motor has no direction worth following.
constexpr Scalar near_target = Scalar(0.1);
// Farther out of the cone (rad, across its smallest span) the way back is that to its nearest point.
constexpr Scalar far_out = Scalar(0.05);
// The smallest cosine between the normals of an edge that is no tip, where a step's forces lead and where it is nearest.
constexpr Scalar same_edge = Scalar(0.95);

bool isCone(const Axis& swing) { return swing.low <= -infinity; }

// The angle (rad, in [-pi, pi]) in the turn in which it is in the range, or nearest to it. A range
// lies within two turns either way.
Scalar inTurnOf(const Axis& range, Scalar angle) {
  const Scalar from_middle = angle - (range.low + range.high) / 2;
  if (from_middle > Scalar(pi)) return angle - Scalar(2 * pi);
  if (from_middle < Scalar(-pi)) return angle + Scalar(2 * pi);
  return angle;
}

// Free is low > high: as it was set, or where nothing is left to be held.
void setRange(Axis& axis, Scalar low, Scalar high) {
  const bool held = low <= high && high - low < Scalar(2 * pi);
  axis.low = held ? low : Scalar(1);
  axis.high = held ? high : Scalar(-1);
}

// The row of a limit at both ends, whose angle moves with -J_b. As in Bullet its impulse is positive at either.
void addRange(Rows& rows, int index, const Vec3& J_b, Scalar angle, const Axis& axis) {
  const int sign = !axis.locked() && axis.high - angle < angle - axis.low ? 1 : -1;
  rows.addAngularAxis(index, -Scalar(sign) * J_b, angle, axis, true, sign);
}

Quaternion<Scalar> fromBullet(const btQuaternion& q) { return {q.w(), Vec3(q.x(), q.y(), q.z())}; }
btQuaternion toBullet(const Quaternion<Scalar>& q) { return {q.v.x(), q.v.y(), q.v.z(), q.w}; }

}  // namespace

// Where the joint's frames are.
struct ConeTwistJoint::At {
  Frame a, b;
  Vec3 x_a = a.a(), x_b = b.a();
  Lanes dots = a.dots(b);
  Scalar cosine = dots[0];  ///< of the swing

  /// Of b against a: minus that of a against b.
  equations::Twist<Scalar> twist() const {
    return equations::twist<Scalar>(dots[1], dots[2], a.c().dot(b.b()), a.b().dot(b.c()));
  }
  /// Of a against b, as b sees it.
  equations::Swing<Scalar> swing() const { return equations::swing(x_b, x_a); }
};

// How the bodies may turn against each other in this step: by themselves, and (rad) by the motor.
struct ConeTwistJoint::Turning {
  AngularReach reach;
  Scalar driven;
  Scalar max = reach.max() + driven;

  Scalar gained() const { return reach.gained() + driven; }
  /// Of an angle that moves with J . (w_b - w_a), |J| no longer than `length` in the step.
  Reach along(const Vec3& J, Scalar length) const {
    return {J.dot(reach.moved()), gained() * length};
  }
};

// Unit vectors about which the bodies do not turn against each other.
struct ConeTwistJoint::Locks {
  int count = 0;
  Vec3 about[2];
};

// What motor and friction need, about three axes, beside what every cone-twist joint does.
struct ConeTwistJoint::Rotation {
  Axis axis;
  Scalar max_motor_impulse = -1;  ///< as set; below 0: any
  btVector3 velocity = {0, 0, 0};
  btQuaternion target = btQuaternion::getIdentity();
  btQuaternion reachable_target = btQuaternion::getIdentity();  ///< where the limits really are
};

ConeTwistJoint::ConeTwistJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& rbAFrame,
                               const btTransform& rbBFrame)
    : FrameJoint(rbA, rbB, row_count) {
  setUp(rbAFrame, rbBFrame);
}

ConeTwistJoint::ConeTwistJoint(btRigidBody& rbA, const btTransform& rbAFrame)
    : FrameJoint(rbA, row_count) {
  setUp(rbAFrame, btTransform(rbAFrame.getBasis(), btVector3(0, 0, 0)));
}

ConeTwistJoint::~ConeTwistJoint() { delete m_rotation; }

void ConeTwistJoint::setUp(const btTransform& frame_a, const btTransform& frame_b) {
  m_seen_past_twist = m_seen_past_swing = false;
  setFrames(frame_a, frame_b);
  m_swing.relaxation = m_twist.relaxation = 0;  // no rebound
  m_limit_erp = Scalar(0.3f);
  limitsChanged();
}

// --- settings ------------------------------------------------------------------------------------

Scalar ConeTwistJoint::span(const char* field, Scalar value) const {
  return btMax(Scalar(-BT_LARGE_FLOAT), btMin(number(field, value), Scalar(BT_LARGE_FLOAT)));
}

void ConeTwistJoint::setLimit(btScalar swingSpan1, btScalar swingSpan2, btScalar twistSpan,
                              btScalar softness, btScalar biasFactor, btScalar relaxationFactor) {
  const Scalar span_1 = span("swing span 1", swingSpan1);
  const Scalar span_2 = span("swing span 2", swingSpan2);
  const Scalar twist_span = span("twist span", twistSpan);
  notNegative("softness", softness);
  notNegative("bias factor", biasFactor);
  m_relaxation = finite("relaxation factor", relaxationFactor);
  m_softness = softness;
  m_limit_erp = biasFactor;
  m_min_1 = -(m_max_1 = span_1);
  m_min_2 = -(m_max_2 = span_2);
  m_twist_low = -(m_twist_high = twist_span);
  limitsChanged();
}

void ConeTwistJoint::setLimit(int limitIndex, btScalar limitValue) {
  switch (limitIndex) {
    case 3: m_twist_low = -(m_twist_high = span("twist span", limitValue)); break;
    case 4: m_min_2 = -(m_max_2 = span("swing span 2", limitValue)); break;
    case 5: m_min_1 = -(m_max_1 = span("swing span 1", limitValue)); break;
    default: reject("limit index", limitIndex, "must be 3, 4 or 5");
  }
  limitsChanged();
}

btScalar ConeTwistJoint::getLimit(int limitIndex) const {
  switch (limitIndex) {
    case 3: return getTwistSpan();
    case 4: return getSwingSpan2();
    case 5: return getSwingSpan1();
    default: reject("limit index", limitIndex, "must be 3, 4 or 5");
  }
}

void ConeTwistJoint::setFixThresh(btScalar fixThresh) {
  m_fix_threshold = finite("fix threshold", fixThresh);
  limitsChanged();
}

void ConeTwistJoint::setSwingLimits(btScalar min_1, btScalar max_1, btScalar min_2,
                                    btScalar max_2) {
  const auto side = [this](const char* field, Scalar value, Scalar outwards) {
    if (outwards * number(field, value) < 0) reject(field, value, "must be min <= 0 <= max");
    return span(field, value);
  };
  const Scalar low_1 = side("swing 1 min", min_1, -1), high_1 = side("swing 1 max", max_1, 1);
  const Scalar low_2 = side("swing 2 min", min_2, -1), high_2 = side("swing 2 max", max_2, 1);
  m_min_1 = low_1;
  m_max_1 = high_1;
  m_min_2 = low_2;
  m_max_2 = high_2;
  limitsChanged();
}

void ConeTwistJoint::setTwistLimit(btScalar low, btScalar high) {
  const auto check = [this](const char* field, Scalar value) {
    if (btFabs(number(field, value)) > Scalar(2 * pi) * (1 + SIMD_EPSILON))
      reject(field, value, "must be within 2 pi of 0");
  };
  check("twist low", low);
  check("twist high", high);
  m_twist_low = low;
  m_twist_high = high;
  limitsChanged();
}

void ConeTwistJoint::setSwingLimitSpring(btScalar frequency_hz, btScalar damping_ratio) {
  setAxisSpring(m_swing, frequency_hz, damping_ratio);
}

void ConeTwistJoint::setTwistLimitSpring(btScalar frequency_hz, btScalar damping_ratio) {
  setAxisSpring(m_twist, frequency_hz, damping_ratio);
}

equations::SwingSpans<Scalar> ConeTwistJoint::spans(Scalar softness) const {
  const auto semiaxis = [softness](Scalar side) {
    return btMax(min_span, btMin(softness * side, max_span));
  };
  return {semiaxis(m_max_1), semiaxis(-m_min_1), semiaxis(m_max_2), semiaxis(-m_min_2)};
}

// The smallest side of the cone.
Scalar ConeTwistJoint::innerSpan() const {
  const auto e = spans(m_softness);
  return btMin(btMin(e.above_1, e.below_1), btMin(e.above_2, e.below_2));
}

// What the settings come to, so that a step need not ask.
void ConeTwistJoint::limitsChanged() {
  // Bullet's rows, scaled by the square of the relaxation, are none at 0.
  const bool off = m_relaxation == 0;
  const Scalar bias = m_limit_erp.orElse(0), divisor = m_relaxation * m_relaxation;
  const Scalar gain = bias < divisor ? bias / divisor : Scalar(1);
  m_swing.bias = m_twist.bias = bias > 0 ? gain / bias : Scalar(0);

  const bool locked_1 = getSwingSpan1() < m_fix_threshold;
  const bool locked_2 = getSwingSpan2() < m_fix_threshold;
  setRange(m_swing, 1, -1);
  m_circular = false;
  m_cone_look = {};
  if (locked_1 && locked_2) {
    m_swings = Swings::locked;
  } else if (locked_1) {
    m_swings = Swings::only_2;
    if (!off) setRange(m_swing, m_min_2, m_max_2);
  } else if (locked_2) {
    m_swings = Swings::only_1;
    if (!off) setRange(m_swing, m_min_1, m_max_1);
  } else {
    m_swings = Swings::cone;
    const auto e = spans(m_softness);
    const Scalar inner = innerSpan();
    m_circular = btMax(btMax(e.above_1, e.below_1), btMax(e.above_2, e.below_2)) == inner;
    if (!off && inner < Scalar(pi)) {
      m_swing.low = -infinity;
      m_swing.high = 0;
      m_cone_look = CosineLimit(inner);
    }
  }
  const Scalar low = m_softness * m_twist_low, high = m_softness * m_twist_high;
  setRange(m_twist, off ? Scalar(1) : low, off ? Scalar(-1) : high);
  if (m_twist.limited()) m_twist_look = {m_twist.low, m_twist.high};
  if (m_rotation) {
    m_rotation->axis.motor_gain = gain;
    m_rotation->reachable_target = limited(m_rotation->target, m_softness);
  }
}

void ConeTwistJoint::setParam(int num, btScalar value, int axis) {
  const char* const field = parameterName(num);
  finite(field, value);
  const bool linear = axis >= 0 && axis < 3;
  switch (num) {
    case BT_CONSTRAINT_ERP:
    case BT_CONSTRAINT_STOP_ERP:
      (linear ? m_erp : m_limit_erp) = notNegative(field, value);
      limitsChanged();
      break;
    case BT_CONSTRAINT_CFM:
    case BT_CONSTRAINT_STOP_CFM:
      (linear ? m_cfm : m_limit_cfm) = notNegative(field, value);
      if (!linear) m_motor_cfm = m_limit_cfm;
      break;
    default: break;
  }
}

btScalar ConeTwistJoint::getParam(int num, int axis) const {
  if (axis < 0 || axis > 5) return 0;
  const bool linear = axis >= 0 && axis < 3;
  switch (num) {
    case BT_CONSTRAINT_ERP:
    case BT_CONSTRAINT_STOP_ERP: return linear ? m_erp.orElse(Scalar(0.7f)) : m_limit_erp.orElse(0);
    case BT_CONSTRAINT_CFM:
    case BT_CONSTRAINT_STOP_CFM: return linear ? m_cfm.orElse(0) : m_limit_cfm.orElse(0);
    default: return 0;
  }
}

void ConeTwistJoint::getInfo2NonVirtual(btConstraintInfo2* info, const btTransform& transA,
                                        const btTransform& transB, const btMatrix3x3&,
                                        const btMatrix3x3&) {
  writeRowsAt(*info, transA, transB);
}

int ConeTwistJoint::getFlags() const {
  return (m_cfm.isSet() ? BT_CONETWIST_FLAGS_LIN_CFM : 0) |
         (m_erp.isSet() ? BT_CONETWIST_FLAGS_LIN_ERP : 0) |
         (m_limit_cfm.isSet() ? BT_CONETWIST_FLAGS_ANG_CFM : 0);
}

// --- motor ---------------------------------------------------------------------------------------

void ConeTwistJoint::setMotorBound(Scalar max_impulse, bool normalized) {
  const Scalar impulse = span("max motor impulse", max_impulse);
  Axis& axis = rotation();
  m_rotation->max_motor_impulse = impulse;
  axis.max_motor_impulse = impulse < 0 ? infinity : btMin(impulse, infinity);
  axis.normalized_motor = normalized;
}

// The settings of motor and friction.
Axis& ConeTwistJoint::rotation() {
  if (!m_rotation) {
    setRowCount({8, axis_count});
    m_rotation = new Rotation;
    m_rotation->axis.chosen = Axis::Drive::pose;
    m_rotation->axis.max_motor_impulse = infinity;
    limitsChanged();
  }
  return m_rotation->axis;
}

bool ConeTwistJoint::isMotorEnabled() const {
  return m_rotation && m_rotation->axis.drive != Axis::Drive::off;
}

btScalar ConeTwistJoint::getMaxMotorImpulse() const {
  return m_rotation ? m_rotation->max_motor_impulse : -1;
}

bool ConeTwistJoint::isMaxMotorImpulseNormalized() const {
  return m_rotation && m_rotation->axis.normalized_motor;
}

const btQuaternion& ConeTwistJoint::getMotorTarget() const {
  return m_rotation ? m_rotation->target : btQuaternion::getIdentity();
}

void ConeTwistJoint::enableMotor(bool b) {
  if (b || m_rotation) rotation().enable(b);
}

void ConeTwistJoint::setMotorVelocity(const btVector3& velocity) {
  point("motor velocity", velocity);
  rotation().choose(Axis::Drive::rate);
  m_rotation->velocity = velocity;
}

void ConeTwistJoint::setFriction(btScalar max_torque) {
  Axis friction;
  setAxisFriction(friction, max_torque);
  if (friction.max_friction > 0 || m_rotation) rotation().max_friction = friction.max_friction;
}

void ConeTwistJoint::setMotorTarget(const btQuaternion& q) {
  for (int i = 0; i < 4; ++i) finite("motor target", q[i]);
  setMotorTargetInConstraintSpace(m_frame_b.getRotation().inverse() * q * m_frame_a.getRotation());
}

void ConeTwistJoint::setMotorTargetInConstraintSpace(const btQuaternion& q) {
  for (int i = 0; i < 4; ++i) finite("motor target", q[i]);
  const Scalar length = q.length();
  if (!(length > SIMD_EPSILON && length < infinity))
    reject("motor target", length, "must have a length");
  rotation().choose(Axis::Drive::pose);
  m_rotation->target = limited(q / length, 1);
  m_rotation->reachable_target = limited(m_rotation->target, m_softness);
}

// Along a swing in the direction (about_1, about_2), not 0, the angle at which the cone ends.
Scalar ConeTwistJoint::swingRadius(Scalar about_1, Scalar about_2, Scalar softness) const {
  const auto e = spans(softness);
  const Scalar e_1 = about_1 < 0 ? e.below_1 : e.above_1, e_2 = about_2 < 0 ? e.below_2 : e.above_2;
  return std::hypot(about_1, about_2) / std::hypot(about_1 / e_1, about_2 / e_2);
}

// The rotation without what is beyond the limits of its swing, straight towards none, and of its
// twist.
btQuaternion ConeTwistJoint::limited(const btQuaternion& q, Scalar softness) const {
  const Vec3 x = Vec3::Unit(0);
  const auto parts = equations::swing_twist(fromBullet(q), x);
  Vec3 swing = equations::rotation_vector(parts.swing);
  Scalar twist = equations::rotation_vector(parts.twist).x();
  if (m_twist.limited()) {
    twist = inTurnOf(m_twist, twist);
    twist = btMax(softness * m_twist_low, btMin(twist, softness * m_twist_high));
  }
  if (m_swings == Swings::cone) {
    const Scalar angle = swing.norm();
    const Scalar radius =
        m_swing.limited() && angle > 0 ? swingRadius(swing.z(), swing.y(), softness) : angle;
    if (angle > radius) swing *= radius / angle;
  } else {
    // As a sees it, which has turned by the twist.
    const auto as_a = equations::rotation<Scalar>(x, -twist);
    swing = equations::rotate(as_a, swing);
    const auto only = [this](Scalar angle) {
      return m_swing.limited() ? btMax(m_swing.low, btMin(angle, m_swing.high)) : angle;
    };
    swing.y() = m_swings == Swings::only_2 ? only(swing.y()) : Scalar(0);
    swing.z() = m_swings == Swings::only_1 ? only(swing.z()) : Scalar(0);
    swing = equations::rotate(equations::conjugate(as_a), swing);
  }
  const Scalar angle = swing.norm();
  const Vec3 axis = angle > 0 ? Vec3(swing / angle) : Vec3::Unit(1);
  return toBullet(equations::product(equations::rotation<Scalar>(axis, angle),
                                     equations::rotation<Scalar>(x, twist)));
}

btVector3 ConeTwistJoint::rotationImpulse(Axis::Part part) const {
  Vec3 sum = Vec3::Zero();
  for (int i = rotation_axis; m_rotation && i < axis_count; ++i) {
    const Scalar impulse = axisImpulse(i, part);
    if (impulse == 0) continue;
    // Rows of older steps may lie behind those of this one.
    const Row* row = &rows()[0];
    while (row->axis != i) ++row;
    sum -= impulse * row->A_b;
  }
  return {sum.x(), sum.y(), sum.z()};
}

// --- readings ------------------------------------------------------------------------------------

inline ConeTwistJoint::At ConeTwistJoint::at(const PosePair& poses) const {
  return {{poses.pose_a(), m_frame_a}, {poses.pose_b(), m_frame_b}};
}

void ConeTwistJoint::calcAngleInfo2(const btTransform& transA, const btTransform& transB,
                                    const btMatrix3x3&, const btMatrix3x3&) {
  const PosePair pair(transA, transB);
  m_seen_twist = twistAt(pair);
  m_seen_past_twist = isPastTwistLimit(m_seen_twist);
  m_seen_past_swing = isPastSwingLimit(pair);
  m_seen = true;
}

Scalar ConeTwistJoint::twistAt(const PosePair& pair) const {
  return -equations::twist_angle(at(pair).twist());
}

btScalar ConeTwistJoint::getTwist() const { return twistAt(BodyPair(m_rbA, m_rbB)); }

btScalar ConeTwistJoint::getTwistAngle() const {
  return getTwistSpan() < 0 ? Scalar(0) : btFabs(m_seen ? m_seen_twist : getTwist());
}

btScalar ConeTwistJoint::getSwing1() const {
  const BodyPair pair(m_rbA, m_rbB);
  const At now = at(pair);
  return now.swing().sigma.dot(now.b.c());
}

btScalar ConeTwistJoint::getSwing2() const {
  const BodyPair pair(m_rbA, m_rbB);
  const At now = at(pair);
  return now.swing().sigma.dot(now.b.b());
}

bool ConeTwistJoint::isPastTwistLimit(Scalar twist) const {
  return m_twist.limited() && m_twist.distance(inTurnOf(m_twist, twist)) < 0;
}

bool ConeTwistJoint::isPastSwingLimit() {
  return m_seen ? m_seen_past_swing : isPastSwingLimit(BodyPair(m_rbA, m_rbB));
}

bool ConeTwistJoint::isPastSwingLimit(const PosePair& pair) const {
  if (m_swings != Swings::cone) return true;
  if (!m_swing.limited()) return false;
  const At now = at(pair);
  return coneRow(now, now.swing()).C > 0;
}

btVector3 ConeTwistJoint::GetPointForAngle(btScalar angleInRadians, btScalar length) const {
  const Scalar about_1 = -btSin(angleInRadians), about_2 = btCos(angleInRadians);
  const Scalar angle = btMin(swingRadius(about_1, about_2, 1), Scalar(pi));
  const Scalar across = length * btSin(angle);
  return {length * btCos(angle), about_1 * across, -about_2 * across};
}

void ConeTwistJoint::drawJoint(btIDebugDraw& drawer) const {
  FrameJoint::drawJoint(drawer);
  if (!drawsLimits(drawer)) return;
  const btTransform B = getCalculatedTransformB();
  if (m_swing.limited() || m_swings == Swings::locked) {
    constexpr int segments = 32;
    drawCone(drawer, B.getOrigin(), segments, [&](int i) {
      return B * GetPointForAngle(SIMD_2_PI * Scalar(i) / segments, m_dbgDrawSize);
    });
  }
  // As Bullet has it: in a where b does not move. There the range of a's own y goes back by the twist.
  const bool in_b = m_rbB.getInvMass() > 0;
  const btTransform tr = in_b ? B : getCalculatedTransformA();
  const Scalar twist = in_b ? Scalar(0) : getTwist();
  const bool held = m_twist.limited();
  drawRange(drawer, tr.getOrigin(), tr.getBasis().getColumn(0), tr.getBasis().getColumn(1),
            m_dbgDrawSize, held ? m_twist_low - twist : 1, held ? m_twist_high - twist : -1);
}

// --- rows ----------------------------------------------------------------------------------------

PINTLE_FLATTEN void ConeTwistJoint::addRows(const PosePair& poses, Rows& rows) const {
  const At here = at(poses);
  const Vec3 d = equations::position_error(poses.x_a(), here.a.r(), poses.x_b(), here.b.r());
  // Also frames that their owner has spoiled.
  if (!PosePair::is_finite(d.sum() + here.dots[0] + here.dots[1] + here.dots[2])) return;
  const Locks locks = m_swings == Swings::cone ? Locks() : addLocks(here, rows);
  addPivotRows({here.a.r(), here.b.r(), d}, rows);
  const Scalar driven =
      m_rotation && m_rotation->axis.driven() ? addRotation(here, locks, rows) : Scalar(0);
  if (!m_swing.limited() && !m_twist.limited()) return;
  const Turning turning{rows.turn(), driven};
  if (m_swing.limited())
    isCone(m_swing) ? addConeLimit(here, turning, rows) : addOneSwingLimit(here, turning, rows);
  if (m_twist.limited()) addTwistLimit(here, turning, rows);
}

ConeTwistJoint::Locks ConeTwistJoint::addLocks(const At& at, Rows& rows) const {
  Locks locks;
  if (m_swings != Swings::locked) {
    const Vec3 hinge = m_swings == Swings::only_1 ? at.a.c() : at.a.b();
    const auto row = equations::universal_row(hinge, at.x_b);
    const Scalar curvature = rows.curvature([&](const BodyPair& v) {
      return equations::universal_curvature<Scalar>(hinge, at.x_b, v.w_a(), v.w_b());
    });
    rows.addAngular(row.J_b, row.C, curvature).max_speed = getMaxCorrectionSpeed();
    locks.about[locks.count++] = row.J_b;
    return locks;
  }
  const auto swing = equations::swing(at.x_a, at.x_b);
  for (const Vec3& u : addSwingRows(swing, getMaxCorrectionSpeed(), rows))
    locks.about[locks.count++] = u;
  return locks;
}

// Motor and friction: about the way to the target, and about two axes across it, so that the motor's
// bound is that of one straight push. Returns how far (rad) the motor turns the bodies in this step.
Scalar ConeTwistJoint::addRotation(const At& at, const Locks& locks, Rows& rows) const {
  // The way to the target, or the velocity, of b against a.
  Vec3 error = Vec3::Zero(), along = at.x_b, across = at.b.b();
  Scalar length = 0, turn = 0;
  if (isMotorEnabled()) {
    if (m_rotation->axis.drive == Axis::Drive::rate) {
      error = at.b.axes() * -view(m_rotation->velocity);
      length = error.norm();
      turn = rows.advance(length);
    } else {
      error = turnBetween(at.a, at.b.turned(btMatrix3x3(m_rotation->reachable_target)));
      length = error.norm();
      turn = m_rotation->axis.motor_gain * length;
    }
    if (length > near_target) {
      along = error / length;
      across = any_tangent(along);
    }
  }
  int index = rotation_axis;
  const auto add = [&](const Vec3& u) {
    rows.addAngularAxis(index++, u, error.dot(u), m_rotation->axis, false);
  };
  if (locks.count == 2) {
    add(cross(locks.about[0], locks.about[1]));
    return turn;
  }
  if (locks.count == 1) {
    across = locks.about[0];
    along -= along.dot(across) * across;
    const Scalar left = along.norm();
    along = left > near_target ? Vec3(along / left) : any_tangent(across);
  } else {
    add(across);
  }
  add(cross(along, across));
  add(along);
  return turn;
}

// C > 0 outside, and J_a.
inline equations::AngularRow<Scalar> ConeTwistJoint::coneRow(
    const At& at, const equations::Swing<Scalar>& swing) const {
  const auto e = spans(m_softness);
  if (!m_circular)
    return equations::elliptic_cone_row<Scalar>(swing, at.x_b, at.b.c(), at.b.b(), e);
  if (getFormulation() == Formulation::conditioned)
    return equations::cone_row<Scalar>(swing, at.x_b, e.above_1);
  const auto row = equations::cone_dot_row<Scalar>(at.x_b, at.x_a, e.above_1);
  return {-row.J_b, -row.C};
}

inline void ConeTwistJoint::addConeLimit(const At& at, const Turning& turning, Rows& rows) const {
  // The edge is no nearer than the smallest span is: no more is asked of a swing that is well inside.
  if (!m_cone_look.isFarInside(at.cosine, turning.max)) addNearConeLimit(at, turning, rows);
}

void ConeTwistJoint::addNearConeLimit(const At& at, const Turning& turning, Rows& rows) const {
  const bool spring = m_swing.limit_spring.angular_frequency > 0;
  const auto s = at.swing();
  const Vec3 e_1 = at.b.c(), e_2 = at.b.b();
  const auto e = spans(m_softness);
  const bool document = m_circular && getFormulation() == Formulation::document;
  // Where the bodies will be they have another velocity. The edge is the nearest one there, but in a tip.
  const bool inPlace = rows.inPlace();
  const Scalar far = 1 + far_out / innerSpan();
  const bool ahead =
      rows.inStep() && !spring && !document &&
      equations::cone_ratio2<Scalar>(s.sigma.dot(e_1), s.sigma.dot(e_2), e) < far * far;
  auto row = ahead ? equations::elliptic_cone_row_ahead<Scalar>(
                         s, at.x_b, e_1, e_2, e, Vec3(-turning.reach.moved()),
                         inPlace ? Scalar(0.5) : Scalar(0), turning.gained())
                   : coneRow(at, s);
  if (ahead && !inPlace) {
    const auto nearest = coneRow(at, s);
    if (row.J_b.dot(nearest.J_b) > same_edge * nearest.J_b.norm() * row.J_b.norm()) row = nearest;
  }
  if (turning.along(-row.J_b, row.J_b.norm()).of(m_swing).reaches(m_swing, row.C))
    rows.addAngularAxis(swing_axis, -row.J_b, row.C, m_swing, true);
}

// The one swing that is not locked, as body a sees it.
void ConeTwistJoint::addOneSwingLimit(const At& at, const Turning& turning, Rows& rows) const {
  const Vec3 hinge = m_swings == Swings::only_1 ? at.a.c() : at.a.b();
  const auto to = equations::angle_about(hinge, at.x_a, at.x_b);
  if (!(to.length > near_target)) return;  // first the lock has to bring it back
  const Vec3 J_b = to.J_b();
  const Scalar angle = inTurnOf(m_swing, -to.angle());
  if (turning.along(-J_b, J_b.norm()).of(m_swing).reaches(m_swing, angle))
    addRange(rows, swing_axis, J_b, angle, m_swing);
}

inline void ConeTwistJoint::addTwistLimit(const At& at, const Turning& turning, Rows& rows) const {
  const Scalar length = 1 + at.cosine;
  if (!(length > min_twist_length)) return;
  const auto to = at.twist();
  // J_b is no longer than 2 / length.
  if (!m_twist_look.isFarInside(to.x, -to.y, length, 2 * turning.max))
    addNearTwistLimit(at, turning, rows);
}

void ConeTwistJoint::addNearTwistLimit(const At& at, const Turning& turning, Rows& rows) const {
  const auto to = at.twist();
  const Vec3 J_b = equations::twist_row(at.x_a, at.x_b);
  const Scalar angle = inTurnOf(m_twist, -arctangent(to.y, to.x));
  const Reach reach = turning.along(-J_b, 2 / (1 + at.cosine)).of(m_twist);
  if (reach.reaches(m_twist, angle)) addRange(rows, twist_axis, J_b, angle, m_twist);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
