#include <pintle/joints/cone_twist_model.h>

#include <pintle/body_pair.h>
#include <pintle/bullet/complaints.h>
#include <pintle/bullet/frames.h>
#include <pintle/equations/cone_twist.h>

#include <limits>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Semiaxes (rad) that the ellipse is computed with. A strip is an ellipse as long as that.
constexpr Scalar min_span = Scalar(1e-4), max_span = Scalar(1e6);
// Axes of the joint frames: x, and y, from which Bullet draws the twist.
constexpr int twist_axis_of_frame = 0, drawn_axis = 1;

// Bullet's defaults.
constexpr StockConeLimits free_limits{
    Scalar(BT_LARGE_FLOAT), Scalar(BT_LARGE_FLOAT), Scalar(BT_LARGE_FLOAT), 1, Scalar(0.3f), 1,
    Scalar(0.05f)};

Scalar bounded(Scalar span) {
  return btMax(Scalar(-BT_LARGE_FLOAT), btMin(span, Scalar(BT_LARGE_FLOAT)));
}
AngleRange bounded(const AngleRange& range) { return {bounded(range.low), bounded(range.high)}; }
AngleRange rangeOf(Scalar span) { return bounded(AngleRange{-span, span}); }

// Free is low > high: as it was set, or where nothing is left to be held.
void setRange(Axis& axis, Scalar low, Scalar high) {
  const bool held = low <= high && high - low < Scalar(2 * pi);
  axis.low = held ? low : Scalar(1);
  axis.high = held ? high : Scalar(-1);
}

StockConeLimits coneLimits(btConeTwistConstraint& cone) {
  return {cone.getSwingSpan1(),    cone.getSwingSpan2(), cone.getTwistSpan(),
          cone.getLimitSoftness(), cone.getBiasFactor(), cone.getRelaxationFactor(),
          cone.getFixThresh()};
}

// Takes a span over if it is another one than the last.
void takeSpan(AngleRange& range, Scalar& last, Scalar from, const char* field,
              Complaints* complaints) {
  if (isSame(from, last)) return;
  if (!isNumber(from)) {
    if (complaints != nullptr) complaints->add(field, from, "must be a number");
    return;
  }
  last = from;
  range = rangeOf(from);
}

bool areFinite(const btQuaternion& q) {
  return isFinite(q.x()) && isFinite(q.y()) && isFinite(q.z()) && isFinite(q.w());
}

Quaternion<Scalar> fromBullet(const btQuaternion& q) { return {q.w(), Vec3(q.x(), q.y(), q.z())}; }
btQuaternion toBullet(const Quaternion<Scalar>& q) { return {q.v.x(), q.v.y(), q.v.z(), q.w}; }

}  // namespace

ConeTwistModel::ConeTwistModel(btConeTwistConstraint& cone, RowCount max_rows)
    : ObservedJoint(cone, max_rows), m_read(free_limits) {
  m_settings.swing_1 = rangeOf(m_read.swing_1);
  m_settings.swing_2 = rangeOf(m_read.swing_2);
  m_settings.twist = rangeOf(m_read.twist);
  m_settings.swing_limit.relaxation = m_settings.twist_limit.relaxation = 0;  // no rebound
  // Until there are frames the joint holds nothing.
  m_settings.frame_a.setOrigin(noPoint());
  m_settings.frame_a.getBasis().setIdentity();
  m_settings.frame_b = m_settings.frame_a;
  limitsChanged();
  ConeTwistModel::read(nullptr);
}

ConeTwistModel::~ConeTwistModel() = default;

const char* ConeTwistModel::name() const { return "ConeTwistJoint"; }

// --- what stands in Bullet's object --------------------------------------------------------------

void ConeTwistModel::read(Complaints* complaints) {
  btConeTwistConstraint& from = cone();
  if (takeFrames(m_settings.frame_a, m_settings.frame_b, from.getAFrame(), from.getBFrame(),
                 twist_axis_of_frame, drawn_axis, complaints))
    m_seen = false;
  const StockConeLimits now = coneLimits(from);
  if (!isSame(now, m_read)) readLimits(now, complaints);
  m_settings.angular_only = from.getAngularOnly();
  readParameters(complaints);
  if (from.isMotorEnabled())
    readMotor(complaints);
  else if (m_rotation)
    m_rotation->axis.enable(false);
}

void ConeTwistModel::readLimits(const StockConeLimits& from, Complaints* complaints) {
  StockConeLimits now = m_read;
  takeSpan(m_settings.swing_1, now.swing_1, from.swing_1, "swing span 1", complaints);
  takeSpan(m_settings.swing_2, now.swing_2, from.swing_2, "swing span 2", complaints);
  takeSpan(m_settings.twist, now.twist, from.twist, "twist span", complaints);
  takeNotNegative(now.softness, from.softness, "softness", complaints);
  takeNotNegative(now.bias, from.bias, "bias factor", complaints);
  takeFinite(now.relaxation, from.relaxation, "relaxation factor", complaints);
  takeFinite(now.fix_threshold, from.fix_threshold, "fix threshold", complaints);
  if (isSame(now, m_read)) return;
  m_read = now;
  limitsChanged();
}

