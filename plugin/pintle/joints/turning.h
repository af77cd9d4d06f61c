// Purpose: how far one joint frame is turned against the other, and how a joint keeps count of the turns of
// an angle, step by step.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/equations/orientation_lock.h>
#include <pintle/equations/quaternion_hinge_limit.h>
#include <pintle/frame.h>
#include <pintle/rows/turn_of_step.h>
#include <pintle/rows/unwrapped_angle.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The rotation vector from a to b (rad, world).
inline Vec3 turnBetween(const Frame& a, const Frame& b) {
  return equations::orientation_error(a.crossed(b), a.trace(b),
                                      [&] { return Mat3(b.axes() * a.axes().transpose()); });
}

/// `angle` becomes the twist of b against a about the sum of the two bodies' axes. `speed`: of the
/// faster body, rad/s.
inline void followTwist(UnwrappedAngle& angle, const equations::Twist<Scalar>& twist,
                        const Vec3& axes_sum, const btRigidBody& a, const btRigidBody& b, Scalar dt,
                        Scalar speed) {
  // Its length is 1 + cos(swing). With the axes all but opposite there is no twist to be seen, and
  // the last one stands; nor in a frame that its owner has spoiled.
  if (!(twist.x * twist.x + twist.y * twist.y > Scalar(0.01))) return;
  if (turnIsNearest(a, b, dt, speed))
    angle.update(twist.x, twist.y);
  else
    angle.update(twist.x, twist.y, axes_sum.normalized().dot(turnOfStep(a, b, dt)));
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
