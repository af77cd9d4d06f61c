#include <pintle/joints/universal_joint.h>

#include <pintle/body_pair.h>
#include <pintle/equations/position.h>
#include <pintle/equations/universal.h>
#include <pintle/frame.h>
#include <pintle/joints/constants.h>
#include <pintle/joints/drawing.h>
#include <pintle/joints/observed_joint_rows.h>
#include <pintle/joints/turning.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Bullet's angles are those of a against b, the equations' of b against a.
constexpr int sign = -1;

// Less than this of an axis's square is left across the other one: they have come together, and
// there are no angles.
constexpr Scalar min_across2 = Scalar(0.01);

// Bullet's, short of where its angles are singular.
constexpr Scalar limit_margin = Scalar(0.01);
constexpr Scalar default_motor_torque = 6;  // N m

}  // namespace

// The joint frames in the world, and the angles as they have become at them.
struct UniversalJoint::Observation {
  Frame a, b;
  Vec3 d;  ///< from the pivot of a to that of b
  Vec3 z = a.c(), y = b.b();
  Lanes dots = a.dots(b);
  Angles angles = {};

  Scalar sum() const { return d.sum() + dots.head<3>().sum() + z.dot(y); }
};

UniversalJoint::UniversalJoint(btRigidBody& rbA, btRigidBody& rbB, const btVector3& anchor,
                               const btVector3& axis1, const btVector3& axis2)
    : ObservedJoint(rbA, rbB, row_count) {
  setDefaults();
  const btTransform world = frameOf(point("anchor", anchor), axis1, axis2);
  m_anchor = anchor;
  m_axis1 = world.getBasis().getColumn(2);
  m_axis2 = world.getBasis().getColumn(1);
  setFrames(rbA.getCenterOfMassTransform().inverse() * world,
            rbB.getCenterOfMassTransform().inverse() * world);
}

UniversalJoint::UniversalJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                               const btTransform& frameInB)
    : ObservedJoint(rbA, rbB, row_count) {
  setDefaults();
  setFrames(frameInA, frameInB);
  m_anchor = getAnchor();
  m_axis1 = getCalculatedTransformA().getBasis().getColumn(2);
  m_axis2 = getCalculatedTransformB().getBasis().getColumn(1);
}

UniversalJoint::UniversalJoint(btRigidBody& rbA, const btTransform& frameInA)
    : ObservedJoint(rbA, row_count) {
  setDefaults();
  setFrames(frameInA, coincident(frameInA));
  m_anchor = getAnchor();
  m_axis1 = getCalculatedTransformA().getBasis().getColumn(2);
  m_axis2 = getCalculatedTransformB().getBasis().getColumn(1);
}

btTransform UniversalJoint::frameOf(const btVector3& anchor, const btVector3& axis1,
                                    const btVector3& axis2) const {
  const btVector3 z = direction("axis1", axis1), y = direction("axis2", axis2);
  const btScalar across = y.dot(z);
  if (btFabs(across) > btScalar(1e-3)) reject("axis2", across, "must be at right angles to axis1");
  const btVector3 y_across = (y - across * z).normalized();
  return btTransform(basisOf(y_across.cross(z), y_across), anchor);
}

void UniversalJoint::setAxis(const btVector3& axis1, const btVector3& axis2) {
  const btTransform world = frameOf(m_anchor, axis1, axis2);
  setFrames(m_rbA.getCenterOfMassTransform().inverse() * world,
            m_rbB.getCenterOfMassTransform().inverse() * world);
  m_axis1 = axis1;
  m_axis2 = axis2;
}

// --- angles --------------------------------------------------------------------------------------

inline UniversalJoint::Observation UniversalJoint::observe(const PosePair& poses) const {
  const Frame a(poses.pose_a(), m_frame_a), b(poses.pose_b(), m_frame_b);
  Observation seen{a, b, equations::position_error(poses.x_a(), a.r(), poses.x_b(), b.r())};
  seen.angles = m_angles;
  follow(seen, false, seen.angles);
  return seen;
}

