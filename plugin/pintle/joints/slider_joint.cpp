#include <pintle/joints/slider_joint.h>

#include <pintle/body_pair.h>
#include <pintle/equations/quaternion_hinge.h>
#include <pintle/equations/quaternion_hinge_limit.h>
#include <pintle/equations/slider.h>
#include <pintle/frame.h>
#include <pintle/joints/drawing.h>
#include <pintle/joints/turning.h>
#include <pintle/joints/observed_joint_rows.h>
#include <pintle/rows/swing_rows.h>

#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

// The joint frames in the world. The slide axis is a of each; d = p_b - p_a.
namespace {

// The frame turned by an angle (rad) about its x axis.
Mat3 turned(const Mat3& F, Scalar angle) {
  const Scalar cosine = btCos(angle), sine = btSin(angle);
  const Vec3 x = F.col(0), y = F.col(1), z = F.col(2);
  Mat3 result;
  result << x, cosine * y + sine * z, cosine * z - sine * y;
  return result;
}

// The error R of the frame of a, turned to the locked angle, and by as many turns as the angle is from it.
PINTLE_NOINLINE Vec3 turnedLockError(const Mat3& R, const UnwrappedAngle& twist, Scalar locked) {
  Vec3 phi = equations::orientation_error<Scalar>(turned(Mat3::Identity(), locked), R);
  const Scalar missing = twist.value() - locked - phi.x();
  phi.x() += SIMD_2_PI * std::round(missing / SIMD_2_PI);
  return phi;
}

}  // namespace

// The joint frames in the world, and the twist at them.
struct SliderJoint::Observation {
  Observation(const PosePair& poses, const btTransform& frame_a, const btTransform& frame_b)
      : a(poses.pose_a(), frame_a),
        b(poses.pose_b(), frame_b),
        d(equations::position_error(poses.x_a(), a.r(), poses.x_b(), b.r())) {
    offset = a.components(d);
    const Lanes dots = a.dots(b), sums = a.components(a.crossed(b));
    crossed = {sums[0], sums[1], sums[2]};
    trace = dots[0] + dots[1] + dots[2];
    // a.(b x b') = c.b' and a.(c x c') = -b.c'
    twist = equations::twist<Scalar>(dots[1], dots[2], sums[0], 0);
  }
  // The trace is made of all axes.
  Scalar sum() const { return d.sum() + trace; }

  Frame a, b;
  Vec3 d;
  // In the frame of a.
  Lanes offset;  ///< d
  Vec3 crossed;
  Scalar trace;
  equations::Twist<Scalar> twist;  ///< of b against a
};

inline SliderJoint::Observation SliderJoint::observe(const PosePair& poses) const {
  return {poses, m_frame_a, m_frame_b};
}

inline UnwrappedAngle SliderJoint::angle(const Observation& seen) const {
  return followed(m_twist, seen.twist);
}

inline void SliderJoint::remember(const Observation& seen, bool in_step) {
  followStep(m_twist, seen.twist, seen.a.a(), seen.b.a(), m_rbA, m_rbB, timeStep(), angularSpeed());
  if (!in_step) return;
  forgetPoses();
  m_seen = m_twist;
  m_seen_position = m_sign * seen.offset[0];
}

SliderJoint::SliderJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                         const btTransform& frameInB, bool useLinearReferenceFrameA)
    : ObservedJoint(rbA, rbB, row_count),
      m_sign(useLinearReferenceFrameA ? Scalar(1) : Scalar(-1)) {
  m_linear.own = &m_linear_parameters;
  m_angular.own = &m_angular_parameters;
  m_angular.low = m_angular.high = 0;
  m_dir_lin.damping = m_dir_ang.damping = 0;
  tuningChanged();
  setFrames(frameInA, frameInB);
}

SliderJoint::SliderJoint(btRigidBody& rbB, const btTransform& frameInB,
                         bool useLinearReferenceFrameA)
    : SliderJoint(getFixedBody(), rbB, btTransform::getIdentity(), btTransform::getIdentity(),
                  useLinearReferenceFrameA) {
  frame("frameInB", frameInB);
  setFrames(rbB.getCenterOfMassTransform() * frameInB, frameInB);
}

void SliderJoint::framesChanged() {
  forgetPoses();
  // Another zero: the turns counted from the old one mean nothing.
  m_twist = {};
  m_turn_given = false;
  testAngLimits();
  testLinLimits();
}

