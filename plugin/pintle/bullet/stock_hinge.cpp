#include <pintle/bullet/stock_hinge.h>

#include <pintle/bullet/private_member.h>

#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>

namespace pintle {
namespace {

PINTLE_PRIVATE_MEMBER(HingeLimit, btAngularLimit, btHingeConstraint, m_limit);
PINTLE_PRIVATE_MEMBER(HingeCenter, btScalar, btAngularLimit, m_center);
PINTLE_PRIVATE_MEMBER(HingeIsBroken, bool, btAngularLimit, m_solveLimit);
PINTLE_PRIVATE_MEMBER(HingeSide, btScalar, btAngularLimit, m_sign);
PINTLE_PRIVATE_MEMBER(HingeCorrection, btScalar, btAngularLimit, m_correction);
PINTLE_PRIVATE_MEMBER(HingeMotorOn, bool, btHingeConstraint, m_enableAngularMotor);
PINTLE_PRIVATE_MEMBER(HingeMotorVelocity, btScalar, btHingeConstraint, m_motorTargetVelocity);
PINTLE_PRIVATE_MEMBER(HingeMaxMotorImpulse, btScalar, btHingeConstraint, m_maxMotorImpulse);
PINTLE_PRIVATE_MEMBER(HingeReferenceSign, btScalar, btHingeConstraint, m_referenceSign);
PINTLE_PRIVATE_MEMBER(HingeAngularOnly, bool, btHingeConstraint, m_angularOnly);
PINTLE_PRIVATE_MEMBER(HingeFrameOffset, bool, btHingeConstraint, m_useOffsetForConstraintFrame);
PINTLE_PRIVATE_MEMBER(HingeFlags, int, btHingeConstraint, m_flags);
PINTLE_PRIVATE_MEMBER(HingeNormalErp, btScalar, btHingeConstraint, m_normalERP);
PINTLE_PRIVATE_MEMBER(HingeNormalCfm, btScalar, btHingeConstraint, m_normalCFM);
PINTLE_PRIVATE_MEMBER(HingeStopErp, btScalar, btHingeConstraint, m_stopERP);
PINTLE_PRIVATE_MEMBER(HingeStopCfm, btScalar, btHingeConstraint, m_stopCFM);
PINTLE_PRIVATE_MEMBER(HingeAccumulatedAngle, btScalar, btHingeAccumulatedAngleConstraint,
                      m_accumulatedAngle);

}  // namespace

inline namespace PINTLE_PRECISION {

StockLimit limitOf(const btHingeConstraint& hinge) {
  const btAngularLimit& limit = hinge.*pointer(HingeLimit());
  return {limit.*pointer(HingeCenter()), limit.getHalfRange()};
}

StockHinge::StockHinge(const btHingeConstraint& hinge)
    : frame_a(hinge.getAFrame()),
      frame_b(hinge.getBFrame()),
      limit(limitOf(hinge)),
      bias(hinge.getLimitBiasFactor()),
      relaxation(hinge.getLimitRelaxationFactor()),
      motor{hinge.*pointer(HingeMotorOn()), hinge.*pointer(HingeMotorVelocity()),
            hinge.*pointer(HingeMaxMotorImpulse())},
      angular_only(hinge.*pointer(HingeAngularOnly())),
      frame_offset(hinge.*pointer(HingeFrameOffset())) {
  const int flags = hinge.*pointer(HingeFlags());
  if (flags == 0) return;
  if (flags & BT_HINGE_FLAGS_ERP_NORM) erp = {true, hinge.*pointer(HingeNormalErp())};
  if (flags & BT_HINGE_FLAGS_CFM_NORM) motor_cfm = {true, hinge.*pointer(HingeNormalCfm())};
  if (flags & BT_HINGE_FLAGS_ERP_STOP) limit_erp = {true, hinge.*pointer(HingeStopErp())};
  if (flags & BT_HINGE_FLAGS_CFM_STOP) limit_cfm = {true, hinge.*pointer(HingeStopCfm())};
}

Scalar referenceSign(const btHingeConstraint& hinge) {
  return hinge.*pointer(HingeReferenceSign());
}
btScalar motorVelocity(const btHingeConstraint& hinge) {
  return hinge.*pointer(HingeMotorVelocity());
}
bool isAngularOnly(const btHingeConstraint& hinge) { return hinge.*pointer(HingeAngularOnly()); }

void showLimit(btHingeConstraint& hinge, Scalar sign, Scalar correction) {
  btAngularLimit& limit = hinge.*pointer(HingeLimit());
  limit.*pointer(HingeIsBroken()) = sign != 0;
  limit.*pointer(HingeSide()) = sign;
  limit.*pointer(HingeCorrection()) = correction;
}

int writtenRows(const btHingeConstraint& hinge) {
  const bool is_broken = (hinge.*pointer(HingeLimit())).*pointer(HingeIsBroken());
  return is_broken || hinge.*pointer(HingeMotorOn()) ? 6 : 5;
}

void clearSettings(btHingeConstraint& hinge) {
  hinge.*pointer(HingeMotorVelocity()) = hinge.*pointer(HingeMaxMotorImpulse()) = 0;
  hinge.*pointer(HingeNormalErp()) = hinge.*pointer(HingeNormalCfm()) = 0;
  hinge.*pointer(HingeStopErp()) = hinge.*pointer(HingeStopCfm()) = 0;
}

btScalar& accumulatedAngle(btHingeAccumulatedAngleConstraint& hinge) {
  return hinge.*pointer(HingeAccumulatedAngle());
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