// `turns_fast`: the bodies have come here in a step that may have turned them by more than half a turn.
inline void UniversalJoint::follow(const Observation& at, bool turns_fast, Angles& angles) const {
  const auto to = equations::spider_angles<Scalar>(at.a.a().dot(at.y), at.dots[1],
                                                   at.z.dot(at.b.a()), at.dots[2]);
  // Not in a frame that its owner has spoiled, either.
  if (!(to.alpha_x * to.alpha_x + to.alpha_y * to.alpha_y > min_across2)) return;
  if (!(to.beta_x * to.beta_x + to.beta_y * to.beta_y > min_across2)) return;
  // The way back goes half a turn about both axes: counted anew.
  if (angles.turned_over && to.beta_x > 0) {
    angles.turned_over = false;
    if (rightWayUp()) angles.alpha = angles.beta = {};
  }
  if (turns_fast) {
    const Vec3 turn = turnOfStep(m_rbA, m_rbB, timeStep());
    angles.alpha.update(to.alpha_x, to.alpha_y, at.z.dot(turn));
    angles.beta.update(to.beta_x, to.beta_y, at.y.dot(turn));
  } else {
    angles.alpha.update(to.alpha_x, to.alpha_y);
    angles.beta.update(to.beta_x, to.beta_y);
  }
}

inline void UniversalJoint::remember(Observation& seen, bool in_step) {
  if (!turnIsNearest(m_rbA, m_rbB, timeStep(), angularSpeed())) {
    // Anew, from the last step.
    seen.angles = m_angles;
    follow(seen, true, seen.angles);
  }
  m_angles = seen.angles;
  if (!in_step) return;
  forgetPoses();
  takeLimitMotors();
  if (m_limit_motors)
    for (int i = 0; i < 3; ++i) testAngularLimitMotor(i);
}

void UniversalJoint::framesChanged() {
  forgetPoses();
  m_angles = {};
  for (Hinge& hinge : m_hinges) hinge.turn_given = false;
  const Observation seen = observe(BodyPair(m_rbA, m_rbB));
  m_angles = seen.angles;
  m_angles.turned_over = seen.dots[2] < 0;
}

int UniversalJoint::indexOf(int axis) const {
  if (axis != 4 && axis != 5) reject("axis", axis, "must be 4 (angle 2) or 5 (angle 1)");
  return axis - 4;
}

btScalar UniversalJoint::getAngle(int axis_index) const {
  if (axis_index < 0 || axis_index > 2) reject("axis index", axis_index, "must be 0 to 2");
  const Observation seen = observe(seenPair());
  if (axis_index == 0) return sign * equations::universal_row(seen.z, seen.y).C;
  return sign * (axis_index == 2 ? seen.angles.alpha : seen.angles.beta).remainder();
}

btScalar UniversalJoint::getAccumulatedAngle(int axis) const {
  const int index = indexOf(axis);
  const Angles now = observe(seenPair()).angles;
  return sign * (index == 1 ? now.alpha : now.beta).value();
}

void UniversalJoint::setAccumulatedAngle(int axis, btScalar angle_) {
  const int index = indexOf(axis);
  finite("accumulated angle", angle_);
  updateState(BodyPair(m_rbA, m_rbB));
  angle(index).turnTowards(sign * angle_);
  m_hinges[index].turn_given = true;
}

btVector3 UniversalJoint::getAxis(int axis_index) const {
  if (axis_index < 0 || axis_index > 2) reject("axis index", axis_index, "must be 0 to 2");
  const btMatrix3x3 b = getCalculatedTransformB().getBasis();
  if (axis_index != 0) return b.getColumn(axis_index);
  const Observation seen = observe(seenPair());
  const Vec3 normal = equations::universal_row(seen.z, seen.y).J_b;
  return {normal.x(), normal.y(), normal.z()};
}

