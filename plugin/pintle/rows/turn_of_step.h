// Purpose: how far a step has turned the bodies, for angles that count their turns.
#pragma once

#include <pintle/body_pair.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The rotation vector by which Bullet turns a body of this velocity in a step. Above pi/4 it
/// bounds the angle of its quaternion but not the axis (btTransformUtil::integrateTransform).
inline Vec3 turnOfStep(const btVector3& w, Scalar dt) {
  const Scalar angle = w.length() * dt, bound = Scalar(pi / 4);
  if (angle <= bound) return dt * view(w);
  const Scalar turn = 2 * std::atan(angle * std::tan(bound / 2) / bound);
  return turn / angle * dt * view(w);
}

/// Whether the angle between two bodies moved the nearest way in a step. Two fast ones turn by up to
/// two half turns: then it is turnOfStep that tells. (A kinematic body goes where it is put.)
inline bool turnIsNearest(const btRigidBody& a, const btRigidBody& b, Scalar dt, Scalar speed) {
  return speed * dt < 1 || a.isStaticOrKinematicObject() || b.isStaticOrKinematicObject();
}

/// Of b against a, in the last step.
inline Vec3 turnOfStep(const btRigidBody& a, const btRigidBody& b, Scalar dt) {
  return turnOfStep(b.getInterpolationAngularVelocity(), dt) -
         turnOfStep(a.getInterpolationAngularVelocity(), dt);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
