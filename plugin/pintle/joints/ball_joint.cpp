#include <pintle/joints/ball_joint.h>

#include <pintle/body_pair.h>
#include <pintle/equations/position.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

BallJoint::BallJoint(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
                     const btVector3& pivotInB)
    : Joint(rbA, rbB, m_row_memory),
      m_pivot_a(point("pivotInA", pivotInA)),
      m_pivot_b(point("pivotInB", pivotInB)) {}

BallJoint::BallJoint(btRigidBody& rbA, const btVector3& pivotInA)
    : Joint(rbA, m_row_memory),
      m_pivot_a(point("pivotInA", pivotInA)),
      m_pivot_b(rbA.getCenterOfMassTransform()(pivotInA)) {}

BallJoint::BallJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                     const btTransform& frameInB)
    : Joint(rbA, rbB, m_row_memory),
      m_pivot_a(frame("frameInA", frameInA).getOrigin()),
      m_pivot_b(frame("frameInB", frameInB).getOrigin()) {}

BallJoint::BallJoint(btRigidBody& rbA, const btTransform& frameInA)
    : Joint(rbA, m_row_memory),
      m_pivot_a(frame("frameInA", frameInA).getOrigin()),
      m_pivot_b(rbA.getCenterOfMassTransform()(frameInA.getOrigin())) {}

void BallJoint::setParam(int num, btScalar value, int axis) {
  if (axis != -1) reject("parameter axis", axis, "a ball joint has none (-1)");
  switch (num) {
    case BT_CONSTRAINT_ERP:
    case BT_CONSTRAINT_STOP_ERP: m_erp = {notNegative("ERP", value), true}; break;
    case BT_CONSTRAINT_CFM:
    case BT_CONSTRAINT_STOP_CFM: m_cfm = {notNegative("CFM", value), true}; break;
    default: reject("parameter", num, "no such parameter");
  }
}

btScalar BallJoint::getParam(int num, int axis) const {
  if (axis != -1) reject("parameter axis", axis, "a ball joint has none (-1)");
  switch (num) {
    case BT_CONSTRAINT_ERP:
    case BT_CONSTRAINT_STOP_ERP: return m_erp.value;
    case BT_CONSTRAINT_CFM:
    case BT_CONSTRAINT_STOP_CFM: return m_cfm.value;
    default: reject("parameter", num, "no such parameter");
  }
}

void BallJoint::addRows(const BodyPair& pair, Rows& rows) const {
  const Vec3 r_a = pair.R_a() * view(m_pivot_a), r_b = pair.R_b() * view(m_pivot_b);
  const Vec3 d = equations::position_error(pair.x_a(), r_a, pair.x_b(), r_b);
  if (!BodyPair::is_finite(d.sum())) return;
  const bool document = getFormulation() == Formulation::document;
  const Vec3 curvature =
      equations::position_curvature<Scalar>(pair.w_a(), r_a + d, pair.w_b(), r_b);
  for (int i = 0; i < 3; ++i) {
    const Vec3 u = Vec3::Unit(i);
    const auto J = document ? equations::position_row(u, r_a, r_b)
                            : equations::position_row_conserving(u, r_a, d, r_b);
    Row& row = rows.addEquality(J.L, J.A_a, J.A_b, d[i]);
    if (!document) row.curvature = curvature[i];
    if (m_setting.m_impulseClamp > 0) row.max_impulse = m_setting.m_impulseClamp;
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
