// Purpose: what stands in the 6-dof joints of Bullet's, in one form for all of their classes, and what a step leaves there.
#pragma once

#include <pintle/bullet/stock_parameter.h>
#include <pintle/precision.h>

class btGeneric6DofConstraint;
class btGeneric6DofSpringConstraint;
class btGeneric6DofSpring2Constraint;

namespace pintle {
class StockBits;

inline namespace PINTLE_PRECISION {

/// Settings of one axis, as they stand: a client may have written anything. Units are those of the coordinate: m or rad.
struct StockAxis {
  Scalar low = 1, high = -1;  ///< equal: locked; low > high: free
  Scalar bounce = 0;
  bool motor = false, servo = false, spring = false;
  Scalar velocity = 0;   ///< of the coordinate; of a servo its size counts
  Scalar max_force = 0;  ///< N or N m; N s or N m s before Bullet 2.89
  Scalar servo_target = 0;
  Scalar stiffness = 0, damping = 0, rest = 0;
  StockParameter limit_erp, limit_cfm, motor_erp, motor_cfm;
};

///@{
/// Fields that have the same name in the limit motors of both kinds of Bullet's. Linear motors move b the other way there.
template <class LinearMotor>
void readLinearMotor(const LinearMotor& from, int i, StockAxis& to) {
  to.low = from.m_lowerLimit[i];
  to.high = from.m_upperLimit[i];
  to.motor = from.m_enableMotor[i];
  to.velocity = -from.m_targetVelocity[i];
  to.max_force = from.m_maxMotorForce[i];
  to.limit_erp.value = from.m_stopERP[i];
  to.limit_cfm.value = from.m_stopCFM[i];
}
template <class AngularMotor>
void readAngularMotor(const AngularMotor& from, StockAxis& to) {
  to.low = from.m_loLimit;
  to.high = from.m_hiLimit;
  to.bounce = from.m_bounce;
  to.motor = from.m_enableMotor;
  to.velocity = from.m_targetVelocity;
  to.max_force = from.m_maxMotorForce;
  to.limit_erp.value = from.m_stopERP;
  to.limit_cfm.value = from.m_stopCFM;
}
///@}

/// Settings of a joint.
struct StockSixDof {
  StockAxis axes[6];         ///< along x, y, z of frame a, and the Euler angles of a against b
  int order[3] = {0, 1, 2};  ///< first, middle and last axis of these angles
  bool damping_is_fraction = false;  ///< 0 to 1, 1 is none
  bool frame_offset = true;
};

///@{
/// Takes over what stands there.
void readAxes(btGeneric6DofConstraint& from, StockSixDof& to);
void readAxes(btGeneric6DofSpring2Constraint& from, StockSixDof& to);
/// In the place of the motors that stand there: enableSpring turns a motor on, which is the spring.
void readSprings(const btGeneric6DofSpringConstraint& from, StockSixDof& to);
///@}

///@{
/// Leaves what getInfo1 of Bullet's does: frames, angles, and how the limits are.
void showPoses(btGeneric6DofConstraint& joint);
void showPoses(btGeneric6DofSpring2Constraint& joint);
/// How many rows its getInfo2 would write, as the limits were last tested.
int countedRows(btGeneric6DofConstraint& joint);
int countedRows(btGeneric6DofSpring2Constraint& joint);
/// No limit is tested.
void hideBroken(btGeneric6DofConstraint& joint);
void hideBroken(btGeneric6DofSpring2Constraint& joint);
///@}

///@{
/// Looks at all settings but for the frames. Returns whether a bit has changed.
bool lookAtAxes(StockBits& bits, btGeneric6DofConstraint& joint,
                const btGeneric6DofSpringConstraint* springs);
bool lookAtAxes(StockBits& bits, btGeneric6DofSpring2Constraint& joint);
///@}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
