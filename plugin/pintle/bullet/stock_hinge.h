// Purpose: what stands in a hinge of Bullet's.
#pragma once

#include <pintle/bullet/stock_motor.h>
#include <pintle/bullet/stock_parameter.h>
#include <pintle/precision.h>

class btHingeAccumulatedAngleConstraint;
class btHingeConstraint;
class btTransform;

namespace pintle {
inline namespace PINTLE_PRECISION {

/// An interval of the hinge angle as btAngularLimit keeps it, rad: half_range < 0, or from pi on, is no limit, 0 a locked hinge.
struct StockLimit {
  Scalar center, half_range;
  bool operator==(const StockLimit& to) const {
    return isSame(center, to.center) && isSame(half_range, to.half_range);
  }
};

/// Settings of a hinge, as they stand: a client may have written anything.
struct StockHinge {
  const btTransform &frame_a, &frame_b;
  StockLimit limit;
  Scalar bias, relaxation;
  StockMotor motor;
  StockParameter erp, motor_cfm, limit_erp, limit_cfm;
  bool angular_only, frame_offset;

  explicit StockHinge(const btHingeConstraint& hinge);
};

StockLimit limitOf(const btHingeConstraint& hinge);
/// +1 or -1: Bullet's angle is this times that of a against b. It does not change with setUseReferenceFrameA.
Scalar referenceSign(const btHingeConstraint& hinge);
btScalar motorVelocity(const btHingeConstraint& hinge);
bool isAngularOnly(const btHingeConstraint& hinge);

/// The state that btHingeConstraint::testLimit leaves for getSolveLimit and getLimitSign: on which side the limit is broken, +1 low, -1 high,
/// 0 not; and by how much (rad, towards the inside).
void showLimit(btHingeConstraint& hinge, Scalar sign, Scalar correction);
/// Bullet leaves the motor's numbers, and in some versions the parameters that are not set, as the memory was.
void clearSettings(btHingeConstraint& hinge);
/// How many rows its getInfo2 writes, as its limit was last tested.
int writtenRows(const btHingeConstraint& hinge);
/// Where the class keeps its accumulated angle.
btScalar& accumulatedAngle(btHingeAccumulatedAngleConstraint& hinge);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