btScalar UniversalJoint::getRelativePivotPosition(int axis_index) const {
  if (axis_index < 0 || axis_index > 2) reject("axis index", axis_index, "must be 0 to 2");
  return getCalculatedTransformA().getBasis().getColumn(axis_index).dot(getAnchor2() - getAnchor());
}

// --- settings ------------------------------------------------------------------------------------

void UniversalJoint::setDefaults() {
  m_turns_shafts = true;
  const Scalar range[2] = {SIMD_HALF_PI - limit_margin, SIMD_PI - limit_margin};
  for (int i = 0; i < 2; ++i) {
    Axis& axis = m_hinges[i].axis;
    axis.own = &m_hinges[i].parameters;
    axis.low = -range[i];
    axis.high = range[i];
    // Bullet's limits: no part of a correction is held back, and none rebounds.
    axis.bias = 1;
    axis.relaxation = 0;
    axis.max_motor_force = default_motor_torque;
  }
}

void UniversalJoint::setHingeLimit(int index, Scalar low, Scalar high) {
  const Axis before = m_hinges[index].axis;
  setAngleLimit(m_hinges[index].axis, low, high);
  limitSet(index, before);
}

void UniversalJoint::limitSet(int index, const Axis& before) {
  if (!m_hinges[index].turn_given)
    turnTowardsLimit(angle(index), sign, before, m_hinges[index].axis);
}

void UniversalJoint::setLimit(int axis, btScalar lo, btScalar hi) {
  if (axis >= 0 && axis < 4) {
    held("lower limit", lo);
    held("upper limit", hi);
    return;
  }
  takeLimitMotors();
  setHingeLimit(indexOf(axis), lo, hi);
  showLimitMotors();
}

void UniversalJoint::setAccumulatedLimit(int axis, btScalar lo, btScalar hi) {
  takeLimitMotors();
  const int index = indexOf(axis);
  const Axis before = m_hinges[index].axis;
  setAxisLimit(m_hinges[index].axis, lo, hi);
  limitSet(index, before);
  showLimitMotors();
}

void UniversalJoint::setLinearLowerLimit(const btVector3& linearLower) {
  held("linear lower limit", linearLower);
}

void UniversalJoint::setLinearUpperLimit(const btVector3& linearUpper) {
  held("linear upper limit", linearUpper);
}

void UniversalJoint::setUpperLimit(btScalar ang1max, btScalar ang2max) {
  setAngularUpperLimit({0, ang1max, ang2max});
}

void UniversalJoint::setLowerLimit(btScalar ang1min, btScalar ang2min) {
  setAngularLowerLimit({0, ang1min, ang2min});
}

void UniversalJoint::setAngularLowerLimit(const btVector3& angularLower) {
  held("lower limit of axis 3", angularLower.x());
  takeLimitMotors();
  Axis tried = m_hinges[1].axis;
  setAxisLimit(tried, angularLower.z(), tried.high);
  setHingeLimit(0, angularLower.y(), m_hinges[0].axis.high);
  setHingeLimit(1, angularLower.z(), m_hinges[1].axis.high);
  showLimitMotors();
}

void UniversalJoint::setAngularUpperLimit(const btVector3& angularUpper) {
  held("upper limit of axis 3", angularUpper.x());
  takeLimitMotors();
  Axis tried = m_hinges[1].axis;
  setAxisLimit(tried, tried.low, angularUpper.z());
  setHingeLimit(0, m_hinges[0].axis.low, angularUpper.y());
  setHingeLimit(1, m_hinges[1].axis.low, angularUpper.z());
  showLimitMotors();
}

void UniversalJoint::getAngularLowerLimit(btVector3& angularLower) const {
  angularLower.setValue(0, limitOf(0).low, limitOf(1).low);
}

void UniversalJoint::getAngularUpperLimit(btVector3& angularUpper) const {
  angularUpper.setValue(0, limitOf(0).high, limitOf(1).high);
}

