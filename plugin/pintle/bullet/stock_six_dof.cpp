#include <pintle/bullet/stock_six_dof.h>

#include <pintle/bullet/private_member.h>
#include <pintle/bullet/stock_bits.h>

#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpringConstraint.h>

namespace pintle {
namespace {

using SixBools = bool[6];
using SixNumbers = btScalar[6];
PINTLE_PRIVATE_MEMBER(SixDofSpringIsOn, SixBools, btGeneric6DofSpringConstraint, m_springEnabled);
PINTLE_PRIVATE_MEMBER(SixDofSpringRest, SixNumbers, btGeneric6DofSpringConstraint,
                      m_equilibriumPoint);
PINTLE_PRIVATE_MEMBER(SixDofSpringStiffness, SixNumbers, btGeneric6DofSpringConstraint,
                      m_springStiffness);
PINTLE_PRIVATE_MEMBER(SixDofSpringDamping, SixNumbers, btGeneric6DofSpringConstraint,
                      m_springDamping);

}  // namespace

inline namespace PINTLE_PRECISION {

void readAxes(btGeneric6DofConstraint& from, StockSixDof& to) {
  const btTranslationalLimitMotor& linear = *from.getTranslationalLimitMotor();
  const int all_flags = from.btGeneric6DofConstraint::getFlags();
  for (int i = 0; i < 6; ++i) {
    StockAxis& axis = to.axes[i];
    const int flags = all_flags >> (i * BT_6DOF_FLAGS_AXIS_SHIFT);
    axis.limit_erp.is_set = (flags & BT_6DOF_FLAGS_ERP_STOP) != 0;
    axis.limit_cfm.is_set = (flags & BT_6DOF_FLAGS_CFM_STOP) != 0;
    axis.motor_cfm.is_set = (flags & BT_6DOF_FLAGS_CFM_NORM) != 0;
    if (i < 3) {
      readLinearMotor(linear, i, axis);
      axis.motor_cfm.value = linear.m_normalCFM[i];
      continue;
    }
    const btRotationalLimitMotor& angular = *from.getRotationalLimitMotor(i - 3);
    readAngularMotor(angular, axis);
    axis.motor_cfm.value = angular.m_normalCFM;
  }
  to.frame_offset = from.getUseFrameOffset();
}

void readSprings(const btGeneric6DofSpringConstraint& from, StockSixDof& to) {
  to.damping_is_fraction = true;
  for (int i = 0; i < 6; ++i) {
    StockAxis& axis = to.axes[i];
    axis.spring = false;
    if (!(from.*pointer(SixDofSpringIsOn()))[i]) continue;
    axis.spring = axis.motor;
    axis.motor = false;
    axis.stiffness = (from.*pointer(SixDofSpringStiffness()))[i];
    axis.damping = (from.*pointer(SixDofSpringDamping()))[i];
    axis.rest = (from.*pointer(SixDofSpringRest()))[i];
  }
}

void showPoses(btGeneric6DofConstraint& joint) {
  joint.calculateTransforms();
  for (int i = 0; i < 3; ++i) joint.testAngularLimitMotor(i);
}

int countedRows(btGeneric6DofConstraint& joint) {
  int count = 0;
  for (int i = 0; i < 3; ++i)
    count += int(joint.getTranslationalLimitMotor()->needApplyForce(i)) +
             int(joint.getRotationalLimitMotor(i)->needApplyTorques());
  return count;
}

void hideBroken(btGeneric6DofConstraint& joint) {
  for (int i = 0; i < 3; ++i) {
    joint.getTranslationalLimitMotor()->m_currentLimit[i] = 0;
    joint.getRotationalLimitMotor(i)->m_currentLimit = 0;
  }
}

// (What a step writes comes last in each object of Bullet's.)
bool lookAtAxes(StockBits& bits, btGeneric6DofConstraint& joint,
                const btGeneric6DofSpringConstraint* springs) {
  const btTranslationalLimitMotor& linear = *joint.getTranslationalLimitMotor();
  bits.lookBetween(linear.m_lowerLimit, linear.m_currentLimitError);
  for (int i = 0; i < 3; ++i) {
    const btRotationalLimitMotor& angular = *joint.getRotationalLimitMotor(i);
    bits.lookBetween(angular.m_loLimit, angular.m_currentLimitError);
  }
  const int switches =
      joint.btGeneric6DofConstraint::getFlags() * 2 + int(joint.getUseFrameOffset());
  bits.look(&switches, sizeof switches);
  if (springs != nullptr) {
    bits.look(springs->*pointer(SixDofSpringIsOn()), sizeof(SixBools));
    bits.look(springs->*pointer(SixDofSpringRest()), sizeof(SixNumbers));
    bits.look(springs->*pointer(SixDofSpringStiffness()), sizeof(SixNumbers));
    bits.look(springs->*pointer(SixDofSpringDamping()), sizeof(SixNumbers));
  }
  return bits.end();
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
