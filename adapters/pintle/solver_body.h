// Purpose: a body of Bullet's solver in the midst of a step: its velocity, and the pose to which that leads.
#pragma once

#include <pintle/precision.h>

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

}  // namespace PINTLE_PRECISION
}  // namespace pintle
