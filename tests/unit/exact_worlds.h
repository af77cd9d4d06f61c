// Rigid bodies and their joints in any of Bullet's worlds, for tests of the exact solvers of these.
#pragma once

#include <pintle/joints/ball_joint.h>

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

#include "bodies.h"
#include "support.h"

namespace exact_worlds {

using support::vec;

constexpr double dt = 1. / 60;

struct Bullet {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
};

/// Rigid bodies and their joints, in any world.
class Bodies : public support::Bodies {
 public:
  using support::Bodies::Bodies;

  /// Links of 0.5 m and 1 kg, along x from `start`, where a ball holds the first one. Returns the last one.
  template <class Ball = pintle::BallJoint>
  btRigidBody& addChain(int links, const btVector3& start, double load = 1) {
    btRigidBody* last = &add(0, vec(0.1, 0.1, 0.1), start);
    for (int i = 0; i < links; ++i) {
      btRigidBody& link =
          add(i == links - 1 ? load : 1, vec(0.25, 0.05, 0.05), start + vec(0.5 * i + 0.25, 0, 0));
      join(std::make_unique<Ball>(*last, link, vec(i > 0 ? 0.25 : 0, 0, 0), vec(-0.25, 0, 0)));
      last = &link;
    }
    return *last;
  }
  std::vector<btScalar> state() const {
    std::vector<btScalar> all;
    for (const auto& body : bodies)
      for (const btVector3& of :
           {body->getCenterOfMassPosition(), body->getLinearVelocity(), body->getAngularVelocity(),
            body->getCenterOfMassTransform().getBasis()[0]})
        all.insert(all.end(), {of.x(), of.y(), of.z()});
    return all;
  }
};

}  // namespace exact_worlds
