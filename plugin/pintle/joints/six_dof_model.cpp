#include <pintle/joints/six_dof_model.h>

#include <pintle/body_pair.h>
#include <pintle/bullet/complaints.h>
#include <pintle/bullet/frames.h>
#include <pintle/bullet/stock_limits.h>
#include <pintle/joints/constants.h>
#include <pintle/joints/drawing.h>
#include <pintle/joints/euler_turn.h>

#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>
#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpringConstraint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Axes of the joint frames: z of a and x of b are those of Bullet's angles, in its usual order.
constexpr int main_axis = 2, second_axis = 0;
// Before 2.89 the bound of a motor is an impulse a step.
constexpr Scalar Axis::*motor_bound =
    BT_BULLET_VERSION < 289 ? &Axis::max_motor_impulse : &Axis::max_motor_force;

const char* const axis_names[6] = {"linear x",  "linear y",  "linear z",
                                   "angular x", "angular y", "angular z"};

bool isLockedAt(const StockAxis& axis) { return axis.low == axis.high; }
// A range of a turn is none, and neither is (-pi, pi).
bool isLimitedTo(const StockAxis& axis, bool is_angle) {
  return axis.low < axis.high && !(is_angle && axis.high - axis.low >= SIMD_2_PI - 2 * of_pi);
}

btMatrix3x3 about(int axis, Scalar angle) {
  btVector3 unit(0, 0, 0);
  unit[axis] = 1;
  return btMatrix3x3(btQuaternion(unit, angle));
}

}  // namespace

SixDofModel::SixDofModel(btGeneric6DofConstraint& joint, RowCount max_rows)
    : ObservedJoint(joint, max_rows), m_first(&joint), m_euler(new EulerTurn) {
  begin();
}

SixDofModel::SixDofModel(btGeneric6DofSpringConstraint& joint, RowCount max_rows)
    : ObservedJoint(joint, max_rows), m_first(&joint), m_springs(&joint), m_euler(new EulerTurn) {
  begin();
}

SixDofModel::SixDofModel(btGeneric6DofSpring2Constraint& joint, RowCount max_rows)
    : ObservedJoint(joint, max_rows), m_second(&joint), m_euler(new EulerTurn) {
  begin();
}

SixDofModel::~SixDofModel() = default;

void SixDofModel::begin() {
  // Until there are frames the joint holds nothing.
  m_settings.frame_a.setOrigin(noPoint());
  m_settings.frame_a.getBasis().setIdentity();
  m_settings.frame_b = m_settings.frame_a;
  m_turn_a.setIdentity();
  m_turn_b.setIdentity();
  for (int i = 0; i < axis_count; ++i) {
    m_settings.axes[i].own = &m_parameters[i];
    m_settings.axes[i].bias = 1;  // no part of a correction is held back
  }
  SixDofModel::read(nullptr);
  resetAngles({});
  hideLimits();
}

const char* SixDofModel::name() const {
  return m_second != nullptr    ? "Generic6DofSpring2Joint"
         : m_springs != nullptr ? "Generic6DofSpringJoint"
                                : "Generic6DofJoint";
}

void SixDofModel::setBlockRows(bool block) {
  if (m_first != nullptr) m_first->setUseFrameOffset(block);
  m_read.frame_offset = block;
  Joint::setBlockRows(block);
}

bool SixDofModel::getBlockRows() const {
  return m_first != nullptr ? m_first->getUseFrameOffset() : Joint::getBlockRows();
}

void SixDofModel::hideLimits() {
  if (m_second != nullptr)
    hideBroken(*m_second);
  else
    hideBroken(*m_first);
}

// --- what stands in Bullet's object --------------------------------------------------------------

void SixDofModel::read(Complaints* complaints) {
  readFrames(complaints);
  if (readBits() || complaints != nullptr) readSettings(complaints);
}

void SixDofModel::readFrames(Complaints* complaints) {
  const btTransform &a = m_second != nullptr ? m_second->getFrameOffsetA()
                                             : m_first->getFrameOffsetA(),
                    &b = m_second != nullptr ? m_second->getFrameOffsetB()
                                             : m_first->getFrameOffsetB();
  if (takeFrames(m_settings.frame_a, m_settings.frame_b, a, b, main_axis, second_axis, complaints))
    resetAngles({});  // another zero: the turns counted from the old one mean nothing
}

