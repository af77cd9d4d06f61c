#include <pintle/joints/slider_joint.h>

#include <pintle/body_pair.h>
#include <pintle/bullet/frames.h>
#include <pintle/bullet/open_slider.h>
#include <pintle/bullet/stock_limits.h>
#include <pintle/equations/quaternion_hinge.h>
#include <pintle/equations/quaternion_hinge_limit.h>
#include <pintle/equations/slider.h>
#include <pintle/frame.h>
#include <pintle/bullet/complaints.h>
#include <pintle/joints/constants.h>
#include <pintle/joints/drawing.h>
#include <pintle/joints/turning.h>
#include <pintle/joints/observed_joint_rows.h>
#include <pintle/rows/swing_rows.h>

#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

// The joint frames in the world. The slide axis is a of each; d = p_b - p_a.
namespace {

// Axes of the joint frames: x, and y, by which Bullet measures the angle.
constexpr int slide_axis = 0, angle_axis = 1;

// The frame turned by an angle (rad) about its x axis.
Mat3 turned(const Mat3& F, Scalar angle) {
  const Scalar cosine = btCos(angle), sine = btSin(angle);
  const Vec3 x = F.col(0), y = F.col(1), z = F.col(2);
  Mat3 result;
  result << x, cosine * y + sine * z, cosine * z - sine * y;
  return result;
}

Scalar depthOf(const Axis& axis, Scalar position) { return beyond(position, axis.low, axis.high); }

// The error R of the frame of a, turned to the locked angle, and by as many turns as the angle is from it.
PINTLE_NOINLINE Vec3 turnedLockError(const Mat3& R, const UnwrappedAngle& twist, Scalar locked) {
  Vec3 phi = equations::orientation_error<Scalar>(turned(Mat3::Identity(), locked), R);
  const Scalar missing = twist.value() - locked - phi.x();
  phi.x() += SIMD_2_PI * std::round(missing / SIMD_2_PI);
  return phi;
}

}  // namespace

