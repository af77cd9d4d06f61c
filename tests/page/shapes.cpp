// Records what the gallery's scenes have not: a hull, a mesh, a compound and a tilted plane; joints of which one breaks, and one that
// is taken away, with its body. Usage: shapes PAGE.html TEMPLATE
#include <pintle/joints/ball_joint.h>
#include <pintle/record.h>

#include <scenes/world.h>

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>

#include <cstdio>
#include <exception>

using scenes::pose_at;

int main(int argc, char** argv) {
  if (argc != 3) return 1;
  // What the world's shapes refer to.
  btTriangleMesh ridge;
  btBoxShape bar(btVector3(btScalar(0.5), btScalar(0.1), btScalar(0.1)));
  btSphereShape ball(btScalar(0.2));

  scenes::World world;
  world.add(0, std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(-1)),
            pose_at({0, 0, 0}), true);
  // Tilted by its pose, and by its normal.
  const btVector3 normal = btVector3(1, -2, 2) / 3;
  world.add(0, std::make_unique<btStaticPlaneShape>(normal, btScalar(-0.5)),
            btTransform(btQuaternion(btVector3(0, 0, 1), btScalar(0.5)), {0, 0, btScalar(0.25)}),
            true);

  auto hull = std::make_unique<btConvexHullShape>();
  for (const btVector3& point : {btVector3(-1, -1, -1), btVector3(1, -1, -1), btVector3(0, 1, -1),
                                 btVector3(0, 0, 1), btVector3(0, 0, 0)})  // the last one is inside
    hull->addPoint(btScalar(0.25) * point);
  world.add(1, std::move(hull), pose_at({0, 0, 1}), true)
      .setAngularVelocity(btVector3(1, 2, btScalar(0.5)));

  const btVector3 low(0, -1, 0), high(0, 1, 1), left(-1, 0, 0), right(1, 0, 0);
  ridge.addTriangle(low, high, left);
  ridge.addTriangle(low, right, high);
  world.add(0, std::make_unique<btBvhTriangleMeshShape>(&ridge, true), pose_at({3, 0, 0}), true);

  auto dumbbell = std::make_unique<btCompoundShape>();
  dumbbell->addChildShape(pose_at({0, 0, 0}), &bar);
  for (const btScalar end : {btScalar(-0.5), btScalar(0.5)})
    dumbbell->addChildShape(pose_at({end, 0, 0}), &ball);
  world.add(1, std::move(dumbbell), pose_at({-2, 0, 1}), true);

  // Three weights: one that hangs, one that is too heavy for its joint, and one that is taken away.
  pintle::BallJoint* joints[3];
  for (int i = 0; i < 3; ++i) {
    btRigidBody& weight =
        world.add_box(1, btVector3(1, 1, 1) * btScalar(0.2), pose_at({btScalar(i), 2, 2}));
    joints[i] = &world.add_joint<pintle::BallJoint>(weight, btVector3(0, 0, btScalar(0.5)));
  }
  joints[1]->setBreakingImpulseThreshold(btScalar(0.01));

  pintle::RecorderOptions options;
  options.scene = "shapes";
  pintle::Recorder record(world.bullet(), options);
  for (int step = 0; step < 60; ++step) {
    if (step == 30) {
      world.bullet().removeConstraint(joints[2]);
      world.bullet().removeRigidBody(&joints[2]->getRigidBodyA());
    }
    world.step(1. / 60);
    record.step();
  }
  try {
    record.write(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