bool UniversalJoint::isLimited(int limitIndex) const {
  if (limitIndex >= 0 && limitIndex <= 3) return true;
  const Limit limit = limitOf(indexOf(limitIndex));
  return limit.low <= limit.high;
}

void UniversalJoint::enableMotor(int axis, bool on, btScalar velocity, btScalar max_torque) {
  setAxisForceMotor(hinge(axis).axis, on, velocity, max_torque);
  showLimitMotors();
}

void UniversalJoint::enableMotor(int axis, bool on) {
  hinge(axis).axis.enable(on);
  showLimitMotors();
}

void UniversalJoint::setMotorServo(int axis, btScalar target_angle, btScalar frequency_hz,
                                   btScalar damping_ratio, btScalar max_torque) {
  setAxisServo(hinge(axis).axis, target_angle, frequency_hz, damping_ratio, max_torque);
  showLimitMotors();
}

void UniversalJoint::setLimitSpring(int axis, btScalar frequency_hz, btScalar damping_ratio) {
  setAxisSpring(hinge(axis).axis, frequency_hz, damping_ratio);
}

void UniversalJoint::setLimitBounce(int axis, btScalar bounce) {
  hinge(axis).axis.relaxation = notNegative("limit bounce", bounce);
  showLimitMotors();
}

void UniversalJoint::setFriction(int axis, btScalar max_torque) {
  setAxisFriction(hinge(axis).axis, max_torque);
}

void UniversalJoint::setParam(int num, btScalar value, int axis) {
  const char* const field = parameterName(num);
  finite(field, value);
  if (axis < 0 || axis > 5) return;
  takeLimitMotors();
  const bool held = axis < 4;
  int flag = 0;
  switch (num) {
    case BT_CONSTRAINT_STOP_ERP:
      notNegative(field, value);
      (held ? m_erp : hinge(axis).parameters.limit_erp) = value;
      flag = BT_6DOF_FLAGS_ERP_STOP;
      break;
    case BT_CONSTRAINT_STOP_CFM:
      notNegative(field, value);
      (held ? m_cfm : hinge(axis).parameters.limit_cfm) = value;
      flag = BT_6DOF_FLAGS_CFM_STOP;
      break;
    case BT_CONSTRAINT_CFM:
      notNegative(field, value);
      (held ? m_held_motor_cfm : hinge(axis).parameters.motor_cfm) = value;
      flag = BT_6DOF_FLAGS_CFM_NORM;
      break;
    default: return;
  }
  m_flags |= flag << (axis * BT_6DOF_FLAGS_AXIS_SHIFT);
  showLimitMotors();
}

btScalar UniversalJoint::getParam(int num, int axis) const {
  if (axis < 0 || axis > 5) return 0;
  const bool held = axis < 4;
  switch (num) {
    case BT_CONSTRAINT_STOP_ERP: return (held ? m_erp : hinge(axis).parameters.limit_erp).orElse(0);
    case BT_CONSTRAINT_STOP_CFM: return (held ? m_cfm : hinge(axis).parameters.limit_cfm).orElse(0);
    case BT_CONSTRAINT_CFM:
      return (held ? m_held_motor_cfm : hinge(axis).parameters.motor_cfm).orElse(0);
    default: return 0;
  }
}

void UniversalJoint::getInfo2NonVirtual(btConstraintInfo2* info, const btTransform& transA,
                                        const btTransform& transB, const btVector3&,
                                        const btVector3&, const btVector3&, const btVector3&) {
  writeRowsAt(*info, transA, transB);
}

// --- Bullet's structs of settings ----------------------------------------------------------------

btRotationalLimitMotor* UniversalJoint::getRotationalLimitMotor(int index) {
  if (index < 0 || index > 2) reject("limit motor index", index, "must be 0 to 2");
  if (!m_limit_motors) {
    m_limit_motors = std::make_unique<LimitMotors>();
    showLimitMotors();
  } else {
    takeLimitMotors();
  }
  return &m_limit_motors->fields[index];
}

