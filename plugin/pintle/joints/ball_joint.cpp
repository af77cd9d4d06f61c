#include <pintle/joints/ball_joint.h>

#include <pintle/body_pair.h>
#include <pintle/joints/drawing.h>
#include <pintle/rows/position_rows.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

BallJoint::BallJoint(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
                     const btVector3& pivotInB)
    : StandaloneJoint(rbA, rbB, row_count),
      m_pivot_a(point("pivotInA", pivotInA)),
      m_pivot_b(point("pivotInB", pivotInB)) {}

BallJoint::BallJoint(btRigidBody& rbA, const btVector3& pivotInA)
    : StandaloneJoint(rbA, row_count),
      m_pivot_a(point("pivotInA", pivotInA)),
      m_pivot_b(rbA.getCenterOfMassTransform()(pivotInA)) {}

BallJoint::BallJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                     const btTransform& frameInB)
    : StandaloneJoint(rbA, rbB, row_count),
      m_pivot_a(frame("frameInA", frameInA).getOrigin()),
      m_pivot_b(frame("frameInB", frameInB).getOrigin()) {}

BallJoint::BallJoint(btRigidBody& rbA, const btTransform& frameInA)
    : StandaloneJoint(rbA, row_count),
      m_pivot_a(frame("frameInA", frameInA).getOrigin()),
      m_pivot_b(rbA.getCenterOfMassTransform()(frameInA.getOrigin())) {}

void BallJoint::setParam(int num, btScalar value, int axis) {
  const char* const field = parameterName(num);
  finite(field, value);
  if (axis != -1) return;
  switch (num) {
    case BT_CONSTRAINT_ERP:
    case BT_CONSTRAINT_STOP_ERP: m_erp = notNegative(field, value); break;
    case BT_CONSTRAINT_CFM:
    case BT_CONSTRAINT_STOP_CFM: m_cfm = notNegative(field, value); break;
    default: break;
  }
}

btScalar BallJoint::getParam(int num, int axis) const {
  if (axis != -1) return infinity;
  switch (num) {
    case BT_CONSTRAINT_ERP:
    case BT_CONSTRAINT_STOP_ERP: return m_erp.orElse(0);
    case BT_CONSTRAINT_CFM:
    case BT_CONSTRAINT_STOP_CFM: return m_cfm.orElse(0);
    default: return infinity;
  }
}

void BallJoint::drawJoint(btIDebugDraw& drawer) const {
  const btMatrix3x3 upright = btMatrix3x3::getIdentity();
  // As Bullet: the first one in any mode.
  const auto draw = [&](const btVector3& pivot) {
    drawer.drawTransform(btTransform(upright, pivot), m_dbgDrawSize);
  };
  draw(m_rbA.getCenterOfMassTransform()(m_pivot_a));
  if (drawsFrames(drawer)) draw(m_rbB.getCenterOfMassTransform()(m_pivot_b));
}

PINTLE_FLATTEN void BallJoint::addRows(const PosePair& poses, Rows& rows) const {
  const Vec3 r_a = poses.R_a() * view(m_pivot_a), r_b = poses.R_b() * view(m_pivot_b);
  const equations::Anchors<Scalar> at{
      r_a, r_b, equations::position_error(poses.x_a(), r_a, poses.x_b(), r_b)};
  if (!PosePair::is_finite(at.d.sum())) return;
  if (getFormulation() == Formulation::document)
    addDocumentPositionRows(at, rows);
  else
    addConservingPositionRows(at, rows);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