bool SixDofModel::readBits() {
  return m_second != nullptr ? lookAtAxes(m_bits, *m_second)
                             : lookAtAxes(m_bits, *m_first, m_springs);
}

void SixDofModel::readSettings(Complaints* complaints) {
  StockSixDof from;
  if (m_second != nullptr)
    readAxes(*m_second, from);
  else
    readAxes(*m_first, from);
  if (m_springs != nullptr) readSprings(*m_springs, from);
  const StockSixDof before = m_read;
  for (int i = 0; i < axis_count; ++i) takeAxis(i, from.axes[i], complaints);
  for (int i = 0; i < 3; ++i) m_read.order[i] = from.order[i];
  m_read.damping_is_fraction = from.damping_is_fraction;
  if (m_first != nullptr) Joint::setBlockRows(m_read.frame_offset = from.frame_offset);
  settingsChanged(before);
}

void SixDofModel::takeAxis(int i, const StockAxis& from, Complaints* complaints) {
  StockAxis& to = m_read.axes[i];
  if (complaints != nullptr) complaints->setAxis(axis_names[i]);
  if (leavesAPosition(from.low, from.high)) {
    to.low = from.low;
    to.high = from.high;
  } else if (complaints != nullptr) {
    complaints->add("limit", isNumber(from.low) ? from.high : from.low,
                    "must be a number, and leave a position");
  }
  takeNotNegative(to.bounce, from.bounce, "bounce", complaints);
  to.motor = from.motor;
  to.servo = from.servo;
  to.spring = from.spring;
  if (to.motor) {
    takeFinite(to.velocity, from.velocity, "motor target velocity", complaints);
    takeBound(to.max_force, from.max_force, "max motor force", complaints);
    if (to.servo) takeFinite(to.servo_target, from.servo_target, "servo target", complaints);
  }
  if (to.spring) {
    takeNotNegative(to.stiffness, from.stiffness, "spring stiffness", complaints);
    takeNotNegative(to.damping, from.damping, "spring damping", complaints);
    takeFinite(to.rest, from.rest, "equilibrium point", complaints);
  }
  const auto take = [&](Parameter& parameter, const StockParameter& value, int num) {
    takeParameter(parameter, value, parameterName(num), complaints);
  };
  AxisParameters& own = m_parameters[i];
  take(own.limit_erp, from.limit_erp, BT_CONSTRAINT_STOP_ERP);
  take(own.limit_cfm, from.limit_cfm, BT_CONSTRAINT_STOP_CFM);
  take(own.motor_erp, from.motor_erp, BT_CONSTRAINT_ERP);
  take(own.motor_cfm, from.motor_cfm, BT_CONSTRAINT_CFM);
  if (complaints != nullptr) complaints->setAxis(nullptr);
}

// --- the settings as a step uses them, so that it need not ask ------------------------------------

void SixDofModel::settingsChanged(const StockSixDof& before) {
  const Turning last_turning = m_turning;
  const bool followed_angles = m_turning != Turning::box || m_acting >> first_angle != 0;
  const signed char last_axes[] = {m_hinge, m_of_a, m_of_b};
  Scalar last_angles[3];
  for (int i = 0; i < 3; ++i) last_angles[i] = angleOf(i);

  m_locked = m_acting = 0;
  for (int i = 0; i < axis_count; ++i) {
    const StockAxis& axis = m_read.axes[i];
    if (isLockedAt(axis))
      m_locked = static_cast<unsigned char>(m_locked | 1 << i);
    else if (isLimitedTo(axis, i >= first_angle) || axis.motor || axis.spring)
      m_acting = static_cast<unsigned char>(m_acting | 1 << i);
  }
  bool order_changed = false;
  for (int i = 0; i < 3; ++i) {
    order_changed = order_changed || m_settings.order[i] != m_read.order[i];
    m_settings.order[i] = m_read.order[i];
  }
  setTurning();
  setLockedFrames();
  setParameters();
  m_has_changing_axes = false;
  m_scale = 1;
  for (int i = 0; i < axis_count; ++i) {
    const StockAxis& axis = m_read.axes[i];
    const bool is_outer = isOuterAngle(i), middle_is_locked = isLocked(middleAngle());
    setAxis(i, 1);
    setSpring(i, axis.stiffness, axis.damping,
              is_outer && middle_is_locked ? btCos(m_read.axes[middleAngle()].low) : Scalar(1));
    const bool turns_spring = is_outer && axis.spring && !middle_is_locked;
    if (acts(i) && (turns_spring || (is_outer && m_turning == Turning::box) ||
                    (axis.spring && m_read.damping_is_fraction) ||
                    (axis.motor && axis.servo && i >= first_angle)))
      m_has_changing_axes = true;
  }

  const bool is_another = !followed_angles || order_changed || last_turning != m_turning ||
                          last_axes[0] != m_hinge || last_axes[1] != m_of_a ||
                          last_axes[2] != m_of_b;
  if (is_another) return resetAngles(last_angles);
  // A limit that is set anew holds in the turn that the joint is in, or nearest to it.
  for (int i = 0; i < 3; ++i) {
    const StockAxis &now = m_read.axes[first_angle + i], &last = before.axes[first_angle + i];
    if (now.low != last.low || now.high != last.high) turnTowardsLimit(i);
  }
}

