// J: of a body, in double whatever btScalar is; and N: what weighs on it, of which books of energy are kept.
#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace support {

constexpr double gravity = 9.81;  ///< m/s^2, along -z

/// N: as far as its factor lets it fall. It must move.
inline double weightOf(const btRigidBody& body) {
  return gravity / double(body.getInvMass()) * double(body.getLinearFactor().z());
}

/// With the inertia that it has when it is turned to `basis`. 0: of one that does not move.
inline double kineticEnergy(const btRigidBody& body, const btMatrix3x3& basis) {
  if (!(body.getInvMass() > 0)) return 0;
  double sum = double(body.getLinearVelocity().length2()) / double(body.getInvMass()) / 2;
  const btVector3 w = basis.transpose() * body.getAngularVelocity();
  for (int i = 0; i < 3; ++i)
    if (const double inverse = double(body.getInvInertiaDiagLocal()[i]); inverse > 0)
      sum += double(w[i] * w[i]) / inverse / 2;
  return sum;
}

}  // namespace support
