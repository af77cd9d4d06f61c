#include <pintle/joints/quaternion_hinge.h>

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <cstdio>
#include <type_traits>

static_assert(std::is_same<btScalar, double>::value == bool(EXPECT_DOUBLE),
              "Pintle's target brings Bullet's precision along");

bool can_record(btDynamicsWorld& world);  // record.cpp
bool can_solve_exactly();                 // exact.cpp

// A motor turns a door for one second.
int main() {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);

  btBoxShape shape(btVector3(btScalar(0.5), btScalar(0.1), btScalar(0.1)));
  btVector3 inertia;
  shape.calculateLocalInertia(1, inertia);
  btRigidBody frame(0, nullptr, &shape);
  btRigidBody door(1, nullptr, &shape, inertia);
  door.setCenterOfMassTransform(btTransform(btQuaternion::getIdentity(), btVector3(1, 0, 0)));
  door.setActivationState(DISABLE_DEACTIVATION);
  world.addRigidBody(&frame);
  world.addRigidBody(&door);

  const btVector3 pivot(btScalar(0.5), 0, 0);
  const btVector3 axis(0, 1, 0);
  pintle::QuaternionHinge hinge(frame, door, pivot, -pivot, axis, axis);
  hinge.enableAngularMotor(true, 1, 100);
  world.addConstraint(&hinge, true);

  int warning;  // unused on purpose: Pintle's own warnings as errors must not reach this file
  for (int step = 0; step < 60; ++step) world.stepSimulation(btScalar(1) / 60, 0);
  const btScalar angle = hinge.getHingeAngle();
  const bool records = can_record(world);
  world.removeConstraint(&hinge);
  world.removeRigidBody(&door);
  world.removeRigidBody(&frame);

  std::printf("turned by %g rad\n", double(angle));
  return records && can_solve_exactly() && btFabs(angle) > btScalar(0.5) &&
                 btFabs(angle) < btScalar(1.5)
             ? 0
             : 1;
}
