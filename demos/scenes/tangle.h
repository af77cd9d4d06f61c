// Boxes joined at random: a tree, joints that close it to loops and others that hold it to the world, half of them
// with limits, a third with motors, over the ground or falling. Nobody would build it; all that joints, limits and
// contacts can ask of each other that cannot be had is in one of them. Each number is another one.
//
// Joints are those of a family (families.h). Measured, over all steps of 5 s:
//   speed   the largest of any body, m/s
//   spin    the largest of any body, rad/s

#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "families.h"
#include "world.h"

namespace scenes {

struct TangleResult {
  double speed = 0, spin = 0;
  bool finite = true;
};

class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  // The engine is the same everywhere, the standard's distributions are not.
  double between(double a, double b) { return a + (b - a) * double(engine_()) / 4294967296.0; }
  bool falls(double probability) { return between(0, 1) < probability; }
  Eigen::Vector3d direction() {
    Eigen::Vector3d d;
    do {
      for (double& x : d) x = between(-1, 1);
    } while (d.norm() > 1 || d.norm() < 0.1);
    return d.normalized();
  }
  btTransform frame(const Eigen::Vector3d& origin) {
    const Eigen::Vector3d x = direction();
    return frame_along(origin, x, x.cross(direction()).normalized());
  }

 private:
  std::mt19937 engine_;
};

template <class Family>
void join_at_random(World& world, Dice& dice, btRigidBody& a, btRigidBody& b,
                    const Eigen::Vector3d& at) {
  const btTransform frame = dice.frame(at);
  const bool has_limits = dice.falls(0.5), has_motor = dice.falls(0.3);
  const auto number = [&](double from, double to) { return btScalar(dice.between(from, to)); };
  switch (int(dice.between(0, 4))) {
    case 0: {
      auto& hinge = world.join<typename Family::Hinge>(a, b, frame);
      if (has_limits) hinge.setLimit(number(-1, 0), number(0, 1));
      if (has_motor) hinge.enableAngularMotor(true, number(-5, 5), number(0, 3));
      break;
    }
    case 1: {
      auto& cone = world.join<typename Family::ConeTwist>(a, b, frame);
      if (has_limits) cone.setLimit(number(0.05, 1), number(0.05, 1), number(0.05, 1));
      break;
    }
    case 2: {
      auto& slider = world.join<typename Family::Slider>(a, b, frame, true);
      slider.setLowerLinLimit(has_limits ? number(-0.3, 0) : btScalar(0));
      slider.setUpperLinLimit(has_limits ? number(0, 0.3) : btScalar(0));
      slider.setLowerAngLimit(has_limits ? number(-1, 0) : btScalar(0));
      slider.setUpperAngLimit(has_limits ? number(0, 1) : btScalar(0));
      if (!has_motor) break;
      slider.setPoweredLinMotor(true);
      slider.setTargetLinMotorVelocity(number(-2, 2));
      slider.setMaxLinMotorForce(number(0, 1000));
      break;
    }
    default: world.join<typename Family::Fixed>(a, b, frame);
  }
}

template <class Family>
TangleResult tangle(unsigned seed, const SolverFactory& make_solver = {}) {
  Dice dice(seed);
  World world(standard_gravity, 10, make_solver);
  const auto join = [&](btRigidBody& a, btRigidBody& b, const Eigen::Vector3d& at) {
    join_at_random<Family>(world, dice, a, b, at);
  };
  const bool has_ground = dice.falls(0.6);
  if (has_ground) world.add_box(0, btVector3(50, 50, 1), pose_at(btVector3(0, 0, -4)), true);
  const double decades = dice.falls(0.5) ? 0.5 : 2;  // of masses
  const int count = int(dice.between(3, 25));
  std::vector<btRigidBody*> bodies;
  for (int i = 0; i < count; ++i) {
    btRigidBody* parent = i > 0 ? bodies[size_t(dice.between(0, i))] : nullptr;
    if (i > 0 && dice.falls(0.5)) parent = bodies.back();
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    double max_room = -1;
    for (int trial = 0; parent != nullptr && trial < 8; ++trial) {
      const Eigen::Vector3d p = position(*parent) + 0.8 * dice.direction();
      double room = HUGE_VAL;
      for (const btRigidBody* other : bodies) room = std::min(room, (position(*other) - p).norm());
      if (room > max_room) at = p;
      max_room = std::max(max_room, room);
    }
    const double mass = std::pow(10, dice.between(-decades / 2, decades / 2));
    const btVector3 half(btScalar(dice.between(0.1, 0.3)), btScalar(dice.between(0.1, 0.3)),
                         btScalar(dice.between(0.1, 0.3)));
    const btTransform pose = dice.frame(at);
    bodies.push_back(&world.add_box(mass, half, pose, has_ground));
    if (has_ground) bodies.back()->setFriction(btScalar(dice.between(0, 1)));
    bodies.back()->setLinearVelocity(
        to_bullet(Eigen::Vector3d(dice.between(0, 3) * dice.direction())));
    bodies.back()->setAngularVelocity(
        to_bullet(Eigen::Vector3d(dice.between(0, 3) * dice.direction())));
    if (parent != nullptr) join(*parent, *bodies.back(), (position(*parent) + at) / 2);
  }
  const int loops = int(dice.between(0, 4)), anchors = int(dice.between(0, 3));
  for (int i = 0; i < loops; ++i) {
    btRigidBody &a = *bodies[size_t(dice.between(0, count))],
                &b = *bodies[size_t(dice.between(0, count))];
    if (&a != &b) join(a, b, (position(a) + position(b)) / 2);
  }
  for (int i = 0; i < anchors; ++i) {
    btRigidBody& body = *bodies[size_t(dice.between(0, count))];
    const Eigen::Vector3d at = position(body) + 0.4 * dice.direction();
    join(world.add_box(0, btVector3(1, 1, 1), pose_at(to_bullet(at))), body, at);
  }
  TangleResult result;
  for (int step = 0; step < 300 && result.finite; ++step) {
    world.step(1. / 60);
    for (const btRigidBody* body : bodies) {
      const double speed = double(body->getLinearVelocity().length()),
                   spin = double(body->getAngularVelocity().length());
      result.finite = result.finite && std::isfinite(speed) && std::isfinite(spin);
      result.speed = std::max(result.speed, speed);
      result.spin = std::max(result.spin, spin);
    }
  }
  return result;
}

}  // namespace scenes
