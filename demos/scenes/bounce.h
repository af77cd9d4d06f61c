// A ball is dropped on a plane, from 1 m, and bounces until it rests.
//
// Stock joints have no contact: Bullet's is the collision of a sphere of 0.1 m with a plane, which the
// centre of the ball then stays 0.1 m above. Measured over 10 s, the height being that of the centre
// above where it rests:
//   rebound     how high the first one goes, over what it would: e^2 of the height, e the coefficient of
//               restitution (nothing if that is 0: then the height in m)
//   below       the deepest, m
//   rest at     the height at the end, m
// Ideal: 1, 0, 0.

#pragma once

#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "world.h"

namespace scenes {

struct StockContact {};  // in the place of a joint

struct BounceSettings {
  double restitution = 0.5;
  double height = 1;     // m
  double dt = 1.0 / 60;  // s
  double seconds = 10;
};

struct BounceResult {
  double rebound = 0;  // m
  double below = 0;    // m
  double rest = 0;     // m
  bool finite = true;
  double microseconds_per_step = 0;  // wall-clock: does not repeat
};

template <class Contact>
BounceResult bounce(const BounceSettings& settings) {
  const double radius = 0.1;
  btSphereShape sphere{btScalar(radius)};
  btStaticPlaneShape plane(btVector3(0, 0, 1), btScalar(-radius));
  World world;
  btRigidBody& ground = world.add_box(0, btVector3(1, 1, 1), pose_at({0, 0, 0}));
  const btScalar half = btScalar(radius);
  btRigidBody& ball =
      world.add_box(1, btVector3(half, half, half), pose_at({0, 0, btScalar(settings.height)}));
  if constexpr (std::is_same_v<Contact, StockContact>) {
    for (btRigidBody* body : {&ground, &ball}) {
      world.bullet().removeRigidBody(body);
      body->setCollisionShape(body == &ball ? static_cast<btCollisionShape*>(&sphere) : &plane);
      body->setRestitution(btScalar(std::sqrt(settings.restitution)));  // Bullet takes the product
      world.bullet().addRigidBody(body);
    }
  } else {
    const btVector3 centre(0, 0, 0);
    world.add_joint<Contact>(ground, ball, centre, centre, btVector3(0, 0, 1))
        .setRestitution(btScalar(settings.restitution));
  }

  BounceResult result;
  bool touched = false, climbed = false;
  double last = settings.height;
  const int steps = int(std::lround(settings.seconds / settings.dt));
  for (int step = 1; step <= steps; ++step) {
    world.step(settings.dt);
    const double height = position(ball).z();
    result.finite = std::isfinite(height);
    if (!result.finite) break;
    // Falls, touches, climbs, and falls again.
    climbed = climbed || (touched && result.rebound > 0 && height < last);
    touched = touched || height >= last;
    if (touched && !climbed) result.rebound = std::max(result.rebound, height);
    result.below = std::max(result.below, -height);
    last = result.rest = height;
  }
  result.microseconds_per_step = world.microseconds_per_step();
  return result;
}

}  // namespace scenes
