// Purpose: a body of Bullet's solver in the midst of a step: its velocity, and the pose to which that leads.
#pragma once

#include <pintle/vectors.h>

#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <LinearMath/btTransformUtil.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// m/s and rad/s: with the step's forces, and the impulses so far.
inline btVector3 linearVelocity(const btSolverBody& body) {
  return body.m_linearVelocity + body.m_externalForceImpulse + body.m_deltaLinearVelocity;
}
inline btVector3 angularVelocity(const btSolverBody& body) {
  return body.m_angularVelocity + body.m_externalTorqueImpulse + body.m_deltaAngularVelocity;
}

/// The pose after a step of length dt from `start`, integrated by Bullet itself: a limit under a heavy load shows a
/// difference in the last digit.
inline void endOfStep(const btTransform& start, const btSolverBody& body, Scalar dt,
                      btTransform& end) {
  btTransformUtil::integrateTransform(start, linearVelocity(body), angularVelocity(body), dt, end);
}

/// The chain rule from a row of the pose at the end of the step to a row of the velocity. A small turn t of the end
/// changes C by A.t; a change dw of the velocity changes it by dt times the result.dw. The end turns by the left
/// Jacobian of phi times the change of phi, phi the rotation vector of the step. So A is multiplied by its transpose:
///   1 - (1 - cos phi) / phi [n]x + (1 - sin phi / phi) [n]x [n]x,  n the axis
/// Up to Bullet's ANGULAR_MOTION_THRESHOLD phi is w dt. Beyond it tan(phi/2) is proportional to w.
inline Eigen::Vector3d byVelocity(const btSolverBody& body, Scalar dt, const Eigen::Vector3d& A) {
  const btVector3 w = angularVelocity(body);
  const Eigen::Vector3d asked =
      double(dt) * Eigen::Vector3d(double(w[0]), double(w[1]), double(w[2]));
  const double length = asked.norm(), max_turn = double(ANGULAR_MOTION_THRESHOLD);
  if (!(length > 1e-6)) return A;
  const double slope = std::tan(max_turn / 2) / max_turn, tangent = slope * length;
  const double phi = length > max_turn ? 2 * std::atan(tangent) : length;
  const Eigen::Vector3d n = asked / length, once = cross(n, A), twice = cross(n, once);
  const Eigen::Vector3d B =
      A - (1 - std::cos(phi)) / phi * once + (1 - std::sin(phi) / phi) * twice;
  if (!(length > max_turn)) return B;
  const Eigen::Vector3d along = n.dot(B) * n;
  return phi / length * (B - along) + 2 * slope / (1 + tangent * tangent) * along;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
