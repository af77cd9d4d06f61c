#include <pintle/joints/dot_hinge.h>

#include <pintle/equations/dot.h>
#include <pintle/equations/dot_hinge.h>
#include <pintle/equations/position.h>
#include <pintle/joints/hinge_rows.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

DotHinge::DotHinge(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
                   const btVector3& pivotInB, const btVector3& axisInA, const btVector3& axisInB,
                   bool useReferenceFrameA)
    : HingeBase(rbA, rbB, row_count, useReferenceFrameA) {
  begin(pivotInA, pivotInB, axisInA, axisInB);
}

DotHinge::DotHinge(btRigidBody& rbA, const btVector3& pivotInA, const btVector3& axisInA,
                   bool useReferenceFrameA)
    : HingeBase(rbA, row_count, useReferenceFrameA) {
  begin(pivotInA, axisInA);
}

DotHinge::DotHinge(btRigidBody& rbA, btRigidBody& rbB, const btTransform& rbAFrame,
                   const btTransform& rbBFrame, bool useReferenceFrameA)
    : HingeBase(rbA, rbB, row_count, useReferenceFrameA) {
  begin(rbAFrame, rbBFrame);
}

DotHinge::DotHinge(btRigidBody& rbA, const btTransform& rbAFrame, bool useReferenceFrameA)
    : HingeBase(rbA, row_count, useReferenceFrameA) {
  begin(rbAFrame);
}

PINTLE_FLATTEN void DotHinge::prepare(const BodyPair& pair, Rows& rows) {
  const Frames at = look(pair, m_twist);
  m_tested = m_twist;
  addRows(pair, at, m_twist, rows);
}

void DotHinge::addRows(const BodyPair& pair, Rows& rows) const {
  UnwrappedAngle twist = m_twist;
  const Frames at = lookIfActing(pair, twist);
  addRows(pair, at, twist, rows);
}

inline void DotHinge::addRows(const BodyPair& pair, const Frames& at, const UnwrappedAngle& twist,
                              Rows& rows) const {
  const Vec3 d = equations::position_error(pair.x_a(), at.a.r(), pair.x_b(), at.b.r());
  const Vec3 &c_a = at.c_a, &c_b = at.c_b, x = cross(c_a, c_b);
  // Also a frame that its owner has spoiled.
  if (!BodyPair::is_finite(d.sum() + at.b.a().sum() + at.b.b().sum() + x.sum())) return;

  // Along the error the rows turn 1/cos(swing) times as fast as they say.
  const Scalar sine = std::sqrt(x.dot(x));
  const Scalar speed_per_error =
      sine > 0 ? getMaxCorrectionSpeed() * std::abs(c_a.dot(c_b)) / sine : Scalar(0);
  const Vec3 acceleration = equations::dot_acceleration<Scalar>(c_a, pair.w_a(), pair.w_b());
  for (const Vec3& tangent : {at.b.a(), at.b.b()}) {
    const auto row = equations::dot_hinge_row(c_a, tangent);
    rows.addAngular(row.J_b, row.C, tangent.dot(acceleration)).max_speed =
        speed_per_error * std::abs(row.C);
  }
  addPivotRows(pair, {at.a.r(), at.b.r(), d}, rows);
  if (!m_axis.driven() && !m_axis.limited()) return;
  const auto swing = equations::swing(c_a, c_b);
  addAxisRow(acting(pair, twist, swing), swing, rows);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
