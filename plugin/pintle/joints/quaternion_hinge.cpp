#include <pintle/joints/quaternion_hinge.h>

#include <pintle/equations/quaternion_hinge.h>
#include <pintle/joints/hinge_rows.h>
#include <pintle/rows/position_rows.h>
#include <pintle/rows/swing_rows.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

QuaternionHinge::QuaternionHinge(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
                                 const btVector3& pivotInB, const btVector3& axisInA,
                                 const btVector3& axisInB, bool useReferenceFrameA)
    : HingeBase(rbA, rbB, row_count, useReferenceFrameA) {
  begin(pivotInA, pivotInB, axisInA, axisInB);
}

QuaternionHinge::QuaternionHinge(btRigidBody& rbA, const btVector3& pivotInA,
                                 const btVector3& axisInA, bool useReferenceFrameA)
    : HingeBase(rbA, row_count, useReferenceFrameA) {
  begin(pivotInA, axisInA);
}

QuaternionHinge::QuaternionHinge(btRigidBody& rbA, btRigidBody& rbB, const btTransform& rbAFrame,
                                 const btTransform& rbBFrame, bool useReferenceFrameA)
    : HingeBase(rbA, rbB, row_count, useReferenceFrameA) {
  begin(rbAFrame, rbBFrame);
}

QuaternionHinge::QuaternionHinge(btRigidBody& rbA, const btTransform& rbAFrame,
                                 bool useReferenceFrameA)
    : HingeBase(rbA, row_count, useReferenceFrameA) {
  begin(rbAFrame);
}

void QuaternionHinge::limitChanged() {
  const auto half_sine = [](Scalar limit) {
    if (!BodyPair::is_finite(limit)) return limit;
    const Scalar turns = std::round(limit / SIMD_2_PI);
    return equations::half_sine(limit - turns * SIMD_2_PI, turns);
  };
  m_half_sine_axis = m_axis;
  m_half_sine_axis.drive = Axis::Drive::off;
  m_half_sine_axis.max_friction = 0;
  m_half_sine_axis.low = half_sine(m_axis.low);
  m_half_sine_axis.high = half_sine(m_axis.high);
}

PINTLE_FLATTEN void QuaternionHinge::prepare(const BodyPair& pair, Rows& rows) {
  const Frames at = look(pair, m_twist);
  m_tested = m_twist;
  addRows(pair, at, m_twist, rows);
}

void QuaternionHinge::addRows(const BodyPair& pair, Rows& rows) const {
  UnwrappedAngle twist = m_twist;
  const Frames at = lookIfActing(pair, twist);
  addRows(pair, at, twist, rows);
}

inline void QuaternionHinge::addRows(const BodyPair& pair, const Frames& at,
                                     const UnwrappedAngle& twist, Rows& rows) const {
  const equations::Anchors<Scalar> anchors{
      at.a.r(), at.b.r(), equations::position_error(pair.x_a(), at.a.r(), pair.x_b(), at.b.r())};
  const auto swing = equations::swing(at.c_a, at.c_b);
  // Also a frame that its owner has spoiled.
  if (!BodyPair::is_finite(anchors.d.sum() + swing.sigma.sum())) return;
  const Acting now = acting(pair, twist, swing);
  if (getFormulation() == Formulation::document) {
    const bool half_sine = now.limit && !m_axis.driven();
    addDocumentRows(pair, anchors, half_sine ? &twist : nullptr, rows);
    if (half_sine) return;
  } else {
    addConditionedRows(pair, anchors, swing, rows);
  }
  addAxisRow(now, swing, rows);
}

inline void QuaternionHinge::addConditionedRows(const BodyPair& pair,
                                                const equations::Anchors<Scalar>& at,
                                                const equations::Swing<Scalar>& swing,
                                                Rows& rows) const {
  addSwingRows(pair, swing, getMaxCorrectionSpeed(), rows);
  if (!m_angular_only)
    addConservingPositionRows(pair, at.r_a, at.r_b, at.d,
                              gapInLever(at.r_a.dot(at.r_a), at.d.dot(at.d)), rows);
}

void QuaternionHinge::addDocumentRows(const BodyPair& pair, const equations::Anchors<Scalar>& at,
                                      const UnwrappedAngle* limit, Rows& rows) const {
  const Mat3 F = pair.R_a() * view(m_frame_a.getBasis());
  const Mat3 F_b = pair.R_b() * view(m_frame_b.getBasis());
  const auto p = equations::relative(equations::quaternion(F), equations::quaternion(F_b));
  if (!BodyPair::is_finite(p.w + p.v.sum())) return;
  const Scalar across = std::hypot(p.v.x(), p.v.y());
  // Along the error the row turns 2/|w| times as fast as it says.
  const Scalar speed_per_error =
      across > 0 ? getMaxCorrectionSpeed() * std::abs(p.w) / (2 * across) : Scalar(0);
  for (int i = 0; i < 2; ++i) {
    const auto row = equations::quaternion_hinge_row<Scalar>(p, F, Vec3::Unit(i));
    rows.addAngular(row.J_b, row.C).max_speed = speed_per_error * std::abs(row.C);
  }
  if (!m_angular_only) addDocumentPositionRows(at.r_a, at.r_b, at.d, rows);
  if (limit) {
    const auto row =
        equations::quaternion_hinge_limit_row<Scalar>(p, F, Vec3::Unit(2), limit->turns());
    rows.addAngularAxis(0, row.J_b, m_sign * row.C, m_half_sine_axis, true, m_sign > 0 ? 1 : -1);
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