bool UniversalJoint::testAngularLimitMotor(int axis_index) {
  btRotationalLimitMotor& motor = *getRotationalLimitMotor(axis_index);
  motor.m_currentPosition =
      btAdjustAngleToLimits(getAngle(axis_index), motor.m_loLimit, motor.m_hiLimit);
  motor.testLimitValue(motor.m_currentPosition);
  return motor.needApplyTorques();
}

UniversalJoint::Limit UniversalJoint::limitOf(int index) const {
  if (m_limit_motors) {
    const btRotationalLimitMotor& fields = m_limit_motors->fields[index + 1];
    return {fields.m_loLimit, fields.m_hiLimit};
  }
  return {m_hinges[index].axis.low, m_hinges[index].axis.high};
}

// Called in a step: what is no setting is left as it was, and shown to be.
void UniversalJoint::takeLimitMotors() {
  if (!m_limit_motors) return;
  for (int index = 0; index < 2; ++index) {
    const btRotationalLimitMotor &fields = m_limit_motors->fields[index + 1],
                                 &shown = m_limit_motors->shown[index + 1];
    Axis& axis = m_hinges[index].axis;
    const Scalar low = fields.m_loLimit, high = fields.m_hiLimit;
    const bool leaves_an_angle = low > high || (low <= high && low < infinity && high > -infinity);
    if ((low != shown.m_loLimit || high != shown.m_hiLimit) && leaves_an_angle)
      setHingeLimit(index, low, high);
    if (fields.m_maxMotorForce != shown.m_maxMotorForce && fields.m_maxMotorForce >= 0)
      axis.max_motor_force = btMin(Scalar(fields.m_maxMotorForce), infinity);
    if (fields.m_targetVelocity != shown.m_targetVelocity &&
        BodyPair::is_finite(fields.m_targetVelocity)) {
      axis.motor_velocity = fields.m_targetVelocity;
      axis.choose(Axis::Drive::velocity);
    }
    if (fields.m_enableMotor != shown.m_enableMotor) axis.enable(fields.m_enableMotor);
    if (fields.m_bounce != shown.m_bounce && fields.m_bounce >= 0 && fields.m_bounce < infinity)
      axis.relaxation = fields.m_bounce;
  }
  for (int i = 0; i < 3; ++i) takeParameters(i);
  showLimitMotors();
}

// Bullet writes over the fields in each step, unless setParam has set them.
void UniversalJoint::takeParameters(int i) {
  const btRotationalLimitMotor &fields = m_limit_motors->fields[i],
                               &shown = m_limit_motors->shown[i];
  const int flags = m_flags >> ((i + 3) * BT_6DOF_FLAGS_AXIS_SHIFT);
  const auto take = [flags](Parameter& to, btScalar value, btScalar last, int flag) {
    if ((flags & flag) != 0 && value != last && value >= 0 && value < infinity) to = value;
  };
  AxisParameters* const own = i > 0 ? &m_hinges[i - 1].parameters : nullptr;
  take(own ? own->limit_erp : m_erp, fields.m_stopERP, shown.m_stopERP, BT_6DOF_FLAGS_ERP_STOP);
  take(own ? own->limit_cfm : m_cfm, fields.m_stopCFM, shown.m_stopCFM, BT_6DOF_FLAGS_CFM_STOP);
  take(own ? own->motor_cfm : m_held_motor_cfm, fields.m_normalCFM, shown.m_normalCFM,
       BT_6DOF_FLAGS_CFM_NORM);
}

