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

void FrameJoint::setParam(int num, btScalar value, int axis) {
  if (axis < -1 || axis > 5) reject("parameter axis", axis, "must be -1 or 0 to 5");
  switch (num) {
    case BT_CONSTRAINT_ERP: m_erp = notNegative("ERP", value); break;
    case BT_CONSTRAINT_CFM: m_cfm = notNegative("CFM", value); break;
    case BT_CONSTRAINT_STOP_ERP: m_limit_erp = notNegative("STOP_ERP", value); break;
    case BT_CONSTRAINT_STOP_CFM: m_limit_cfm = notNegative("STOP_CFM", value); break;
    default: reject("parameter", num, "no such parameter");
  }
}

btScalar FrameJoint::getParam(int num, int axis) const {
  if (axis < -1 || axis > 5) reject("parameter axis", axis, "must be -1 or 0 to 5");
  switch (num) {
    case BT_CONSTRAINT_ERP: return m_erp.orElse(0);
    case BT_CONSTRAINT_CFM: return m_cfm.orElse(0);
    case BT_CONSTRAINT_STOP_ERP: return m_limit_erp.orElse(0);
    case BT_CONSTRAINT_STOP_CFM: return m_limit_cfm.orElse(0);
    default: reject("parameter", num, "no such parameter");
  }
}

void FrameJoint::addPivotRows(const BodyPair& pair, const equations::Anchors<Scalar>& at,
                              Rows& rows) const {
  if (m_angular_only) return;
  if (getFormulation() == Formulation::document)
    addDocumentPositionRows(at.r_a, at.r_b, at.d, rows);
  else
    addConservingPositionRows(pair, at.r_a, at.r_b, at.d, gapInLever(), rows);
}

void FrameJoint::drawJoint(btIDebugDraw& drawer) const {
  if (!drawsFrames(drawer)) return;
  drawer.drawTransform(getCalculatedTransformA(), m_dbgDrawSize);
  drawer.drawTransform(getCalculatedTransformB(), m_dbgDrawSize);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