// --- position and angle --------------------------------------------------------------------------

void SliderJoint::testLinLimits() { m_seen_position = getLinearPos(); }

void SliderJoint::testAngLimits() {
  if (!readsPoses()) updateState(BodyPair(m_rbA, m_rbB));
  m_seen = readsPoses() ? angle(observe(seenPair())) : m_twist;
}

btVector3 SliderJoint::getAncorInA() const {
  const Scalar middle = (m_linear.low + m_linear.high) / 2;
  const Scalar along = BodyPair::is_finite(middle) ? middle : Scalar(0);
  return m_frame_a.getOrigin() + along * m_frame_a.getBasis().getColumn(0);
}

btScalar SliderJoint::getLinearPos() const { return m_sign * observe(seenPair()).offset[0]; }

btScalar SliderJoint::getAngularPos() const {
  if (m_angular.limited() && (m_angular.low < -SIMD_PI || m_angular.high > SIMD_PI))
    return angle(observe(seenPair())).value();
  // By the y axis of b, as Bullet measures it also while the axes are apart.
  const btMatrix3x3 F_a = getCalculatedTransformA().getBasis();
  const btVector3 y_b = getCalculatedTransformB().getBasis().getColumn(1);
  const btScalar angle = btAtan2(y_b.dot(F_a.getColumn(2)), y_b.dot(F_a.getColumn(1)));
  return btAdjustAngleToLimits(angle, m_angular.low, m_angular.high);
}

btScalar SliderJoint::getAccumulatedAngularPos() {
  updateState(BodyPair(m_rbA, m_rbB));
  return m_twist.value();
}

void SliderJoint::setAccumulatedAngularPos(btScalar angle) {
  m_twist.set(finite("accumulated angle", angle));
  m_turn_given = true;
  testAngLimits();
}

// --- settings ------------------------------------------------------------------------------------

void SliderJoint::setLowerLinLimit(btScalar lowerLimit) {
  setAxisLimit(m_linear, lowerLimit, m_linear.high);
}
void SliderJoint::setUpperLinLimit(btScalar upperLimit) {
  setAxisLimit(m_linear, m_linear.low, upperLimit);
}
void SliderJoint::setLowerAngLimit(btScalar lowerLimit) {
  setAngularLimits(lowerLimit, m_angular.high);
}
void SliderJoint::setUpperAngLimit(btScalar upperLimit) {
  setAngularLimits(m_angular.low, upperLimit);
}

void SliderJoint::setAngularLimits(Scalar low, Scalar high) {
  const Axis before = m_angular;
  setAngleLimit(m_angular, low, high);
  if (!m_turn_given) turnTowardsLimit(m_twist, 1, before, m_angular);
}

void SliderJoint::setAccumulatedAngLimits(btScalar low, btScalar high) {
  const Axis before = m_angular;
  setAxisLimit(m_angular, low, high);
  if (!m_turn_given) turnTowardsLimit(m_twist, 1, before, m_angular);
}

void SliderJoint::setSoftness(BulletTuning& tuning, Scalar softness) {
  tuning.softness = notNegative("softness", softness);
  tuningChanged();
}
void SliderJoint::setRestitution(BulletTuning& tuning, Scalar restitution) {
  tuning.restitution = finite("restitution", restitution);
}
void SliderJoint::setDamping(BulletTuning& tuning, Scalar damping) {
  tuning.damping = finite("damping", damping);
  tuningChanged();
}