void SixDofModel::setTurning() {
  const int* const order = m_settings.order;
  const int first = order[EulerTurn::first], middle = order[EulerTurn::middle],
            last = order[EulerTurn::last];
  const bool first_is_locked = isLocked(first_angle + first),
             middle_is_locked = isLocked(first_angle + middle),
             last_is_locked = isLocked(first_angle + last);
  const int locked = int(first_is_locked) + int(middle_is_locked) + int(last_is_locked);
  m_hinge = m_of_a = m_of_b = 0;
  m_turns_shafts = locked == 1;
  m_turning = locked == 3   ? Turning::locked
              : locked == 2 ? Turning::hinge
              : locked == 1 ? Turning::universal
                            : Turning::box;
  if (m_turning == Turning::hinge)
    m_hinge = static_cast<signed char>(!first_is_locked    ? first
                                       : !middle_is_locked ? middle
                                                           : last);
  if (m_turning != Turning::universal) return;
  m_of_a = static_cast<signed char>(last_is_locked ? middle : last);
  m_of_b = static_cast<signed char>(first_is_locked ? middle : first);
}

// R_a^T R_b = R_last(-last) R_middle(-middle) R_first(-first): what is locked comes into the frame that it is next to.
void SixDofModel::setLockedFrames() {
  m_is_turned = m_is_shifted = false;
  m_bend = 0;
  m_shift.setZero();
  for (int i = 0; i < first_angle; ++i)
    if (isLocked(i) && m_read.axes[i].low != 0) {
      m_shift[i] = m_read.axes[i].low;
      m_is_shifted = true;
    }
  const int* const order = m_settings.order;
  const auto value = [&](int n) {
    const StockAxis& axis = m_read.axes[first_angle + order[n]];
    return isLockedAt(axis) ? axis.low : Scalar(0);
  };
  const Scalar first = value(EulerTurn::first), middle = value(EulerTurn::middle),
               last = value(EulerTurn::last);
  if (first == 0 && middle == 0 && last == 0) return;
  m_turn_a.setIdentity();
  m_turn_b.setIdentity();
  const auto locked = [&](int n) { return isLocked(first_angle + order[n]); };
  const bool middle_goes_to_a = locked(EulerTurn::last),
             middle_goes_to_b = locked(EulerTurn::first);
  if (last != 0) m_turn_a = about(order[EulerTurn::last], -last);
  if (first != 0) m_turn_b = about(order[EulerTurn::first], first);
  if (middle != 0 && middle_goes_to_a)
    m_turn_a *= about(order[EulerTurn::middle], -middle);
  else if (middle != 0 && middle_goes_to_b)
    m_turn_b *= about(order[EulerTurn::middle], middle);
  else if (middle != 0)
    m_bend = btMax(-max_locked_middle, btMin(middle, max_locked_middle)) *
             Scalar(equations::EulerOrder{order[0], order[1], order[2]}.sign());
  m_is_turned = first != 0 || last != 0 || m_bend == 0;
}

