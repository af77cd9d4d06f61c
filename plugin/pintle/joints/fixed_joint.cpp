#include <pintle/joints/fixed_joint.h>

#include <pintle/body_pair.h>
#include <pintle/equations/orientation_lock.h>
#include <pintle/equations/position.h>
#include <pintle/frame.h>
#include <pintle/joints/drawing.h>
#include <pintle/joints/turning.h>
#include <pintle/rows/row.h>

#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

FixedJoint::FixedJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                       const btTransform& frameInB)
    : PosedJoint(rbA, rbB, row_count) {
  setFrames(frameInA, frameInB);
}

FixedJoint::FixedJoint(btRigidBody& rbA, const btTransform& frameInA) : PosedJoint(rbA, row_count) {
  setFrames(frameInA, coincident(frameInA));
}

void FixedJoint::setParam(int num, btScalar value, int axis) {
  const char* const field = parameterName(num);
  finite(field, value);
  if (axis < 0 || axis > 5) return;
  switch (num) {
    case BT_CONSTRAINT_STOP_ERP: m_erp = notNegative(field, value); break;
    case BT_CONSTRAINT_STOP_CFM: m_cfm = notNegative(field, value); break;
    case BT_CONSTRAINT_ERP: m_motor_parameters[axis].erp = value; break;
    case BT_CONSTRAINT_CFM: m_motor_parameters[axis].cfm = value; break;
    default: break;
  }
}

btScalar FixedJoint::getParam(int num, int axis) const {
  if (axis < 0 || axis > 5) return 0;
  switch (num) {
    case BT_CONSTRAINT_STOP_ERP: return m_erp.orElse(btScalar(0.2f));
    case BT_CONSTRAINT_STOP_CFM: return m_cfm.orElse(0);
    case BT_CONSTRAINT_ERP: return m_motor_parameters[axis].erp;
    case BT_CONSTRAINT_CFM: return m_motor_parameters[axis].cfm;
    default: return 0;
  }
}

void FixedJoint::setLimit(int axis, btScalar lo, btScalar hi) {
  if (axis < 0 || axis > 5) reject("axis", axis, "must be 0 to 5");
  held("lower limit", lo);
  held("upper limit", hi);
}

void FixedJoint::setLinearLowerLimit(const btVector3& linearLower) {
  held("linear lower limit", linearLower);
}

void FixedJoint::setLinearUpperLimit(const btVector3& linearUpper) {
  held("linear upper limit", linearUpper);
}

void FixedJoint::setAngularLowerLimit(const btVector3& angularLower) {
  held("angular lower limit", angularLower);
}

void FixedJoint::setAngularUpperLimit(const btVector3& angularUpper) {
  held("angular upper limit", angularUpper);
}

// --- readings ------------------------------------------------------------------------------------

btScalar FixedJoint::getRelativePivotPosition(int axis_index) const {
  return getCalculatedTransformA().invXform(getCalculatedTransformB().getOrigin())[axis_index];
}

btScalar FixedJoint::getAngle(int axis_index) const {
  const btMatrix3x3 A = getCalculatedTransformA().getBasis();
  btVector3 angles;
  btGeneric6DofSpring2Constraint::matrixToEulerXYZ(
      A.transposeTimes(getCalculatedTransformB().getBasis()), angles);
  return angles[axis_index];
}

btVector3 FixedJoint::getAxis(int axis_index) const {
  // As Bullet has them: y normal to z of a and x of b, and the others across it.
  const btVector3 x_b = getCalculatedTransformB().getBasis().getColumn(0);
  const btVector3 z_a = getCalculatedTransformA().getBasis().getColumn(2), y = z_a.cross(x_b);
  const btVector3 axis = axis_index == 0 ? y.cross(z_a) : axis_index == 1 ? y : x_b.cross(y);
  const btScalar length = axis.length();
  // Half-way round y, x of b is along z of a: any axis is as good.
  return length > SIMD_EPSILON ? axis / length
                               : getCalculatedTransformA().getBasis().getColumn(axis_index);
}

void FixedJoint::drawJoint(btIDebugDraw& drawer) const {
  FrameJoint::drawJoint(drawer);
  if (!drawsLimits(drawer)) return;
  const btTransform a = getCalculatedTransformA(), b = getCalculatedTransformB();
  drawPatch(drawer, a, b, m_dbgDrawSize, 0, 0, 0, 0);
}

// --- rows ----------------------------------------------------------------------------------------

PINTLE_FLATTEN void FixedJoint::addRows(const PosePair& poses, Rows& rows) const {
  const Frame a(poses.pose_a(), m_frame_a), b(poses.pose_b(), m_frame_b);
  const Vec3 d = equations::position_error(poses.x_a(), a.r(), poses.x_b(), b.r());
  // Also a frame that its owner has spoiled: the trace is made of all axes.
  if (!PosePair::is_finite(d.sum() + a.trace(b))) return;
  if (getFormulation() == Formulation::document)
    addDocumentRows(a, b, rows);
  else
    addConditionedRows(a, b, rows);
  addPivotRows({a.r(), b.r(), d}, rows);
}

inline void FixedJoint::addConditionedRows(const Frame& a, const Frame& b, Rows& rows) const {
  const Vec3 phi = turnBetween(a, b);
  const Vec3 curvature = rows.curvature([](const BodyPair& v) {
    return Vec3(equations::orientation_curvature<Scalar>(v.w_a(), v.w_b()));
  });
  const Scalar angle = std::sqrt(phi.dot(phi));
  const Scalar speed_per_error = angle > 0 ? getMaxCorrectionSpeed() / angle : Scalar(0);
  for (int i = 0; i < 3; ++i)
    rows.addAngular(Vec3::Unit(i), phi[i], curvature[i]).max_speed =
        speed_per_error * std::abs(phi[i]);
}

void FixedJoint::addDocumentRows(const Frame& a, const Frame& b, Rows& rows) const {
  const Mat3 F_a = a.axes(), F_b = b.axes();
  const auto p = equations::relative(equations::quaternion(F_a), equations::quaternion(F_b));
  const Scalar sine = std::sqrt(p.v.dot(p.v));
  // Along the error the row turns 2/|w| times as fast as it says.
  const Scalar speed_per_error =
      sine > 0 ? getMaxCorrectionSpeed() * std::abs(p.w) / (2 * sine) : Scalar(0);
  for (int i = 0; i < 3; ++i) {
    const auto row = equations::quaternion_row<Scalar>(p, F_a, Vec3::Unit(i));
    rows.addAngular(row.J_b, row.C).max_speed = speed_per_error * std::abs(row.C);
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
