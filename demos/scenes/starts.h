// Joints that start wrong: Bullet's tutorial of a rope bridge, and chains that start overlapping, apart or turned.

#pragma once

#include <random>

#include "playground.h"
#include "tangle.h"

namespace scenes {

// Bridge.cpp of Bullet's ExtendedTutorials, with z up. Two ball joints between each two planks have their
// pivots 0.156 m inside each other: 10 planks of 1 m from pivot to pivot in 7.6 m.
template <class Family>
PlaygroundPtr make_tutorial_bridge(const PlaygroundSettings& settings) {
  auto world = std::make_unique<Playground>(settings);
  world->ground();
  const int count = 10;
  const double width = 0.4, half_bridge = (width * count + width * (count - 1)) / 2;
  btRigidBody* last = nullptr;
  for (int i = 0; i < count; ++i) {
    const double x = -(2. * i / (count - 1) - 1) * half_bridge;
    btRigidBody& plank = world->box(i == 0 || i == count - 1 ? 0 : 1, {width, 1, 0.2}, {x, 0, 5});
    if (last != nullptr) {
      for (const double y : {-0.5, 0.5})
        world->join_colliding<Family>({Kind::ball, *last, plank, pose_at(to_bullet({-0.5, y, 0})),
                                       pose_at(to_bullet({0.5, y, 0}))});
    }
    last = &plank;
  }
  return world;
}

enum class Start { overlapping, apart, turned, all };
inline const char* start_name(Start start) {
  switch (start) {
    case Start::overlapping: return "overlapping";
    case Start::apart: return "apart";
    case Start::turned: return "turned";
    case Start::all: return "all";
  }
  return "";
}

// A chain of two to ten boxes of 0.1 to 10 kg, free or held at one end, at rest, without gravity and contacts: all energy
// that it ever has came from joints. Overlapping: pivots up to 0.2 m inside each other; apart: up to 3 m; turned: by
// up to pi. The same seed is the same start for every family.
template <class Family>
PlaygroundPtr make_start(Kind kind, Start start, unsigned seed, PlaygroundSettings settings = {}) {
  Dice dice(seed);
  settings.gravity = 0;
  auto world = std::make_unique<Playground>(settings);
  const int count = int(dice.between(2, 10.99));
  const bool held = dice.falls(0.5), limited = dice.falls(0.5) || kind == Kind::angle;
  const double span = dice.between(0.3, 1);
  double pulled = 0;  // m, towards the first one
  btRigidBody* last =
      held ? &world->ghost(0, {0.1, 0.1, 0.1}, pose_at(btVector3(0, 0, 0))) : nullptr;
  for (int i = 0; i < count; ++i) {
    // As they should be: frames coincide.
    const btTransform frame = dice.frame({i - 0.5, 0, 0});
    btTransform pose = pose_at(btVector3(btScalar(i), 0, 0));
    const double mass = std::pow(10, dice.between(-1, 1));
    const Eigen::Vector3d half(0.4, dice.between(0.05, 0.3), dice.between(0.05, 0.3));
    const btTransform in_b = pose.inverse() * frame;
    const btTransform last_pose = pose_at(btVector3(btScalar(held && i == 0 ? 0 : i - 1), 0, 0));
    const btTransform in_a = last_pose.inverse() * frame;
    // As they are.
    const Eigen::Vector3d shift = dice.direction(), about = dice.direction();
    const double by = dice.between(0, 1), angle = dice.between(0, pi);
    pulled += 0.2 * by;
    if (start == Start::overlapping) pose.getOrigin() -= btVector3(btScalar(pulled), 0, 0);
    if (start == Start::apart || start == Start::all)
      pose.getOrigin() += to_bullet(Eigen::Vector3d(3 * by * shift));
    if (start == Start::turned || start == Start::all)
      pose.setRotation(btQuaternion(to_bullet(about), btScalar(angle)));
    btRigidBody& body = world->ghost(mass, half, pose);
    if (last != nullptr) world->join<Family>({kind, *last, body, in_a, in_b, limited ? span : 0});
    last = &body;
  }
  return world;
}

struct StartResult {
  double energy = 0;  // J: the largest gain over the start
  double speed = 0, spin = 0;
  double gap = 0;  // m, at the end, the largest
};

inline StartResult run_start(Playground& world, double seconds, double dt = 1. / 60) {
  StartResult result;
  const double at_start = world.energy();
  const int steps = int(std::lround(seconds / dt));
  for (int i = 0; i < steps; ++i) {
    world.step(dt);
    const double gain = world.energy() - at_start;
    result.energy = std::isfinite(gain) ? std::max(result.energy, gain) : HUGE_VAL;
    result.speed = std::max(result.speed, world.speed());
    result.spin = std::max(result.spin, world.spin());
    if (!std::isfinite(result.energy + result.speed + result.spin)) break;
  }
  result.gap = world.gap();
  return result;
}

}  // namespace scenes
