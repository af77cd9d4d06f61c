#include <pintle/joints/frame_joint.h>

#include <pintle/joints/drawing.h>
#include <pintle/rows/position_rows.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

void FrameJoint::setFrames(const btTransform& frameInA, const btTransform& frameInB) {
  frame("frameInA", frameInA);
  m_frame_b = frame("frameInB", frameInB);
  m_frame_a = frameInA;
  framesChanged();
}

void FrameJoint::held(const char* field, Scalar limit) const {
  if (finite(field, limit) != 0) reject(field, limit, "must be 0: the axis is held");
}

void FrameJoint::held(const char* field, const btVector3& limits) const {
  for (int i = 0; i < 3; ++i) held(field, limits[i]);
}

void FrameJoint::setParam(int num, btScalar value, int axis) {
  const char* const field = parameterName(num);
  finite(field, value);
  if (axis < -1 || axis > 5) return;
  switch (num) {
    case BT_CONSTRAINT_ERP: m_erp = notNegative(field, value); break;
    case BT_CONSTRAINT_CFM: m_cfm = notNegative(field, value); break;
    case BT_CONSTRAINT_STOP_ERP: m_limit_erp = notNegative(field, value); break;
    case BT_CONSTRAINT_STOP_CFM: m_limit_cfm = notNegative(field, value); break;
    default: break;
  }
}

btScalar FrameJoint::getParam(int num, int axis) const {
  if (axis < -1 || axis > 5) return 0;
  switch (num) {
    case BT_CONSTRAINT_ERP: return m_erp.orElse(0);
    case BT_CONSTRAINT_CFM: return m_cfm.orElse(0);
    case BT_CONSTRAINT_STOP_ERP: return m_limit_erp.orElse(0);
    case BT_CONSTRAINT_STOP_CFM: return m_limit_cfm.orElse(0);
    default: return 0;
  }
}

void FrameJoint::addPivotRows(const equations::Anchors<Scalar>& at, Rows& rows) const {
  if (m_angular_only) return;
  if (getFormulation() == Formulation::document)
    addDocumentPositionRows(at, rows);
  else
    addConservingPositionRows(at, rows);
}

void FrameJoint::drawJoint(btIDebugDraw& drawer) const {
  drawFrames(drawer, getCalculatedTransformA(), getCalculatedTransformB(), m_dbgDrawSize);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
