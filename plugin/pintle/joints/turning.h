// Purpose: how a joint keeps count of the turns of an angle, step by step.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/equations/quaternion_hinge_limit.h>
#include <pintle/rows/unwrapped_angle.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The rotation vector by which Bullet turns a body of this velocity in a step. Above pi/4 it bounds
/// the angle of its quaternion but not the axis (btTransformUtil::integrateTransform).
inline Vec3 turnOfStep(const btVector3& w, Scalar dt) {
  const Scalar angle = w.length() * dt, bound = Scalar(pi / 4);
  if (angle <= bound) return dt * view(w);
  const Scalar turn = 2 * std::atan(angle * std::tan(bound / 2) / bound);
  return turn / angle * dt * view(w);
}

/// `angle` becomes the twist of b against a about the sum of the two bodies' axes. `speed`: of the
/// faster body, rad/s.
inline void followTwist(UnwrappedAngle& angle, const equations::Twist<Scalar>& twist,
                        const Vec3& axes_sum, const btRigidBody& a, const btRigidBody& b, Scalar dt,
                        Scalar speed) {
  // Its length is 1 + cos(swing). With the axes all but opposite there is no twist to be seen, and
  // the last one stands; nor in a frame that its owner has spoiled.
  if (!(twist.x * twist.x + twist.y * twist.y > Scalar(0.01))) return;
  // Two fast bodies turn by up to two half turns a step: then not the nearest turn, but the one
  // that their motion leads to. (A kinematic body goes where it is put.)
  if (speed * dt < 1 || a.isStaticOrKinematicObject() || b.isStaticOrKinematicObject()) {
    angle.update(twist.x, twist.y);
    return;
  }
  const Vec3 turn = turnOfStep(b.getInterpolationAngularVelocity(), dt) -
                    turnOfStep(a.getInterpolationAngularVelocity(), dt);
  angle.update(twist.x, twist.y, axes_sum.normalized().dot(turn));
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