inline void ConeTwistModel::readParameters(Complaints* complaints) {
  const btConeTwistConstraint& from = cone();
  const int flags = from.getFlags();
  if (flags == 0) {
    m_erp = m_cfm = m_limit_cfm = m_motor_cfm = {};
    return;
  }
  const auto take = [&](Parameter& to, int flag, int num, int axis) {
    const bool is_set = (flags & flag) != 0;
    const Scalar value = is_set ? from.btConeTwistConstraint::getParam(num, axis) : Scalar(0);
    takeParameter(to, {is_set, value}, parameterName(num), complaints);
  };
  take(m_erp, BT_CONETWIST_FLAGS_LIN_ERP, BT_CONSTRAINT_ERP, 0);
  take(m_cfm, BT_CONETWIST_FLAGS_LIN_CFM, BT_CONSTRAINT_CFM, 0);
  take(m_limit_cfm, BT_CONETWIST_FLAGS_ANG_CFM, BT_CONSTRAINT_STOP_CFM, 3);
  m_motor_cfm = m_limit_cfm;
}

// (Of a motor that is off Bullet does not initialise all numbers.)
void ConeTwistModel::readMotor(Complaints* complaints) {
  const btConeTwistConstraint& from = cone();
  Axis& axis = rotation().axis;
  const Scalar most = from.getMaxMotorImpulse();
  if (isNumber(most)) {
    axis.max_motor_impulse = most < 0 ? infinity : btMin(most, infinity);
    axis.normalized_motor = from.isMaxMotorImpulseNormalized();
  } else if (complaints != nullptr) {
    complaints->add("max motor impulse", most, "must be a number");
  }
  readTarget(complaints);
  axis.enable(true);
}

// Another target than the last one comes before a velocity.
void ConeTwistModel::readTarget(Complaints* complaints) {
  const btQuaternion& from = cone().getMotorTarget();
  if (isSame(from, m_rotation->target)) return;
  if (!areFinite(from)) {
    if (complaints != nullptr) complaints->add("motor target", "must be finite, and have a length");
    return;
  }
  m_rotation->target = from;
  m_rotation->reachable_target = limited(from, m_read.softness);
  m_rotation->axis.chosen = Axis::Drive::pose;
}

// Bullet's own keeps half of the digits of an angle. A bad one is none: the last good one stays.
void ConeTwistModel::setTarget(const btQuaternion& q) {
  readFromBullet();
  const Scalar length = q.length();
  const bool is_good = areFinite(q) && isFinite(length) && length > SIMD_EPSILON;
  constexpr Scalar none = std::numeric_limits<Scalar>::quiet_NaN();
  showTarget(cone(), is_good ? limited(q / length, 1) : btQuaternion(none, none, none, none));
  if (!m_rotation || !is_good) return;
  readTarget(nullptr);
  m_rotation->axis.choose(Axis::Drive::pose);
}

void ConeTwistModel::setVelocity(const btVector3& velocity) {
  rotation().velocity = velocity;
  readTarget(nullptr);
  m_rotation->axis.choose(Axis::Drive::rate);
}

// Memory for motor and friction is taken when one of them is first set.
ConeTwistModel::Rotation& ConeTwistModel::rotation() {
  if (!m_rotation) {
    setRowCount(driven_row_count);
    m_rotation = std::make_unique<Rotation>();
    m_rotation->axis.chosen = Axis::Drive::pose;
    m_rotation->axis.max_motor_impulse = infinity;
    limitsChanged();
  }
  return *m_rotation;
}

// --- limits --------------------------------------------------------------------------------------

void ConeTwistModel::keepSwings(const AngleRange& swing_1, const AngleRange& swing_2) {
  m_settings.swing_1 = bounded(swing_1);
  m_settings.swing_2 = bounded(swing_2);
  cone().setLimit(5, m_read.swing_1 = m_settings.swing_1.span());
  cone().setLimit(4, m_read.swing_2 = m_settings.swing_2.span());
  limitsChanged();
}

void ConeTwistModel::keepTwist(const AngleRange& twist) {
  m_settings.twist = twist;
  cone().setLimit(3, m_read.twist = twist.span());
  limitsChanged();
}

void ConeTwistModel::spansWritten(int first, int last) {
  readFromBullet();
  AngleRange* const ranges[] = {&m_settings.twist, &m_settings.swing_2, &m_settings.swing_1};
  for (int i = first; i <= last; ++i) {
    const Scalar span = cone().getLimit(i);
    if (isNumber(span)) *ranges[i - 3] = rangeOf(span);
  }
  limitsChanged();
}