// What Bullet makes of these numbers. One that is set as STOP_ERP counts twice at a limit, there too:
// as the ERP, and as its softness.
void SliderJoint::tuningChanged() {
  const auto set = [this](Scalar value, int flag) {
    return (m_flags & flag) != 0 ? Parameter(value) : Parameter();
  };
  const auto rebounds = [](Axis& axis, const BulletTuning& tuning) {
    axis.bias = tuning.softness;
    axis.relaxation = btFabs(1 - tuning.damping);
  };
  rebounds(m_linear, m_lim_lin);
  m_linear_parameters.limit_erp = set(m_lim_lin.softness, BT_SLIDER_FLAGS_ERP_LIMLIN);
  m_linear_parameters.limit_cfm = set(m_lim_lin.cfm, BT_SLIDER_FLAGS_CFM_LIMLIN);
  m_linear_parameters.motor_cfm = set(m_dir_lin.cfm, BT_SLIDER_FLAGS_CFM_DIRLIN);
  rebounds(m_angular, m_lim_ang);
  m_angular_parameters.limit_erp = set(m_lim_ang.softness, BT_SLIDER_FLAGS_ERP_LIMANG);
  m_angular_parameters.limit_cfm = set(m_lim_ang.cfm, BT_SLIDER_FLAGS_CFM_LIMANG);
  m_angular_parameters.motor_cfm = set(m_dir_ang.cfm, BT_SLIDER_FLAGS_CFM_DIRANG);

  const auto equality = [set](const BulletTuning& tuning, int erp_flag, int cfm_flag) {
    const Parameter erp = set(tuning.softness, erp_flag);
    return ErpCfm{erp, set(tuning.cfm, cfm_flag), erp.isSet() ? Scalar(1) : tuning.softness};
  };
  m_erp_cfm[across] = equality(m_ortho_lin, BT_SLIDER_FLAGS_ERP_ORTLIN, BT_SLIDER_FLAGS_CFM_ORTLIN);
  m_erp_cfm[directions] =
      equality(m_ortho_ang, BT_SLIDER_FLAGS_ERP_ORTANG, BT_SLIDER_FLAGS_CFM_ORTANG);
  const bool same = m_ortho_lin.softness == 1 && m_ortho_ang.softness == 1 &&
                    m_lim_ang.softness == 1 &&
                    (m_flags & ~(BT_SLIDER_FLAGS_CFM_DIRLIN | BT_SLIDER_FLAGS_CFM_DIRANG)) == 0;
  m_erp_cfm_differs = !same;
  m_erp_cfm[locked_angle] = {set(m_lim_ang.softness, BT_SLIDER_FLAGS_ERP_LIMANG),
                             set(m_lim_ang.cfm, BT_SLIDER_FLAGS_CFM_LIMANG), m_lim_ang.softness};
}

void SliderJoint::setPoweredLinMotor(bool onOff) { m_linear.enable(onOff); }
void SliderJoint::setTargetLinMotorVelocity(btScalar targetLinMotorVelocity) {
  m_linear.motor_velocity = finite("target linear motor velocity", targetLinMotorVelocity);
  m_linear.choose(Axis::Drive::velocity);
}
void SliderJoint::setMaxLinMotorForce(btScalar maxLinMotorForce) {
  m_linear.max_motor_force = bound("max linear motor force", maxLinMotorForce);
}
void SliderJoint::setPoweredAngMotor(bool onOff) { m_angular.enable(onOff); }
void SliderJoint::setTargetAngMotorVelocity(btScalar targetAngMotorVelocity) {
  m_angular.motor_velocity = -finite("target angular motor velocity", targetAngMotorVelocity);
  m_angular.choose(Axis::Drive::velocity);
}
void SliderJoint::setMaxAngMotorForce(btScalar maxAngMotorForce) {
  m_angular.max_motor_force = bound("max angular motor force", maxAngMotorForce);
}

void SliderJoint::setLinLimitSpring(btScalar frequency_hz, btScalar damping_ratio) {
  setAxisSpring(m_linear, frequency_hz, damping_ratio);
}
void SliderJoint::setAngLimitSpring(btScalar frequency_hz, btScalar damping_ratio) {
  setAxisSpring(m_angular, frequency_hz, damping_ratio);
}

void SliderJoint::setLinMotorServo(btScalar target, btScalar frequency_hz, btScalar damping_ratio,
                                   btScalar max_force) {
  setAxisServo(m_linear, target, frequency_hz, damping_ratio, max_force, "servo max force");
}
void SliderJoint::setAngMotorServo(btScalar target_angle, btScalar frequency_hz,
                                   btScalar damping_ratio, btScalar max_torque) {
  setAxisServo(m_angular, target_angle, frequency_hz, damping_ratio, max_torque);
}

void SliderJoint::setLinFriction(btScalar max_force) {
  setAxisFriction(m_linear, max_force, "friction max force");
}
void SliderJoint::setAngFriction(btScalar max_torque) { setAxisFriction(m_angular, max_torque); }

// Which of the numbers a parameter is, if any.
struct SliderJoint::Slot {
  BulletTuning SliderJoint::*tuning = nullptr;
  Scalar BulletTuning::*number = nullptr;
  int flag = 0;
};

