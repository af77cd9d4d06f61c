// Purpose: how far one joint frame is turned against the other, and how a joint keeps count of the turns of
// an angle, step by step.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/equations/orientation_lock.h>
#include <pintle/equations/quaternion_hinge_limit.h>
#include <pintle/frame.h>
#include <pintle/rows/axis_settings.h>
#include <pintle/rows/turn_of_step.h>
#include <pintle/rows/unwrapped_angle.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The rotation vector from a to b (rad, world).
inline Vec3 turnBetween(const Frame& a, const Frame& b) {
  return equations::orientation_error(a.crossed(b), a.trace(b),
                                      [&] { return Mat3(b.axes() * a.axes().transpose()); });
}

/// Whether there is a twist to be seen. Its length is 1 + cos(swing): with the axes all but opposite the last one
/// stands, and in a frame that its owner has spoiled.
inline bool isSeen(const equations::Twist<Scalar>& twist) {
  return twist.x * twist.x + twist.y * twist.y > Scalar(0.01);
}

/// What `angle` is at another pose, where the twist is this one: the nearest turn.
inline UnwrappedAngle followed(const UnwrappedAngle& angle, const equations::Twist<Scalar>& twist) {
  // As it mostly is: the step has taken it over.
  if (angle.isAt(twist.x, twist.y) || !isSeen(twist)) return angle;
  UnwrappedAngle there = angle;
  there.update(twist.x, twist.y);
  return there;
}

/// A limit of less than a turn that is set anew holds in the turn that the joint is in, or nearest to it. The coordinate is `sign` times
/// `angle`.
inline void turnTowardsLimit(UnwrappedAngle& angle, Scalar sign, const Axis& before,
                             const Axis& now) {
  const bool is_another = now.low != before.low || now.high != before.high;
  if (is_another && now.limited() && now.high - now.low < SIMD_2_PI)
    angle.turnTowards(sign * (now.low + now.high) / 2);
}

/// `angle` becomes the twist of b against a about the sum of the two bodies' axes, where a step has brought them.
/// `speed`: of the faster body, rad/s.
inline void followStep(UnwrappedAngle& angle, const equations::Twist<Scalar>& twist,
                       const Vec3& axis_a, const Vec3& axis_b, const btRigidBody& a,
                       const btRigidBody& b, Scalar dt, Scalar speed) {
  if (!isSeen(twist)) return;
  if (turnIsNearest(a, b, dt, speed))
    angle.update(twist.x, twist.y);
  else
    angle.update(twist.x, twist.y, (axis_a + axis_b).normalized().dot(turnOfStep(a, b, dt)));
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