equations::SwingSpans<Scalar> ConeTwistModel::spans(Scalar softness) const {
  const auto semiaxis = [softness](Scalar side) {
    return btMax(min_span, btMin(softness * side, max_span));
  };
  return {semiaxis(m_settings.swing_1.high), semiaxis(-m_settings.swing_1.low),
          semiaxis(m_settings.swing_2.high), semiaxis(-m_settings.swing_2.low)};
}

// The smallest side of the cone.
Scalar ConeTwistModel::innerSpan() const {
  const auto e = spans(m_read.softness);
  return btMin(btMin(e.above_1, e.below_1), btMin(e.above_2, e.below_2));
}

// The settings as a step uses them, so that it need not ask.
void ConeTwistModel::limitsChanged() {
  Axis &swing = m_settings.swing_limit, &twist = m_settings.twist_limit;
  m_limit_erp = m_read.bias;
  // Bullet's rows, scaled by the square of the relaxation, are none at 0.
  const bool off = m_read.relaxation == 0;
  const Scalar bias = m_read.bias, divisor = m_read.relaxation * m_read.relaxation;
  const Scalar gain = bias < divisor ? bias / divisor : Scalar(1);
  swing.bias = twist.bias = bias > 0 ? gain / bias : Scalar(0);

  const bool locked_1 = m_settings.swing_1.span() < m_read.fix_threshold;
  const bool locked_2 = m_settings.swing_2.span() < m_read.fix_threshold;
  setRange(swing, 1, -1);
  m_circular = false;
  m_cone_look = {};
  if (locked_1 && locked_2) {
    m_swings = Swings::locked;
  } else if (locked_1) {
    m_swings = Swings::only_2;
    if (!off) setRange(swing, m_settings.swing_2.low, m_settings.swing_2.high);
  } else if (locked_2) {
    m_swings = Swings::only_1;
    if (!off) setRange(swing, m_settings.swing_1.low, m_settings.swing_1.high);
  } else {
    m_swings = Swings::cone;
    const auto e = spans(m_read.softness);
    const Scalar inner = innerSpan();
    m_circular = btMax(btMax(e.above_1, e.below_1), btMax(e.above_2, e.below_2)) == inner;
    if (!off && inner < Scalar(pi)) {
      swing.low = -infinity;
      swing.high = 0;
      m_cone_look = CosineLimit(inner);
    }
  }
  const Scalar low = m_read.softness * m_settings.twist.low,
               high = m_read.softness * m_settings.twist.high;
  setRange(twist, off ? Scalar(1) : low, off ? Scalar(-1) : high);
  if (twist.limited()) m_twist_look = {twist.low, twist.high};
  if (m_rotation) {
    m_rotation->axis.motor_gain = gain;
    m_rotation->reachable_target = limited(m_rotation->target, m_read.softness);
  }
}

// Along a swing in the direction (about_1, about_2), not 0, the angle at which the cone ends.
Scalar ConeTwistModel::swingRadius(Scalar about_1, Scalar about_2, Scalar softness) const {
  const auto e = spans(softness);
  const Scalar e_1 = about_1 < 0 ? e.below_1 : e.above_1, e_2 = about_2 < 0 ? e.below_2 : e.above_2;
  return std::hypot(about_1, about_2) / std::hypot(about_1 / e_1, about_2 / e_2);
}

// The rotation without what is beyond the limits of its swing, straight towards none, and of its
// twist.
btQuaternion ConeTwistModel::limited(const btQuaternion& q, Scalar softness) const {
  const Vec3 x = Vec3::Unit(0);
  const auto parts = equations::swing_twist(fromBullet(q), x);
  Vec3 swing = equations::rotation_vector(parts.swing);
  Scalar twist = equations::rotation_vector(parts.twist).x();
  if (m_settings.twist_limit.limited()) {
    twist = inTurnOf(m_settings.twist_limit, twist);
    twist = btMax(softness * m_settings.twist.low, btMin(twist, softness * m_settings.twist.high));
  }
  if (m_swings == Swings::cone) {
    const Scalar angle = swing.norm();
    const Scalar radius = m_settings.swing_limit.limited() && angle > 0
                              ? swingRadius(swing.z(), swing.y(), softness)
                              : angle;
    if (angle > radius) swing *= radius / angle;
  } else {
    // As a sees it, which has turned by the twist.
    const auto as_a = equations::rotation<Scalar>(x, -twist);
    swing = equations::rotate(as_a, swing);
    const auto only = [this](Scalar angle) {
      return m_settings.swing_limit.limited()
                 ? btMax(m_settings.swing_limit.low, btMin(angle, m_settings.swing_limit.high))
                 : angle;
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

}  // namespace PINTLE_PRECISION
}  // namespace pintle
