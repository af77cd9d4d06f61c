// Purpose: what stands in a cone-twist joint of Bullet's and has no method there.
#pragma once

#include <pintle/precision.h>

class btConeTwistConstraint;
class btQuaternion;
class btTransform;

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Limits of a cone-twist joint, as they stand: a client may have written anything.
struct StockConeLimits {
  Scalar swing_1, swing_2, twist;     ///< rad: spans, to either side
  Scalar softness, bias, relaxation;  ///< factors
  Scalar fix_threshold;               ///< rad
};

///@{
/// The joint frames in the bodies' frames.
btTransform& frameA(btConeTwistConstraint& cone);
btTransform& frameB(btConeTwistConstraint& cone);
///@}

/// The state that btConeTwistConstraint::calcAngleInfo2 leaves for its getters: the size of the twist (rad), and which limits are broken.
void showAngles(btConeTwistConstraint& cone, Scalar twist, bool past_swing, bool past_twist);
/// None is.
void hideBroken(btConeTwistConstraint& cone);
/// The answer of getMotorTarget: of the joint frames, the rotation of a against b.
void showTarget(btConeTwistConstraint& cone, const btQuaternion& target);
/// Bullet leaves the motor's target and kind, and the state of its getters, as the memory was.
void clearSettings(btConeTwistConstraint& cone);
/// How many rows its getInfo1 counts, as its limits were last tested.
int countedRows(const btConeTwistConstraint& cone);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