SliderJoint::Slot SliderJoint::slot(int num, int axis) {
  using J = SliderJoint;
  if (axis > 5) return {};
  // 0: along, 1: across, 2: about, 3: the directions.
  const int group = axis < 1 ? 0 : axis < 3 ? 1 : axis == 3 ? 2 : 3;
  BulletTuning J::*const stops[] = {&J::m_lim_lin, &J::m_ortho_lin, &J::m_lim_ang, &J::m_ortho_ang};
  constexpr int erp_flags[] = {BT_SLIDER_FLAGS_ERP_LIMLIN, BT_SLIDER_FLAGS_ERP_ORTLIN,
                               BT_SLIDER_FLAGS_ERP_LIMANG, BT_SLIDER_FLAGS_ERP_ORTANG};
  constexpr int cfm_flags[] = {BT_SLIDER_FLAGS_CFM_LIMLIN, BT_SLIDER_FLAGS_CFM_ORTLIN,
                               BT_SLIDER_FLAGS_CFM_LIMANG, BT_SLIDER_FLAGS_CFM_ORTANG};
  switch (num) {
    case BT_CONSTRAINT_STOP_ERP: return {stops[group], &BulletTuning::softness, erp_flags[group]};
    case BT_CONSTRAINT_STOP_CFM: return {stops[group], &BulletTuning::cfm, cfm_flags[group]};
    case BT_CONSTRAINT_CFM:
      if (group == 0) return {&J::m_dir_lin, &BulletTuning::cfm, BT_SLIDER_FLAGS_CFM_DIRLIN};
      if (group == 2) return {&J::m_dir_ang, &BulletTuning::cfm, BT_SLIDER_FLAGS_CFM_DIRANG};
      return {};
    default: return {};
  }
}

void SliderJoint::setParam(int num, btScalar value, int axis) {
  finite(parameterName(num), value);
  const Slot to = slot(num, axis);
  if (to.tuning == nullptr) return;
  (this->*to.tuning).*to.number = notNegative(parameterName(num), value);
  m_flags |= to.flag;
  tuningChanged();
}

btScalar SliderJoint::getParam(int num, int axis) const {
  const Slot of = slot(num, axis);
  return of.tuning == nullptr ? infinity : (this->*of.tuning).*of.number;
}

void SliderJoint::getInfo2NonVirtual(btConstraintInfo2* info, const btTransform& transA,
                                     const btTransform& transB, const btVector3&, const btVector3&,
                                     btScalar, btScalar) {
  writeRowsAt(*info, transA, transB);
}

void SliderJoint::drawJoint(btIDebugDraw& drawer) const {
  FrameJoint::drawJoint(drawer);
  if (!drawsLimits(drawer)) return;
  const btTransform B = getCalculatedTransformB();
  const btTransform rail = m_sign > 0 ? getCalculatedTransformA() : B;
  const Scalar low = m_linear.low, high = m_linear.high;
  if (low <= high && low > -infinity && high < infinity)
    drawer.drawLine(rail(btVector3(low, 0, 0)), rail(btVector3(high, 0, 0)), limitColor());
  drawRange(drawer, B.getOrigin(), rail.getBasis().getColumn(0), rail.getBasis().getColumn(1),
            m_dbgDrawSize, m_angular.low, m_angular.high);
}

// --- rows ----------------------------------------------------------------------------------------

