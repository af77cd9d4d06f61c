#include <pintle/joints/quaternion_hinge.h>

#include <pintle/equations/quaternion_hinge.h>
#include <pintle/joints/hinge_rows.h>
#include <pintle/rows/position_rows.h>
#include <pintle/rows/swing_rows.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

void QuaternionHingeModel::limitChanged() {
  const auto half_sine = [](Scalar limit) {
    if (!BodyPair::is_finite(limit)) return limit;
    const Scalar turns = std::round(limit / SIMD_2_PI);
    return equations::half_sine(limit - turns * SIMD_2_PI, turns);
  };
  m_half_sine_axis = m_settings.axis;
  m_half_sine_axis.drive = Axis::Drive::off;
  m_half_sine_axis.max_friction = 0;
  m_half_sine_axis.low = half_sine(m_settings.axis.low);
  m_half_sine_axis.high = half_sine(m_settings.axis.high);
}

inline void QuaternionHingeModel::constrain(const Observation& seen, Rows& rows) const {
  const auto swing = equations::swing(seen.c_a, seen.c_b);
  const Acting now = acting(seen, swing, rows);
  if (getFormulation() == Formulation::document) {
    const bool half_sine = now.limit && !m_settings.axis.driven();
    addDocumentRows(seen, half_sine, rows);
    if (half_sine) return;
  } else {
    addSwingRows(swing, getMaxCorrectionSpeed(), rows);
    if (!m_settings.angular_only) addConservingPositionRows(seen.anchors(), rows);
  }
  addAxisRow(now, swing, rows);
}

void QuaternionHingeModel::addDocumentRows(const Observation& seen, bool limit, Rows& rows) const {
  const Mat3 F = seen.a.axes();
  const auto p =
      equations::relative(equations::quaternion(F), equations::quaternion(seen.b.axes()));
  if (!PosePair::is_finite(p.w + p.v.sum())) return;
  const Scalar across = std::hypot(p.v.x(), p.v.y());
  // Along the error the row turns 2/|w| times as fast as it says.
  const Scalar speed_per_error =
      across > 0 ? getMaxCorrectionSpeed() * std::abs(p.w) / (2 * across) : Scalar(0);
  for (int i = 0; i < 2; ++i) {
    const auto row = equations::quaternion_hinge_row<Scalar>(p, F, Vec3::Unit(i));
    rows.addAngular(row.J_b, row.C).max_speed = speed_per_error * std::abs(row.C);
  }
  if (!m_settings.angular_only) addDocumentPositionRows(seen.anchors(), rows);
  if (!limit) return;
  const auto row = equations::quaternion_hinge_limit_row<Scalar>(
      p, F, Vec3::Unit(2), followed(m_twist, seen.twist).turns());
  rows.addAngularAxis(0, row.J_b, m_sign * row.C, m_half_sine_axis, true, m_sign > 0 ? 1 : -1);
}

template class ObservedJoint<QuaternionHingeModel, HingeModel>;
template class HingeOf<QuaternionHinge, QuaternionHingeModel>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