// The joint frames in the world, and the twist at them.
struct SliderModel::Observation {
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

inline SliderModel::Observation SliderModel::observe(const PosePair& poses) const {
  return {poses, m_settings.frame_a, m_settings.frame_b};
}

inline UnwrappedAngle SliderModel::angle(const Observation& seen) const {
  return followed(m_twist, seen.twist);
}

inline void SliderModel::remember(const Observation& seen, bool in_step) {
  followStep(m_twist, seen.twist, seen.a.a(), seen.b.a(), bodyA(), bodyB(), timeStep(),
             angularSpeed());
  if (!in_step) return;
  forgetLooks();
  show(seen);
}

// A load on a limit has broken it in Bullet; here it may be at it to the last bit.
inline void SliderModel::show(const Observation& seen) {
  const auto presses = [&](int axis) { return rows().axis(axis).impulse[Axis::limit] != 0; };
  showTravel(slider(), {bodyA().getCenterOfMassTransform(), bodyB().getCenterOfMassTransform()},
             seen.a, seen.b, m_settings.sign, presses(linear));
  const Lanes y_b = seen.a.components(seen.b.b());
  showAngle(slider(), y_b[1], y_b[2], presses(angular));
  const Axis& axis = m_settings.angular;
  if (axis.limited() && (axis.low < -SIMD_PI || axis.high > SIMD_PI))
    showAngularLimit(slider(), depthOf(axis, angle(seen).value()), presses(angular));
}

SliderModel::SliderModel(btSliderConstraint& slider, RowCount max_rows)
    : ObservedJoint(slider, max_rows) {
  m_settings.linear.own = &m_linear_parameters;
  m_settings.angular.own = &m_angular_parameters;
  m_settings.angular.low = m_settings.angular.high = 0;
  // Until there are frames the joint holds nothing.
  m_settings.frame_a.setOrigin(noPoint());
  m_settings.frame_a.getBasis().setIdentity();
  m_settings.frame_b = m_settings.frame_a;
  m_read.update(slider);
  readFrames(nullptr);
  readSettings(nullptr);
  const Observation seen = observe(BodyPair(bodyA(), bodyB()));
  remember(seen, false);
  // Bullet leaves them as the memory was until the first step.
  show(seen);
  hideLimits();
}

btSliderConstraint& SliderModel::slider() const {
  return static_cast<btSliderConstraint&>(const_cast<SliderModel*>(this)->constraint());
}

PosePair SliderModel::seenPair() const {
  return {m_seen_poses.a(bodyA().getCenterOfMassTransform()),
          m_seen_poses.b(bodyB().getCenterOfMassTransform())};
}

void SliderModel::setBlockRows(bool block) {
  slider().setUseFrameOffset(block);
  Joint::setBlockRows(block);
}

bool SliderModel::getBlockRows() const { return slider().getUseFrameOffset(); }

// --- what stands in Bullet's object --------------------------------------------------------------

void SliderModel::read(Complaints* complaints) {
  btSliderConstraint& from = slider();
  readFrames(complaints);
  if (m_read.update(from) || complaints != nullptr) readSettings(complaints);
}

void SliderModel::readFrames(Complaints* complaints) {
  if (!takeFrames(m_settings.frame_a, m_settings.frame_b, slider().getFrameOffsetA(),
                  slider().getFrameOffsetB(), slide_axis, angle_axis, complaints))
    return;
  forgetLooks();
  // Another zero: the turns counted from the old one mean nothing.
  m_twist = {};
  m_turn_given = false;
  remember(observe(BodyPair(bodyA(), bodyB())), false);
}

void SliderModel::readSettings(Complaints* complaints) {
  btSliderConstraint& from = slider();
  m_settings.sign = from.getUseLinearReferenceFrameA() ? Scalar(1) : Scalar(-1);
  readLimits(complaints);
  readTuning(complaints);
  takeMotor(
      m_settings.linear, &Axis::max_motor_force,
      {from.getPoweredLinMotor(), from.getTargetLinMotorVelocity(), from.getMaxLinMotorForce()},
      m_read_linear_motor, {"target linear motor velocity", "max linear motor force"}, complaints);
  takeMotor(
      m_settings.angular, &Axis::max_motor_force,
      {from.getPoweredAngMotor(), -from.getTargetAngMotorVelocity(), from.getMaxAngMotorForce()},
      m_read_angular_motor, {"target angular motor velocity", "max angular motor force"},
      complaints);
  Joint::setBlockRows(from.getUseFrameOffset());
}

void SliderModel::readLimits(Complaints* complaints) {
  btSliderConstraint& from = slider();
  const auto complain = [&](const char* field, Scalar low, Scalar high) {
    if (complaints != nullptr)
      complaints->add(field, isNumber(low) ? high : low, "must be a number, and leave a position");
  };
  const Scalar low = from.getLowerLinLimit(), high = from.getUpperLinLimit();
  if (leavesAPosition(low, high)) {
    m_settings.linear.low = low;
    m_settings.linear.high = high;
  } else {
    complain("linear limit", low, high);
  }
  const Scalar lower = from.getLowerAngLimit(), upper = from.getUpperAngLimit();
  const bool is_lower_same = isSame(lower, m_read_low), is_upper_same = isSame(upper, m_read_high);
  if (is_lower_same && is_upper_same) return;
  Axis& axis = m_settings.angular;
  const Scalar new_low = is_lower_same ? axis.low : lower,
               new_high = is_upper_same ? axis.high : upper;
  if (!leavesAPosition(new_low, new_high)) return complain("angular limit", new_low, new_high);
  m_read_low = lower;
  m_read_high = upper;
  const Axis before = axis;
  setAngleLimit(axis, new_low, new_high);
  limitSet(before);
}

// Bullet's use of these numbers. One that is set as STOP_ERP counts twice at a limit, there too:
// as the ERP, and as its softness.
void SliderModel::readTuning(Complaints* complaints) {
  btSliderConstraint& from = slider();
  const int flags = from.btSliderConstraint::getFlags();
  const auto limit = [&](Axis& axis, Scalar softness, Scalar damping) {
    takeNotNegative(axis.bias, softness, "limit softness", complaints);
    takeFinite(axis.relaxation, btFabs(1 - damping), "limit damping", complaints);
  };
  limit(m_settings.linear, from.getSoftnessLimLin(), from.getDampingLimLin());
  limit(m_settings.angular, from.getSoftnessLimAng(), from.getDampingLimAng());
  const auto equality = [&](int i, Scalar softness, int erp_flag) {
    ErpCfm& of = m_erp_cfm[i];
    const bool is_erp = (flags & erp_flag) != 0;
    takeParameter(of.erp, {is_erp, softness}, parameterName(BT_CONSTRAINT_STOP_ERP), complaints);
    if (is_erp)
      of.factor = 1;
    else
      takeNotNegative(of.factor, softness, "softness across the axis", complaints);
  };
  equality(across, from.getSoftnessOrthoLin(), BT_SLIDER_FLAGS_ERP_ORTLIN);
  equality(directions, from.getSoftnessOrthoAng(), BT_SLIDER_FLAGS_ERP_ORTANG);
  const auto take = [&](Parameter& to, int flag, int num, int axis) {
    const bool is_set = (flags & flag) != 0;
    const Scalar value = is_set ? from.btSliderConstraint::getParam(num, axis) : Scalar(0);
    takeParameter(to, {is_set, value}, parameterName(num), complaints);
  };
  AxisParameters &along = m_linear_parameters, &about = m_angular_parameters;
  if (flags != 0) {
    take(along.limit_erp, BT_SLIDER_FLAGS_ERP_LIMLIN, BT_CONSTRAINT_STOP_ERP, 0);
    take(along.limit_cfm, BT_SLIDER_FLAGS_CFM_LIMLIN, BT_CONSTRAINT_STOP_CFM, 0);
    take(along.motor_cfm, BT_SLIDER_FLAGS_CFM_DIRLIN, BT_CONSTRAINT_CFM, 0);
    take(about.limit_erp, BT_SLIDER_FLAGS_ERP_LIMANG, BT_CONSTRAINT_STOP_ERP, 3);
    take(about.limit_cfm, BT_SLIDER_FLAGS_CFM_LIMANG, BT_CONSTRAINT_STOP_CFM, 3);
    take(about.motor_cfm, BT_SLIDER_FLAGS_CFM_DIRANG, BT_CONSTRAINT_CFM, 3);
    take(m_erp_cfm[across].cfm, BT_SLIDER_FLAGS_CFM_ORTLIN, BT_CONSTRAINT_STOP_CFM, 1);
    take(m_erp_cfm[directions].cfm, BT_SLIDER_FLAGS_CFM_ORTANG, BT_CONSTRAINT_STOP_CFM, 4);
  }
  m_erp_cfm[locked_angle] = {about.limit_erp, about.limit_cfm, m_settings.angular.bias};
  m_erp_cfm_differs = m_erp_cfm[across].factor != 1 || m_erp_cfm[directions].factor != 1 ||
                      m_settings.angular.bias != 1 ||
                      (flags & ~(BT_SLIDER_FLAGS_CFM_DIRLIN | BT_SLIDER_FLAGS_CFM_DIRANG)) != 0;
}

// --- limits that Bullet's object does not have ---------------------------------------------------

void SliderModel::keepAngularLimits(Scalar low, Scalar high, bool of_any_turn) {
  Axis& axis = m_settings.angular;
  const Axis before = axis;
  if (of_any_turn)
    setAxisLimit(axis, low, high);
  else
    setAngleLimit(axis, low, high);
  // Bullet brings each into half a turn by itself.
  const bool is_wall_at_pi = !axis.is_any_angle && high - low >= SIMD_2_PI - 2 * of_pi;
  const bool shown = btFabs(low) <= SIMD_PI && btFabs(high) <= SIMD_PI && !is_wall_at_pi;
  btSliderConstraint& stock = slider();
  stock.setLowerAngLimit(shown ? low : free_low);
  stock.setUpperAngLimit(shown ? high : free_high);
  m_read_low = stock.getLowerAngLimit();
  m_read_high = stock.getUpperAngLimit();
  limitSet(before);
}

// Limits of less than a turn hold in the turn that the joint is in.
void SliderModel::limitSet(const Axis& before) {
  if (m_turn_given) return;
  const BodyPair pair(bodyA(), bodyB());
  if (pair.finite()) remember(observe(pair), false);
  turnTowardsLimit(m_twist, 1, before, m_settings.angular);
}

// --- what a client reads from Bullet's object after a step ---------------------------------------

int SliderModel::rowsOfStock(btSliderConstraint& slider) {
  return 4 + (slider.getSolveLinLimit() || slider.getPoweredLinMotor() ? 1 : 0) +
         (slider.getSolveAngLimit() || slider.getPoweredAngMotor() ? 1 : 0);
}

void SliderModel::hideLimits() { hideBroken(slider()); }

void SliderModel::drawJoint(btIDebugDraw& drawer) const {
  const_cast<SliderModel*>(this)->readFromBullet();
  const btTransform A = bodyA().getCenterOfMassTransform() * m_settings.frame_a,
                    B = bodyB().getCenterOfMassTransform() * m_settings.frame_b;
  const btScalar size = slider().getDbgDrawSize();
  drawFrames(drawer, A, B, size);
  if (!drawsLimits(drawer)) return;
  const btTransform& rail = m_settings.sign > 0 ? A : B;
  const Scalar low = m_settings.linear.low, high = m_settings.linear.high;
  if (low <= high && low > -infinity && high < infinity)
    drawer.drawLine(rail(btVector3(low, 0, 0)), rail(btVector3(high, 0, 0)), limitColor());
  drawRange(drawer, B.getOrigin(), rail.getBasis().getColumn(0), rail.getBasis().getColumn(1), size,
            m_settings.angular.low, m_settings.angular.high);
}

// --- SliderJoint ---------------------------------------------------------------------------------

// Its frames in the world are handed out by reference.
void SliderJoint::refresh() const {
  auto& self = const_cast<SliderJoint&>(*this);
  self.readFromBullet();
  const PosePair seen = seenPair();
  self.m_calculatedTransformA = seen.pose_a() * m_frameInA;
  self.m_calculatedTransformB = seen.pose_b() * m_frameInB;
}

void SliderJoint::calculateTransforms(const btTransform& transA, const btTransform& transB) {
  readFromBullet();
  m_seen_poses.set(transA, transB);
  btSliderConstraint::calculateTransforms(transA, transB);
}

void SliderJoint::setFrames(const btTransform& frameA, const btTransform& frameB) {
  forgetLooks();
  btSliderConstraint::setFrames(frameA, frameB);
}

const btTransform& SliderJoint::getCalculatedTransformA() const {
  refresh();
  return btSliderConstraint::getCalculatedTransformA();
}

const btTransform& SliderJoint::getCalculatedTransformB() const {
  refresh();
  return btSliderConstraint::getCalculatedTransformB();
}

void SliderJoint::testLinLimits() {
  m_looks[linear] = {true, depthOf(m_settings.linear, getLinearPos())};
}

void SliderJoint::testAngLimits() {
  readFromBullet();
  if (!m_seen_poses.given()) updateState(BodyPair(m_rbA, m_rbB));
  m_looks[angular] = {true, depthOf(m_settings.angular, getAngularPos())};
}

bool SliderJoint::getSolveLinLimit() {
  const Look& look = m_looks[linear];
  return look.given ? look.depth != 0 : btSliderConstraint::getSolveLinLimit();
}

btScalar SliderJoint::getLinDepth() {
  const Look& look = m_looks[linear];
  return look.given ? look.depth : btSliderConstraint::getLinDepth();
}

bool SliderJoint::getSolveAngLimit() {
  const Look& look = m_looks[angular];
  return look.given ? look.depth != 0 : btSliderConstraint::getSolveAngLimit();
}

btScalar SliderJoint::getAngDepth() {
  const Look& look = m_looks[angular];
  return look.given ? look.depth : btSliderConstraint::getAngDepth();
}

btVector3 SliderJoint::getAncorInA() const {
  const Scalar middle = (m_lowerLinLimit + m_upperLinLimit) / 2;
  const Scalar along = BodyPair::is_finite(middle) ? middle : Scalar(0);
  return m_frameInA.getOrigin() + along * m_frameInA.getBasis().getColumn(0);
}

btScalar SliderJoint::getLinearPos() const {
  refresh();
  return m_settings.sign * observe(seenPair()).offset[0];
}

btScalar SliderJoint::getAngularPos() const {
  refresh();
  const Axis& axis = m_settings.angular;
  if (axis.limited() && (axis.low < -SIMD_PI || axis.high > SIMD_PI))
    return angle(observe(seenPair())).value();
  // By the y axis of b, as Bullet measures it also while the axes are apart.
  const btMatrix3x3& F_a = m_calculatedTransformA.getBasis();
  const btVector3 y_b = m_calculatedTransformB.getBasis().getColumn(1);
  const btScalar angle = btAtan2(y_b.dot(F_a.getColumn(2)), y_b.dot(F_a.getColumn(1)));
  return btAdjustAngleToLimits(angle, axis.low, axis.high);
}

btScalar SliderJoint::getAccumulatedAngularPos() {
  readFromBullet();
  updateState(BodyPair(m_rbA, m_rbB));
  return m_twist.value();
}

void SliderJoint::setAccumulatedAngularPos(btScalar angle) {
  readFromBullet();
  m_twist.set(finite("accumulated angle", angle));
  m_turn_given = true;
}

void SliderJoint::setLowerAngLimit(btScalar lowerLimit) {
  const btScalar upper = getUpperAngLimit();
  btSliderConstraint::setLowerAngLimit(lowerLimit);
  if (leavesAPosition(lowerLimit, upper)) keepAngularLimits(lowerLimit, upper, false);
}

void SliderJoint::setUpperAngLimit(btScalar upperLimit) {
  const btScalar lower = getLowerAngLimit();
  btSliderConstraint::setUpperAngLimit(upperLimit);
  if (leavesAPosition(lower, upperLimit)) keepAngularLimits(lower, upperLimit, false);
}

btScalar SliderJoint::getLowerAngLimit() const {
  return isSame(m_lowerAngLimit, m_read_low) ? m_settings.angular.low : m_lowerAngLimit;
}

btScalar SliderJoint::getUpperAngLimit() const {
  return isSame(m_upperAngLimit, m_read_high) ? m_settings.angular.high : m_upperAngLimit;
}

void SliderJoint::setAccumulatedAngLimits(btScalar low, btScalar high) {
  keepAngularLimits(low, high, true);
}

void SliderJoint::setTargetLinMotorVelocity(btScalar targetLinMotorVelocity) {
  btSliderConstraint::setTargetLinMotorVelocity(targetLinMotorVelocity);
  m_settings.linear.choose(Axis::Drive::velocity);
}

void SliderJoint::setTargetAngMotorVelocity(btScalar targetAngMotorVelocity) {
  btSliderConstraint::setTargetAngMotorVelocity(targetAngMotorVelocity);
  m_settings.angular.choose(Axis::Drive::velocity);
}

void SliderJoint::setLinLimitSpring(btScalar frequency_hz, btScalar damping_ratio) {
  setAxisSpring(m_settings.linear, frequency_hz, damping_ratio);
}

void SliderJoint::setAngLimitSpring(btScalar frequency_hz, btScalar damping_ratio) {
  setAxisSpring(m_settings.angular, frequency_hz, damping_ratio);
}

// Other numbers of the velocity motor are another motor; of those that are there it is, if it comes again.
void SliderJoint::setLinMotorServo(btScalar target, btScalar frequency_hz, btScalar damping_ratio,
                                   btScalar max_force) {
  setAxisServo(m_settings.linear, target, frequency_hz, damping_ratio, max_force,
               "servo max force");
  setPoweredLinMotor(true);
  m_read_linear_motor = {true, m_targetLinMotorVelocity, m_maxLinMotorForce};
  takeFinite(m_settings.linear.motor_velocity, m_read_linear_motor.velocity, "", nullptr);
  takeBound(m_settings.linear.max_motor_force, m_read_linear_motor.bound, "", nullptr);
}

void SliderJoint::setAngMotorServo(btScalar target_angle, btScalar frequency_hz,
                                   btScalar damping_ratio, btScalar max_torque) {
  setAxisServo(m_settings.angular, target_angle, frequency_hz, damping_ratio, max_torque);
  setPoweredAngMotor(true);
  m_read_angular_motor = {true, -m_targetAngMotorVelocity, m_maxAngMotorForce};
  takeFinite(m_settings.angular.motor_velocity, m_read_angular_motor.velocity, "", nullptr);
  takeBound(m_settings.angular.max_motor_force, m_read_angular_motor.bound, "", nullptr);
}

void SliderJoint::setLinFriction(btScalar max_force) {
  setAxisFriction(m_settings.linear, max_force, "friction max force");
}

void SliderJoint::setAngFriction(btScalar max_torque) {
  setAxisFriction(m_settings.angular, max_torque);
}

// --- rows ----------------------------------------------------------------------------------------

inline void SliderModel::constrain(const Observation& seen, Rows& rows) const {
  const bool document = getFormulation() == Formulation::document, locked = angleIsLocked();
  if (document) addDocumentAngularRows(seen, rows);
  Acting turn;
  Vec3 turn_row = Vec3::Zero();
  if (!locked) {
    const auto swing = equations::swing(seen.a.a(), seen.b.a());
    if (!document) addSwingRows(swing, getMaxCorrectionSpeed(), rows, group(directions));
    // With the axes all but opposite there is no angle between them.
    if (swing.h_scale < max_h_scale)
      turn = actingAngle(
          m_settings.angular, [&] { return angle(seen); }, swing.h, 1, [&] { return rows.turn(); });
    if (turn.row) turn_row = equations::twist_row(swing);
  } else if (!document) {
    addLockRows(seen, rows);
  }
  const auto add_turn = [&] {
    if (!turn.row) return;
    rows.addAngularAxis(angular, turn_row, turn.position, m_settings.angular, turn.limit);
    rows.shape(RowShape::turn);
  };
  if (m_settings.angular_only) return add_turn();

  const equations::Anchors<Scalar> anchors{seen.a.r(), seen.b.r(), seen.d};
  const Vec3 lever_a = anchors.r_a + anchors.d;
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
  if (m_settings.linear.limited() || m_settings.linear.driven()) {
    const Vec3 moved = rows.moved([&](const BodyPair& v) {
      return Vec3(equations::relative_velocity<Scalar>({v.v_a(), v.w_a(), v.v_b(), v.w_b()},
                                                       lever_a, anchors.r_b));
    });
    const Scalar position = m_settings.sign * seen.offset[0];
    const Reach reach = rows.slide(seen.a.a().dot(moved), lever_a, anchors.r_b, bend[0]);
    const bool limit = m_settings.linear.limited() && slideLimitActs(position, reach);
    if (limit || m_settings.linear.driven()) {
      const auto J = equations::contact_row(seen.a.a(), anchors).J;
      rows.addAxis(linear, J.L, J.A_a, J.A_b, position, m_settings.linear, limit,
                   m_settings.sign > 0 ? 1 : -1)
          .curvature = m_settings.sign * bend[0];
    }
  }
  add_turn();  // the last one, which getAppliedImpulse tells of, as in Bullet
}

// About the axes of a, so that the angle has a row of its own.
inline void SliderModel::addLockRows(const Observation& at, Rows& rows) const {
  const UnwrappedAngle twist = angle(at);
  const auto R = [&] { return Mat3(at.a.axes().transpose() * at.b.axes()); };
  const Vec3 phi = m_settings.angular.low == 0 && twist.turns() == 0
                       ? equations::orientation_error(at.crossed, at.trace, R)
                       : turnedLockError(R(), twist, m_settings.angular.low);
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
void SliderModel::addDocumentAngularRows(const Observation& seen, Rows& rows) const {
  const bool locked = angleIsLocked();
  Mat3 F = seen.a.axes();
  if (locked && m_settings.angular.low != 0) F = turned(F, m_settings.angular.low);
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
inline bool SliderModel::slideLimitActs(Scalar position, const Reach& reach) const {
  const Scalar distance = m_settings.linear.distance(position);
  if (distance <= 0) return true;
  if (!m_settings.linear.driven() && distance > reach.max()) return false;
  return Reach{m_settings.sign * reach.moved, reach.gained}
      .of(m_settings.linear)
      .reaches(m_settings.linear, position);
}

template class ObservedJoint<SliderModel, Joint>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