void UniversalJoint::showLimitMotors() {
  if (!m_limit_motors) return;
  for (int i = 0; i < 3; ++i) {
    btRotationalLimitMotor& fields = m_limit_motors->fields[i];
    const bool held = i == 0;
    Axis axis;
    axis.low = axis.high = axis.relaxation = 0;
    axis.max_motor_force = default_motor_torque;
    if (!held) axis = m_hinges[i - 1].axis;
    fields.m_loLimit = axis.low;
    fields.m_hiLimit = axis.high;
    fields.m_enableMotor = axis.drive != Axis::Drive::off;
    fields.m_targetVelocity = axis.motor_velocity;
    fields.m_maxMotorForce = axis.max_motor_force;
    fields.m_bounce = axis.relaxation;
    fields.m_stopERP = (held ? m_erp : m_hinges[i - 1].parameters.limit_erp).orElse(Scalar(0.2f));
    fields.m_stopCFM = (held ? m_cfm : m_hinges[i - 1].parameters.limit_cfm).orElse(0);
    fields.m_normalCFM = (held ? m_held_motor_cfm : m_hinges[i - 1].parameters.motor_cfm).orElse(0);
    m_limit_motors->shown[i] = fields;
  }
}

void UniversalJoint::drawJoint(btIDebugDraw& drawer) const {
  FrameJoint::drawJoint(drawer);
  if (!drawsLimits(drawer)) return;
  const Axis &angle_2 = m_hinges[0].axis, &angle_1 = m_hinges[1].axis;
  drawPatch(drawer, getCalculatedTransformA(), getCalculatedTransformB(), m_dbgDrawSize,
            angle_2.low, angle_2.high, angle_1.low, angle_1.high);
}

// --- rows ----------------------------------------------------------------------------------------

inline bool UniversalJoint::rightWayUp() const {
  const Axis& axis = m_hinges[0].axis;
  return axis.limited() && axis.low >= -SIMD_HALF_PI && axis.high <= SIMD_HALF_PI;
}

inline void UniversalJoint::constrain(const Observation& seen, Rows& rows) const {
  const bool document = getFormulation() == Formulation::document;
  // The document's row rests there: only the limits bring it back.
  const bool turned_over = !document && seen.angles.turned_over && rightWayUp();
  const auto row = document      ? equations::universal_dot_row(seen.z, seen.y)
                   : turned_over ? equations::universal_gamma_row(seen.z, seen.b.a(), seen.b.c())
                                 : equations::universal_row(seen.z, seen.y);
  const Scalar cosine = seen.z.dot(seen.y);
  if (document) {
    rows.addAngular(row.J_b, row.C).max_speed = getMaxCorrectionSpeed() * row.J_b.norm();
    rows.shape(RowShape::dot, seen.z, seen.y);
  } else {
    const Scalar curvature = rows.curvature([&](const BodyPair& v) {
      return equations::universal_curvature<Scalar>(seen.z, seen.y, v.w_a(), v.w_b());
    });
    rows.addAngular(row.J_b, row.C, curvature).max_speed = getMaxCorrectionSpeed();
  }
  addPivotRows({seen.a.r(), seen.b.r(), seen.d}, rows);

  if (cosine * cosine > max_cross_cosine2) return;
  const Axis &first = m_hinges[1].axis, &second = m_hinges[0].axis;
  if (!first.limited() && !second.limited() && !first.driven() && !second.driven()) return;
  const AngularReach reach = rows.turn();
  addHingeRow(0, seen, reach, !turned_over, rows);
  addHingeRow(1, seen, reach, !turned_over, rows);
}

// J_b is the gradient of the angle where the joint holds, and a unit row anywhere.
inline void UniversalJoint::addHingeRow(int index, const Observation& seen,
                                        const AngularReach& reach, bool look_at_limit,
                                        Rows& rows) const {
  const Axis& axis = m_hinges[index].axis;
  const auto angle = [&] { return index == 1 ? seen.angles.alpha : seen.angles.beta; };
  const Vec3& J_b = index == 1 ? seen.z : seen.y;
  Acting now = actingAngle(axis, angle, J_b, sign, [&]() -> const AngularReach& { return reach; });
  if (!look_at_limit) now.limit = false;
  if (now.limit || axis.driven())
    rows.addAngularAxis(index, J_b, now.position, axis, now.limit, sign);
}

template class ObservedJoint<UniversalJoint, PosedJoint>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
