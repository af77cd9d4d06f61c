#include <pintle/joints/hinge_2_joint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

Hinge2Joint::Hinge2Joint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                         const btTransform& frameInB)
    : Hinge2Joint(
          rbA, rbB,
          Axes{rbA.getCenterOfMassTransform() * frameInA.getOrigin(),
               rbA.getCenterOfMassTransform().getBasis() * frameInA.getBasis().getColumn(2),
               rbA.getCenterOfMassTransform().getBasis() * frameInA.getBasis().getColumn(0)}) {
  setFrames(frameInA, frameInB);
  setEquilibriumPoint();
  readFromBullet();
}

Hinge2Joint::Hinge2Joint(btRigidBody& rbB, const btTransform& frameInB)
    : Hinge2Joint(getFixedBody(), rbB, rbB.getCenterOfMassTransform() * frameInB, frameInB) {}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
