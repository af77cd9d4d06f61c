// A world of boxes on a floor, joined at random between neighbours, in which joints are removed, put back and
// broken while it runs. What happens, and when, follows from the seed alone: it is the same for every family.

#pragma once

#include "playground.h"
#include "tangle.h"

namespace scenes {

struct ChangingResult {
  double speed = 0;         // m/s, the largest of any body in any step
  int step = 0;             // in which it was
  std::vector<Kind> kinds;  // of the joints of that body then
  int changes = 0;          // joints removed, put back, and given a threshold
};

// Kinds of joints: those that both families have, or all, with stand-ins for stock (families.h).
enum class Kinds { common, all };

template <class Family>
ChangingResult run_changing(unsigned seed, Kinds kinds = Kinds::common, int steps = 300,
                            int iterations = 10, double dt = 1. / 60) {
  Dice dice(seed);
  const auto pick = [&dice](size_t count) { return size_t(dice.between(0, double(count))); };
  PlaygroundSettings settings;
  settings.iterations = iterations;
  Playground world(settings);
  btRigidBody& ground = world.ground();

  std::vector<btRigidBody*> boxes;
  struct Entry {
    btTypedConstraint* joint;
    Kind kind;
  };
  std::vector<Entry> in, out;  // of the world
  const auto join = [&](btRigidBody& a, btRigidBody& b, const Eigen::Vector3d& at) {
    const Kind kind = Kind(int(pick(kinds == Kinds::all ? 11 : 6)));
    const bool limited = dice.falls(0.5) || kind == Kind::angle;
    const double limit = dice.between(0.05, 1);
    in.push_back({&world.join<Family>(kind, a, b, dice.frame(at), limited ? limit : 0), kind});
  };
  const int count = int(dice.between(5, 20.99));
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d half(dice.between(0.1, 0.4), dice.between(0.1, 0.4),
                               dice.between(0.1, 0.4));
    const Eigen::Vector3d at(dice.between(-2, 2), dice.between(-2, 2), dice.between(0.5, 4));
    btRigidBody& body = world.box(std::pow(10, dice.between(-1, 1)), half, dice.frame(at));
    body.setLinearVelocity(to_bullet(Eigen::Vector3d(dice.between(0, 5) * dice.direction())));
    body.setAngularVelocity(to_bullet(Eigen::Vector3d(dice.between(0, 5) * dice.direction())));
    std::vector<btRigidBody*> near = boxes;
    std::sort(near.begin(), near.end(), [&](const btRigidBody* a, const btRigidBody* b) {
      return (position(*a) - at).squaredNorm() < (position(*b) - at).squaredNorm();
    });
    near.resize(std::min(near.size(), size_t(1) + pick(3)));
    for (btRigidBody* other : near) join(*other, body, (position(*other) + at) / 2);
    if (dice.falls(0.1)) join(ground, body, at);
    boxes.push_back(&body);
  }

  // A joint that is out stays so for a while: its bodies drift apart.
  ChangingResult result;
  btDiscreteDynamicsWorld& bullet = world.world().bullet();
  for (int step = 0; step < steps; ++step) {
    if (step % 3 == 2) {
      if (!in.empty()) {
        const size_t i = pick(in.size());
        bullet.removeConstraint(in[i].joint);
        out.push_back(in[i]);
        in.erase(in.begin() + long(i));
        ++result.changes;
      }
      if (out.size() > in.size()) {
        bullet.addConstraint(out.front().joint, true);
        out.front().joint->setEnabled(true);  // a broken one is whole again
        in.push_back(out.front());
        out.erase(out.begin());
        ++result.changes;
      }
      if (!in.empty() && dice.falls(0.3)) {
        in[pick(in.size())].joint->setBreakingImpulseThreshold(
            btScalar(std::pow(10, dice.between(-1, 1.5))));
        ++result.changes;
      }
    }
    world.step(dt);
    const double speed = world.speed();
    if (speed > result.speed) {
      result.speed = speed;
      result.step = step;
      result.kinds.clear();
      for (const Entry& entry : in) {
        if (!entry.joint->isEnabled()) continue;
        for (const btRigidBody* body :
             {&entry.joint->getRigidBodyA(), &entry.joint->getRigidBodyB()})
          if (double(body->getLinearVelocity().length()) >= speed)
            result.kinds.push_back(entry.kind);
      }
    }
    if (!std::isfinite(speed)) break;
  }
  return result;
}

}  // namespace scenes
