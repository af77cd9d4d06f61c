// A world of boxes on a floor, joined at random between neighbours, in which joints are removed, put back and
// broken while it runs. What happens, and when, follows from the seed alone: it is the same for every family.

#pragma once

#include "playground.h"
#include "tangle.h"

namespace scenes {

struct ChangingResult {
  double speed = 0;  // m/s, the largest of any body in any step
  int step = 0;      // in which it was
  int changes = 0;   // joints removed, put back, and given a threshold
};

// Kinds of joints: those that both families have, or all, with stand-ins for stock (families.h).
enum class Kinds { common, all };

template <class Family>
ChangingResult run_changing(unsigned seed, Kinds kinds = Kinds::common, int steps = 300,
                            int iterations = 10, double dt = 1. / 60) {
  Dice dice(seed);
  PlaygroundSettings settings;
  settings.iterations = iterations;
  Playground world(settings);
  world.ground();
  const int count = int(dice.between(5, 20.99));
  struct Entry {
    btTypedConstraint* joint;
    bool in_world;
  };
  std::vector<Entry> entries;
  std::vector<btRigidBody*> boxes;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d half(dice.between(0.1, 0.4), dice.between(0.1, 0.4),
                               dice.between(0.1, 0.4));
    const Eigen::Vector3d at(dice.between(-2, 2), dice.between(-2, 2), dice.between(0.5, 4));
    btRigidBody& body = world.box(std::pow(10, dice.between(-1, 1)), half, dice.frame(at));
    const int joints = dice.falls(0.3) ? 2 : 1;
    std::vector<btRigidBody*> near = boxes;
    std::sort(near.begin(), near.end(), [&](const btRigidBody* a, const btRigidBody* b) {
      return (position(*a) - at).squaredNorm() < (position(*b) - at).squaredNorm();
    });
    for (int k = 0; k < std::min(joints, int(near.size())); ++k) {
      const Kind kind = Kind(int(dice.between(0, kinds == Kinds::all ? 10.99 : 5.99)));
      const bool limited = dice.falls(0.5) || kind == Kind::angle;
      const double limit = dice.between(0.1, 1);
      const btTransform frame = dice.frame((position(*near[size_t(k)]) + at) / 2);
      entries.push_back(
          {&world.join<Family>(kind, *near[size_t(k)], body, frame, limited ? limit : 0), true});
    }
    boxes.push_back(&body);
  }
  ChangingResult result;
  btDiscreteDynamicsWorld& bullet = world.world().bullet();
  for (int step = 0; step < steps; ++step) {
    if (step % 5 == 4 && !entries.empty()) {
      const auto pick = [&]() -> Entry& {
        return entries[size_t(dice.between(0, double(entries.size())))];
      };
      Entry& removed = pick();
      if (removed.in_world) {
        bullet.removeConstraint(removed.joint);
        removed.in_world = false;
        ++result.changes;
      }
      Entry& back = pick();
      if (!back.in_world) {
        back.joint->setEnabled(true);  // a broken one is whole again
        bullet.addConstraint(back.joint, true);
        back.in_world = true;
        ++result.changes;
      }
      Entry& weak = pick();
      if (dice.falls(0.3)) {
        weak.joint->setBreakingImpulseThreshold(btScalar(std::pow(10, dice.between(-1, 1.5))));
        ++result.changes;
      }
    }
    world.step(dt);
    const double speed = world.speed();
    if (speed > result.speed) {
      result.speed = speed;
      result.step = step;
    }
    if (!std::isfinite(speed)) break;
  }
  return result;
}

}  // namespace scenes
