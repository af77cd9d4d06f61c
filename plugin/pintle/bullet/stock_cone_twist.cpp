#include <pintle/bullet/stock_cone_twist.h>

#include <pintle/bullet/private_member.h>

#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>

namespace pintle {
namespace {

PINTLE_PRIVATE_MEMBER(ConeFrameA, btTransform, btConeTwistConstraint, m_rbAFrame);
PINTLE_PRIVATE_MEMBER(ConeFrameB, btTransform, btConeTwistConstraint, m_rbBFrame);
PINTLE_PRIVATE_MEMBER(ConeFixThreshold, btScalar, btConeTwistConstraint, m_fixThresh);
PINTLE_PRIVATE_MEMBER(ConeTwistAngle, btScalar, btConeTwistConstraint, m_twistAngle);
PINTLE_PRIVATE_MEMBER(ConeTwistSign, btScalar, btConeTwistConstraint, m_twistLimitSign);
PINTLE_PRIVATE_MEMBER(ConeSwingIsBroken, bool, btConeTwistConstraint, m_solveSwingLimit);
PINTLE_PRIVATE_MEMBER(ConeTwistIsBroken, bool, btConeTwistConstraint, m_solveTwistLimit);
PINTLE_PRIVATE_MEMBER(ConeMotorTarget, btQuaternion, btConeTwistConstraint, m_qTarget);
PINTLE_PRIVATE_MEMBER(ConeMotorIsNormalized, bool, btConeTwistConstraint,
                      m_bNormalizedMotorStrength);

}  // namespace

inline namespace PINTLE_PRECISION {

btTransform& frameA(btConeTwistConstraint& cone) { return cone.*pointer(ConeFrameA()); }
btTransform& frameB(btConeTwistConstraint& cone) { return cone.*pointer(ConeFrameB()); }

void showAngles(btConeTwistConstraint& cone, Scalar twist, bool past_swing, bool past_twist) {
  cone.*pointer(ConeTwistAngle()) = twist;
  cone.*pointer(ConeSwingIsBroken()) = past_swing;
  cone.*pointer(ConeTwistIsBroken()) = past_twist;
}

void hideBroken(btConeTwistConstraint& cone) {
  cone.*pointer(ConeSwingIsBroken()) = cone.*pointer(ConeTwistIsBroken()) = false;
}

void showTarget(btConeTwistConstraint& cone, const btQuaternion& target) {
  cone.*pointer(ConeMotorTarget()) = target;
}

void clearSettings(btConeTwistConstraint& cone) {
  showTarget(cone, btQuaternion::getIdentity());
  cone.*pointer(ConeMotorIsNormalized()) = false;
  cone.*pointer(ConeTwistSign()) = 0;
  showAngles(cone, 0, false, false);
}

int countedRows(const btConeTwistConstraint& cone) {
  const Scalar threshold = cone.*pointer(ConeFixThreshold());
  const bool is_hinge = cone.getSwingSpan1() < threshold && cone.getSwingSpan2() < threshold;
  // (In 2.85 getSolveSwingLimit answers for the twist.)
  const int swing = cone.*pointer(ConeSwingIsBroken()) ? 1 + int(is_hinge) : 0;
  return 3 + swing + int(cone.*pointer(ConeTwistIsBroken()));
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
