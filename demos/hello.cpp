// A motor turns a wheel two whole turns, onto the stop of its hinge.

#include <btBulletDynamicsCommon.h>
#include <pintle/joints/quaternion_hinge.h>

#include <cstdio>

int main() {
  btBoxShape box(btVector3(1, 1, 1));
  btRigidBody wheel(1, nullptr, &box, btVector3(1, 1, 1));
  pintle::QuaternionHinge hinge(wheel, btTransform::getIdentity());  // to the world, about z
  hinge.setLimit(-4 * SIMD_PI, 4 * SIMD_PI);                         // two turns either way
  hinge.enableAngularMotor(true, 5, 1);                              // 5 rad/s, 1 N m s a step

  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  world.addRigidBody(&wheel);
  world.addConstraint(&hinge);
  for (int i = 0; i < 300; ++i) world.stepSimulation(btScalar(1) / 60, 0);
  std::printf("%.1f degrees\n", hinge.getAccumulatedHingeAngle() * SIMD_DEGS_PER_RAD);
}
