// J: of a body, in double whatever btScalar is.
#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace support {

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
