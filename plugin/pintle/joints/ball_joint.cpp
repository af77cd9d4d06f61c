#include <pintle/joints/ball_joint.h>

#include <pintle/body_pair.h>
#include <pintle/bullet/stock_ball.h>
#include <pintle/bullet/complaints.h>
#include <pintle/frame.h>
#include <pintle/joints/drawing.h>
#include <pintle/rows/position_rows.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

BallModel::BallModel(btPoint2PointConstraint& ball, RowCount max_rows)
    : DrivenJoint(ball, max_rows) {
  m_settings.pivot_a = m_settings.pivot_b = noPoint();
  BallModel::read(nullptr);
}

const btPoint2PointConstraint& BallModel::ball() const {
  return static_cast<const btPoint2PointConstraint&>(constraint());
}

void BallModel::read(Complaints* complaints) {
  const StockBall from(ball());
  takePoint(m_settings.pivot_a, ball().getPivotInA(), "pivotA", complaints);
  takePoint(m_settings.pivot_b, ball().getPivotInB(), "pivotB", complaints);
  const btConstraintSetting& setting = ball().m_setting;
  takeNotNegative(m_settings.impulse.damping, setting.m_damping, "damping", complaints);
  // As in Bullet: one that is not above zero is none.
  Scalar clamp = m_settings.impulse.max_impulse;
  if (isNumber(setting.m_impulseClamp))
    clamp = btMin(setting.m_impulseClamp, infinity);
  else
    takeFinite(clamp, setting.m_impulseClamp, "impulse clamp", complaints);
  m_settings.impulse.max_impulse = clamp > 0 ? clamp : infinity;
  takeParameter(m_erp, from.erp, "ERP", complaints);
  takeParameter(m_cfm, from.cfm, "CFM", complaints);
}

BallJoint::BallJoint(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
                     const btVector3& pivotInB)
    : JointOf(row_count, rbA, rbB, pivotInA, pivotInB) {
  clearParameters(*this);
}

BallJoint::BallJoint(btRigidBody& rbA, const btVector3& pivotInA)
    : JointOf(row_count, rbA, pivotInA) {
  clearParameters(*this);
}

BallJoint::BallJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                     const btTransform& frameInB)
    : BallJoint(rbA, rbB, frameInA.getOrigin(), frameInB.getOrigin()) {}

BallJoint::BallJoint(btRigidBody& rbA, const btTransform& frameInA)
    : BallJoint(rbA, frameInA.getOrigin()) {}

void BallModel::drawJoint(btIDebugDraw& drawer) const {
  const_cast<BallModel*>(this)->readFromBullet();
  const btScalar size = const_cast<btPoint2PointConstraint&>(ball()).getDbgDrawSize();
  const btMatrix3x3 upright = btMatrix3x3::getIdentity();
  // As Bullet: the first one in any mode.
  const auto draw = [&](const btVector3& pivot) {
    drawer.drawTransform(btTransform(upright, pivot), size);
  };
  draw(bodyA().getCenterOfMassTransform()(m_settings.pivot_a));
  if (drawsFrames(drawer)) draw(bodyB().getCenterOfMassTransform()(m_settings.pivot_b));
}

PINTLE_FLATTEN void BallModel::addRows(const PosePair& poses, Rows& rows) const {
  const Vec3 r_a = poses.R_a() * view(m_settings.pivot_a),
             r_b = poses.R_b() * view(m_settings.pivot_b);
  const equations::Anchors<Scalar> at{
      r_a, r_b, equations::position_error(poses.x_a(), r_a, poses.x_b(), r_b)};
  if (!PosePair::is_finite(at.d.sum())) return;
  if (getFormulation() == Formulation::document)
    addDocumentPositionRows(at, rows);
  else
    addConservingPositionRows(at, rows);
  if (hasPoseDrive()) addDrive(poses, rows);
}

void BallModel::prepare(const PosePair& poses, Rows& rows) {
  beginPoseDrive();
  addRows(poses, rows);
}

PINTLE_NOINLINE void BallModel::addDrive(const PosePair& poses, Rows& rows) const {
  const btTransform own = btTransform::getIdentity();
  addPoseDrive({poses.pose_a(), own}, {poses.pose_b(), own}, rows);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