void SixDofModel::setParameters() {
  bool differ = false;
  const auto isSameErp = [](const Parameter& a, const Parameter& b) {
    return a.orElse(-1) == b.orElse(-1);
  };
  for (int i = 0; i < axis_count; ++i) {
    AxisParameters& own = m_parameters[i];
    m_erp_cfm[i].erp = own.limit_erp;
    m_erp_cfm[i].cfm = own.limit_cfm;
    if (isLocked(i) || acts(i))
      differ = differ || !isSameErp(own.limit_erp, m_parameters[0].limit_erp) ||
               !isSameErp(own.limit_cfm, m_parameters[0].limit_cfm);
  }
  m_erp_cfm_differs = differ;
  m_erp = differ ? Parameter() : m_parameters[0].limit_erp;
  m_cfm = differ ? Parameter() : m_parameters[0].limit_cfm;
  // The CFM of a motor is not that of its limit here.
  for (AxisParameters& own : m_parameters)
    if (!own.limit_cfm.isSet()) own.limit_cfm = 0;
}

int SixDofModel::middleAngle() const { return first_angle + m_settings.order[EulerTurn::middle]; }
bool SixDofModel::isOuterAngle(int axis) const {
  return axis >= first_angle && axis != middleAngle();
}

void SixDofModel::setAxis(int i, Scalar scale) {
  const StockAxis& from = m_read.axes[i];
  Axis& axis = m_settings.axes[i];
  const bool is_limited = isLimitedTo(from, i >= first_angle);
  axis.low = is_limited ? scale * from.low : Scalar(1);
  axis.high = is_limited ? scale * from.high : Scalar(-1);
  axis.relaxation = from.bounce;
  axis.drive = !from.motor || isLocked(i) ? Axis::Drive::off
               : from.servo               ? Axis::Drive::approach
                                          : Axis::Drive::velocity;
  axis.motor_velocity = from.velocity;
  axis.*motor_bound = from.max_force;
  Scalar target = from.servo_target;
  if (is_limited) target = btMax(from.low, btMin(target, from.high));
  axis.servo_target = scale * target;
  axis.spring_rest = scale * from.rest;
}

void SixDofModel::setSpring(int i, Scalar stiffness, Scalar damping, Scalar cosine) {
  Spring& spring = m_settings.axes[i].spring;
  spring = {};
  if (!m_read.axes[i].spring || isLocked(i)) return;
  spring.stiffness = stiffness * btFabs(cosine);
  spring.damping = damping * cosine * cosine;
}

int SixDofModel::anyAxis(int axis) const {
  if (axis < 0 || axis >= axis_count) reject("axis", axis, "must be 0 to 5");
  return axis;
}

int SixDofModel::angleAxis(int axis) const {
  if (axis < first_angle || axis >= axis_count) reject("axis", axis, "must be 3 to 5");
  return axis;
}

// --- drawing -------------------------------------------------------------------------------------

void SixDofModel::drawJoint(btIDebugDraw& drawer) const {
  const_cast<SixDofModel*>(this)->readFromBullet();
  const btTransform a = bodyA().getCenterOfMassTransform() * m_settings.frame_a,
                    b = bodyB().getCenterOfMassTransform() * m_settings.frame_b;
  const btScalar size =
      m_second != nullptr ? m_second->getDbgDrawSize() : m_first->getDbgDrawSize();
  drawFrames(drawer, a, b, size);
  if (!drawsLimits(drawer)) return;
  for (int i = 0; i < 3; ++i) {
    const StockAxis& axis = m_read.axes[first_angle + i];
    if (!isLimitedTo(axis, true)) continue;
    const btVector3 about = a.getBasis().getColumn(i), zero = a.getBasis().getColumn((i + 1) % 3);
    drawRange(drawer, b.getOrigin(), about, zero, size, -axis.high, -axis.low);
  }
  btVector3 low, high;
  for (int i = 0; i < 3; ++i) {
    const StockAxis& axis = m_read.axes[i];
    const bool is_held = axis.low <= axis.high && axis.low > -infinity && axis.high < infinity;
    low[i] = is_held ? axis.low : Scalar(0);
    high[i] = is_held ? axis.high : Scalar(0);
  }
  drawer.drawBox(low, high, a, limitColor());
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
