// The second one of Bullet's 6-dof joints with springs, which shares nothing with the first.
#include <pintle/bullet/private_member.h>
#include <pintle/bullet/stock_bits.h>
#include <pintle/bullet/stock_six_dof.h>

#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>

namespace pintle {
namespace {

PINTLE_PRIVATE_MEMBER(SpringTwoFlags, int, btGeneric6DofSpring2Constraint, m_flags);
PINTLE_PRIVATE_MEMBER(SpringTwoOrder, RotateOrder, btGeneric6DofSpring2Constraint, m_rotateOrder);

// First, middle and last axis, as Bullet names them.
constexpr int spring_2_orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                       {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};

}  // namespace

inline namespace PINTLE_PRECISION {

// (Its servos move a, as angular ones do.)
void readAxes(btGeneric6DofSpring2Constraint& from, StockSixDof& to) {
  const btTranslationalLimitMotor2& linear = *from.getTranslationalLimitMotor();
  const int all_flags = from.*pointer(SpringTwoFlags());
  for (int i = 0; i < 6; ++i) {
    StockAxis& axis = to.axes[i];
    const int flags = all_flags >> (i * BT_6DOF_FLAGS_AXIS_SHIFT2);
    axis.limit_erp.is_set = (flags & BT_6DOF_FLAGS_ERP_STOP2) != 0;
    axis.limit_cfm.is_set = (flags & BT_6DOF_FLAGS_CFM_STOP2) != 0;
    axis.motor_erp.is_set = (flags & BT_6DOF_FLAGS_ERP_MOTO2) != 0;
    axis.motor_cfm.is_set = (flags & BT_6DOF_FLAGS_CFM_MOTO2) != 0;
    if (i < 3) {
      readLinearMotor(linear, i, axis);
      axis.bounce = linear.m_bounce[i];
      axis.servo = linear.m_servoMotor[i];
      axis.spring = linear.m_enableSpring[i];
      axis.servo_target = linear.m_servoTarget[i];
      axis.stiffness = linear.m_springStiffness[i];
      axis.damping = linear.m_springDamping[i];
      axis.rest = linear.m_equilibriumPoint[i];
      axis.motor_erp.value = linear.m_motorERP[i];
      axis.motor_cfm.value = linear.m_motorCFM[i];
      continue;
    }
    const btRotationalLimitMotor2& angular = *from.getRotationalLimitMotor(i - 3);
    readAngularMotor(angular, axis);
    axis.servo = angular.m_servoMotor;
    axis.spring = angular.m_enableSpring;
    axis.servo_target = angular.m_servoTarget;
    axis.stiffness = angular.m_springStiffness;
    axis.damping = angular.m_springDamping;
    axis.rest = angular.m_equilibriumPoint;
    axis.motor_erp.value = angular.m_motorERP;
    axis.motor_cfm.value = angular.m_motorCFM;
  }
  const int order = from.*pointer(SpringTwoOrder());
  for (int i = 0; i < 3; ++i) to.order[i] = spring_2_orders[order >= 0 && order < 6 ? order : 0][i];
}

void showPoses(btGeneric6DofSpring2Constraint& joint) {
  joint.calculateTransforms();
  for (int i = 0; i < 3; ++i) {
    btRotationalLimitMotor2& angular = *joint.getRotationalLimitMotor(i);
    angular.m_currentPosition =
        btAdjustAngleToLimits(joint.getAngle(i), angular.m_loLimit, angular.m_hiLimit);
    angular.testLimitValue(angular.m_currentPosition);
  }
}

int countedRows(btGeneric6DofSpring2Constraint& joint) {
  const auto limitRows = [](int state) { return state == 4 ? 2 : int(state != 0); };
  const btTranslationalLimitMotor2& linear = *joint.getTranslationalLimitMotor();
  int count = 0;
  for (int i = 0; i < 3; ++i) {
    const btRotationalLimitMotor2& angular = *joint.getRotationalLimitMotor(i);
    count += limitRows(linear.m_currentLimit[i]) + limitRows(angular.m_currentLimit);
    count += int(linear.m_enableMotor[i]) + int(linear.m_enableSpring[i]) +
             int(angular.m_enableMotor) + int(angular.m_enableSpring);
  }
  return count;
}

void hideBroken(btGeneric6DofSpring2Constraint& joint) {
  for (int i = 0; i < 3; ++i) {
    joint.getTranslationalLimitMotor()->m_currentLimit[i] = 0;
    joint.getRotationalLimitMotor(i)->m_currentLimit = 0;
  }
}

bool lookAtAxes(StockBits& bits, btGeneric6DofSpring2Constraint& joint) {
  const btTranslationalLimitMotor2& linear = *joint.getTranslationalLimitMotor();
  bits.lookBetween(linear.m_lowerLimit, linear.m_currentLimitError);
  for (int i = 0; i < 3; ++i) {
    const btRotationalLimitMotor2& angular = *joint.getRotationalLimitMotor(i);
    bits.lookBetween(angular.m_loLimit, angular.m_currentLimitError);
  }
  bits.look(&(joint.*pointer(SpringTwoFlags())), sizeof(int));
  bits.look(&(joint.*pointer(SpringTwoOrder())), sizeof(RotateOrder));
  return bits.end();
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