inline void SliderJoint::constrain(const Observation& seen, Rows& rows) const {
  const bool document = getFormulation() == Formulation::document, locked = angleIsLocked();
  if (document) addDocumentAngularRows(seen, rows);
  Acting turn;
  Vec3 turn_row = Vec3::Zero();
  if (!locked) {
    const auto swing = equations::swing(seen.a.a(), seen.b.a());
    if (!document) addSwingRows(swing, getMaxCorrectionSpeed(), rows, group(directions));
    // With the axes all but opposite there is no angle between them.
    if (swing.h_scale < Scalar(20))
      turn = actingAngle(
          m_angular, [&] { return angle(seen); }, swing.h, 1, [&] { return rows.turn(); });
    if (turn.row) turn_row = equations::twist_row(swing);
  } else if (!document) {
    addLockRows(seen, rows);
  }
  const auto add_turn = [&] {
    if (!turn.row) return;
    rows.addAngularAxis(angular, turn_row, turn.position, m_angular, turn.limit);
    rows.shape(RowShape::turn);
  };
  if (m_angular_only) return add_turn();

  const equations::Anchors<Scalar> anchors{seen.a.r(), seen.b.r(), seen.d};
  const Vec3 lever_a = anchors.r_a + anchors.d;
  const Vec3 moved = rows.moved([&](const BodyPair& v) {
    return Vec3(equations::relative_velocity<Scalar>({v.v_a(), v.w_a(), v.v_b(), v.w_b()}, lever_a,
                                                     anchors.r_b));
  });
  const Lanes bend = seen.a.components(rows.curvature([&](const BodyPair& v) {
    return Vec3(equations::position_curvature_conserving<Scalar>(
        anchors, {v.v_a(), v.w_a(), v.v_b(), v.w_b()}));
  }));
  // The document's rows take for granted that both bodies turn alike.
  const bool middle = document && locked;
  const auto add = [&](const Vec3& u, int i) {
    const auto J = middle ? equations::slider_row_middle(u, seen.a.a(), anchors).J
                          : equations::contact_row(u, anchors).J;
    rows.addEquality(J.L, J.A_a, J.A_b, seen.offset[i], middle ? Scalar(0) : bend[i]).group =
        group(across);
  };
  add(seen.a.b(), 1);
  add(seen.a.c(), 2);
  if (m_linear.limited() || m_linear.driven()) {
    const Scalar position = m_sign * seen.offset[0];
    const Reach reach = rows.slide(seen.a.a().dot(moved), lever_a, anchors.r_b, bend[0]);
    const bool limit = m_linear.limited() && slideLimitActs(position, reach);
    if (limit || m_linear.driven()) {
      const auto J = equations::contact_row(seen.a.a(), anchors).J;
      rows.addAxis(linear, J.L, J.A_a, J.A_b, position, m_linear, limit, m_sign > 0 ? 1 : -1)
          .curvature = m_sign * bend[0];
    }
  }
  add_turn();  // the last one, which getAppliedImpulse tells of, as in Bullet
}

// About the axes of a, so that the angle has a row of its own.
inline void SliderJoint::addLockRows(const Observation& at, Rows& rows) const {
  const UnwrappedAngle twist = angle(at);
  const auto R = [&] { return Mat3(at.a.axes().transpose() * at.b.axes()); };
  const Vec3 phi = m_angular.low == 0 && twist.turns() == 0
                       ? equations::orientation_error(at.crossed, at.trace, R)
                       : turnedLockError(R(), twist, m_angular.low);
  const Scalar error = btSqrt(phi.dot(phi));
  const Scalar speed_per_error = error > 0 ? getMaxCorrectionSpeed() / error : Scalar(0);
  const auto add = [&](const Vec3& u, Scalar C, int kind) {
    Row& row = rows.addAngular(u, C);
    row.max_speed = speed_per_error * btFabs(C);
    row.group = group(kind);
  };
  add(at.a.b(), phi.y(), directions);
  add(at.a.c(), phi.z(), directions);
  add(at.a.a(), phi.x(), locked_angle);
}

// The lock's rows, of which a free angle leaves those about the frame's other two axes.
void SliderJoint::addDocumentAngularRows(const Observation& seen, Rows& rows) const {
  const bool locked = angleIsLocked();
  Mat3 F = seen.a.axes();
  if (locked && m_angular.low != 0) F = turned(F, m_angular.low);
  const auto p =
      equations::relative(equations::quaternion(F), equations::quaternion(seen.b.axes()));
  if (!PosePair::is_finite(p.w + p.v.sum())) return;
  const Scalar error = locked ? p.v.norm() : std::hypot(p.v.y(), p.v.z());
  // Along the error the row turns 2/|w| times as fast as it says.
  const Scalar speed_per_error =
      error > 0 ? getMaxCorrectionSpeed() * btFabs(p.w) / (2 * error) : Scalar(0);
  const auto add = [&](int i, int kind) {
    const auto from = equations::quaternion_row<Scalar>(p, F, Vec3::Unit(i));
    Row& row = rows.addAngular(from.J_b, from.C);
    row.max_speed = speed_per_error * btFabs(from.C);
    row.group = group(kind);
  };
  add(1, directions);
  add(2, directions);
  if (locked) add(0, locked_angle);
}

// `reach`: along J, which the position moves with or against.
inline bool SliderJoint::slideLimitActs(Scalar position, const Reach& reach) const {
  const Scalar distance = m_linear.distance(position);
  if (distance <= 0) return true;
  if (!m_linear.driven() && distance > reach.max()) return false;
  return Reach{m_sign * reach.moved, reach.gained}.of(m_linear).reaches(m_linear, position);
}

template class ObservedJoint<SliderJoint, PosedJoint>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
