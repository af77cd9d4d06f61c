#include <pintle/joints/hinge_model.h>

#include <pintle/bullet/frames.h>
#include <pintle/bullet/stock_limits.h>
#include <pintle/bullet/complaints.h>
#include <pintle/joints/drawing.h>
#include <pintle/joints/hinge_rows.h>
#include <pintle/rows/position_rows.h>

#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>

#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
HingeModel::HingeModel(btHingeConstraint& hinge, RowCount max_rows)
    : Joint(hinge, max_rows),
      m_sign(-referenceSign(hinge)),
      m_read_limit{0, -1},
      m_read_motor{false, 0, 0} {
  // Until there are frames the joint holds nothing.
  m_settings.frame_a.setOrigin(noPoint());
  m_settings.frame_a.getBasis().setIdentity();
  m_settings.frame_b = m_settings.frame_a;
  HingeModel::read(nullptr);
  remember(observe(BodyPair(bodyA(), bodyB())), false);
}

HingeModel::HingeModel(btHingeAccumulatedAngleConstraint& hinge, RowCount max_rows)
    : HingeModel(static_cast<btHingeConstraint&>(hinge), max_rows) {
  m_accumulated = &accumulatedAngle(hinge);
}

btHingeConstraint& HingeModel::hinge() const {
  return static_cast<btHingeConstraint&>(const_cast<HingeModel*>(this)->constraint());
}

void HingeModel::setBlockRows(bool block) {
  hinge().setUseFrameOffset(block);
  Joint::setBlockRows(block);
}

bool HingeModel::getBlockRows() const { return hinge().getUseFrameOffset(); }

// --- what stands in Bullet's object --------------------------------------------------------------

void HingeModel::read(Complaints* complaints) {
  const StockHinge from(hinge());
  if (takeFrames(m_settings.frame_a, m_settings.frame_b, from.frame_a, from.frame_b, hinge_axis,
                 measured_axis, complaints))
    framesChanged();
  readLimit(from, complaints);
  takeMotor(m_settings.axis, &Axis::max_motor_impulse, from.motor, m_read_motor,
            {"motor target velocity", "max motor impulse"}, complaints);
  m_settings.angular_only = from.angular_only;
  Joint::setBlockRows(from.frame_offset);
  takeParameter(m_erp, from.erp, "ERP", complaints);
  takeParameter(m_motor_cfm, from.motor_cfm, "CFM", complaints);
  takeParameter(m_limit_erp, from.limit_erp, "STOP_ERP", complaints);
  takeParameter(m_limit_cfm, from.limit_cfm, "STOP_CFM", complaints);
}

void HingeModel::framesChanged() {
  // Another zero: the turns counted from the old one mean nothing.
  m_twist = {};
  m_turn_given = false;
  remember(observe(BodyPair(bodyA(), bodyB())), false);
}

void HingeModel::readLimit(const StockHinge& from, Complaints* complaints) {
  Axis& axis = m_settings.axis;
  takeNotNegative(axis.bias, from.bias, "bias factor", complaints);
  takeNotNegative(axis.relaxation, from.relaxation, "relaxation factor", complaints);
  if (from.limit == m_read_limit) return;
  const auto& [center, half_range] = from.limit;
  // Half a turn to either side is no limit, as in Bullet (Joint::setAngleLimit).
  const bool is_free = isNumber(half_range) && (half_range < 0 || half_range >= SIMD_PI - of_pi);
  if (!is_free && !(isFinite(half_range) && isFinite(center))) {
    if (complaints != nullptr)
      complaints->add("limit", isFinite(center) ? half_range : center, "must be a number");
    return;
  }
  m_read_limit = from.limit;
  m_own_limit = false;
  const Axis before = axis;
  axis.low = is_free ? Scalar(1) : center - half_range;
  axis.high = is_free ? Scalar(-1) : center + half_range;
  axis.is_any_angle = false;
  limitSet(before);
}

// --- limits that Bullet's object does not have ---------------------------------------------------

void HingeModel::keepLimit(Scalar low, Scalar high, bool of_any_turn) {
  Axis& axis = m_settings.axis;
  const Axis before = axis;
  if (of_any_turn)
    setAxisLimit(axis, low, high);
  else
    setAngleLimit(axis, low, high);
  const btHingeConstraint& stock = hinge();
  const bool shown = axis.is_any_angle || low > high || high - low < SIMD_2_PI - 2 * of_pi;
  hinge().setLimit(shown ? low : free_low, shown ? high : free_high, stock.getLimitSoftness(),
                   stock.getLimitBiasFactor(), stock.getLimitRelaxationFactor());
  m_read_limit = limitOf(stock);
  m_own_limit = true;
  limitSet(before);
}

// A limit of less than a turn holds in the turn that the joint is in.
void HingeModel::limitSet(const Axis& before) {
  limitChanged();
  if (m_turn_given) return;
  const BodyPair pair(bodyA(), bodyB());
  if (pair.finite()) remember(observe(pair), false);
  turnTowardsLimit(m_twist, m_sign, before, m_settings.axis);
}

// --- what a client reads from Bullet's object after a step ---------------------------------------

void HingeModel::showAngle(bool axes_are_apart) {
  // Near enough for Bullet's getter, which makes up for the rest if that is less than 0.3 rad. (Where a load has turned the axes apart, Bullet's angle is
  // another one.)
  if (m_accumulated != nullptr) {
    *m_accumulated = m_sign * m_twist.roughValue();
    if (axes_are_apart) {
      const Scalar within = hinge().getHingeAngle();
      *m_accumulated = within + SIMD_2_PI * std::round((angle() - within) / SIMD_2_PI);
    }
  }
  showLimitAt(m_twist, rows().axis(0).impulse[Axis::limit]);
}

// A load on a limit has broken it in Bullet; here it may be at it to the last bit.
void HingeModel::showLimitAt(const UnwrappedAngle& twist, Scalar last_impulse) {
  const Axis& axis = m_settings.axis;
  Scalar correction = 0;
  if (axis.limited() && axis.distance(m_sign * twist.roughValue()) < UnwrappedAngle::rough_error) {
    const Scalar angle = m_sign * twist.value();
    correction = btMax(axis.low - angle, btMin(axis.high - angle, Scalar(0)));
  }
  const Scalar sign = correction != 0 ? correction : last_impulse;
  showLimit(hinge(), sign > 0 ? Scalar(1) : Scalar(sign < 0 ? -1 : 0), correction);
}

void HingeModel::drawJoint(btIDebugDraw& drawer) const {
  const_cast<HingeModel*>(this)->readFromBullet();
  const btTransform a = bodyA().getCenterOfMassTransform() * m_settings.frame_a,
                    b = bodyB().getCenterOfMassTransform() * m_settings.frame_b;
  const btScalar size = hinge().getDbgDrawSize();
  drawFrames(drawer, a, b, size);
  const Axis& axis = m_settings.axis;
  if (drawsLimits(drawer) && !axis.locked())
    drawRange(drawer, b.getOrigin(), b.getBasis().getColumn(2), b.getBasis().getColumn(0), size,
              axis.low, axis.high);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
