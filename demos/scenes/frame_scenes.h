// What a game's frame holds: ragdolls, doors, vehicles, bridges with crates, a net on a ball. Each is made
// of one family's joints (families.h), and is the same for both.

#pragma once

#include "joint_work.h"
#include "playground.h"

namespace scenes {

// Cone-twist joints at neck, back, shoulders and hips, hinges with limits at elbows and knees.
template <class Family>
void add_ragdoll(Playground& world, const Eigen::Vector3d& at, const Eigen::AngleAxisd& turn) {
  const auto place = [&](double x, double y) -> Eigen::Vector3d {
    return at + turn * Eigen::Vector3d(x, y, 0);
  };
  const auto part = [&](double mass, double hx, double hy, double hz, double x,
                        double y) -> btRigidBody& {
    return world.box(
        mass, {hx, hy, hz},
        btTransform(matrix_to_bullet(turn.toRotationMatrix()), to_bullet(place(x, y))));
  };
  const Eigen::Vector3d along = turn * Eigen::Vector3d(1, 0, 0),
                        across = turn * Eigen::Vector3d(0, 1, 0);
  const auto cone = [&](btRigidBody& a, btRigidBody& b, const Eigen::Vector3d& p,
                        const Eigen::Vector3d& x, double swing, double twist) {
    world.cone<Family>(a, b, frame_along(p, x, across))
        .setLimit(btScalar(swing), btScalar(swing), btScalar(twist));
  };
  const auto bend = [&](btRigidBody& a, btRigidBody& b, const Eigen::Vector3d& p) {
    world.hinge<Family>(a, b, frame_along(p, along, across)).setLimit(btScalar(-2), btScalar(0.1));
  };
  btRigidBody& pelvis = part(12, 0.1, 0.15, 0.08, 0, 0);
  btRigidBody& chest = part(25, 0.2, 0.17, 0.1, 0.32, 0);
  btRigidBody& head = part(5, 0.1, 0.08, 0.09, 0.66, 0);
  cone(pelvis, chest, place(0.11, 0), along, 0.5, 0.4);
  cone(chest, head, place(0.54, 0), along, 0.7, 0.7);
  for (const double side : {-1., 1.}) {
    btRigidBody& upper_arm = part(2.5, 0.14, 0.05, 0.05, 0.33, side * 0.24);
    btRigidBody& lower_arm = part(2, 0.13, 0.04, 0.04, 0.05, side * 0.24);
    btRigidBody& thigh = part(8, 0.2, 0.07, 0.07, -0.31, side * 0.09);
    btRigidBody& shin = part(5, 0.2, 0.055, 0.055, -0.72, side * 0.09);
    cone(chest, upper_arm, place(0.47, side * 0.24), -along, 1.2, 0.8);
    bend(upper_arm, lower_arm, place(0.185, side * 0.24));
    cone(pelvis, thigh, place(-0.11, side * 0.09), -along, 0.9, 0.4);
    bend(thigh, shin, place(-0.515, side * 0.09));
  }
}

// They fall on a floor and on each other, five above each other, each turned another way.
template <class Family>
PlaygroundPtr make_ragdolls(const PlaygroundSettings& settings, int count = 20) {
  auto world = std::make_unique<Playground>(settings);
  world->ground();
  for (int n = 0; n < count; ++n) {
    const Eigen::Vector3d at(1.2 * (n / 5), 0.6 * (n / 5 % 2), 1 + 0.7 * (n % 5));
    add_ragdoll<Family>(*world, at,
                        Eigen::AngleAxisd(0.3 * n, Eigen::Vector3d(0.3, 0.2, 1).normalized()));
  }
  return world;
}

// Doors of 20 kg on one hinge each, with limits: a third at rest, a third opened and shut by a motor, a
// third held shut by it.
template <class Family>
PlaygroundPtr make_doors(const PlaygroundSettings& settings, int count = 100) {
  auto world = std::make_unique<Playground>(settings);
  btRigidBody& wall = world->ghost(0, {1, 1, 1}, pose_at(btVector3(0, 0, -10)));
  for (int n = 0; n < count; ++n) {
    const Eigen::Vector3d at(2 * (n % 10), 2 * (n / 10), 1);
    btRigidBody& door = world->box(20, {0.45, 0.02, 1}, at + Eigen::Vector3d(0.45, 0, 0));
    auto& hinge = world->hinge<Family>(wall, door, pose_at(to_bullet(at)));
    hinge.setLimit(n % 3 == 2 ? btScalar(0) : btScalar(-1.2), btScalar(1.2));
    if (n % 3 == 1) hinge.enableAngularMotor(true, btScalar(n % 2 ? 0.2 : -0.2), btScalar(0.5));
    if (n % 3 == 2) hinge.enableAngularMotor(true, btScalar(-1), btScalar(0.2));
  }
  return world;
}

// Four wheels on hinges with motors, each on a slider that is its suspension's travel.
template <class Family>
PlaygroundPtr make_vehicles(const PlaygroundSettings& settings, int count = 20) {
  auto world = std::make_unique<Playground>(settings);
  world->ground();
  const Eigen::Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  for (int n = 0; n < count; ++n) {
    const Eigen::Vector3d at(6. * (n % 4), 4. * (n / 4), 0.8);
    btRigidBody& chassis = world->box(200, {1, 0.5, 0.2}, at);
    for (const double front : {-1., 1.}) {
      for (const double side : {-1., 1.}) {
        const Eigen::Vector3d hub = at + Eigen::Vector3d(0.8 * front, 0.75 * side, -0.3);
        btRigidBody& knuckle = world->ghost(
            10, {0.1, 0.05, 0.1}, pose_at(to_bullet(Eigen::Vector3d(hub - 0.15 * side * y))));
        btRigidBody& wheel = world->round(15,
                                          std::make_unique<btCylinderShape>(btVector3(
                                              btScalar(0.3), btScalar(0.1), btScalar(0.3))),
                                          pose_at(to_bullet(hub)), 1);
        world->slider<Family>(chassis, knuckle, frame_along(hub - 0.15 * side * y, z, y), 0.05);
        auto& axle = world->hinge<Family>(knuckle, wheel, frame_along(hub, x, y));
        axle.enableAngularMotor(true, btScalar(n % 2 ? 4 : -4), btScalar(1));
      }
    }
  }
  return world;
}

// Rope bridges of ten planks and eleven hinges, held at both ends, with a crate of 50 kg dropped on each.
struct Bridges {
  PlaygroundPtr world;
  struct Crate {
    const btRigidBody* body;
    Eigen::Vector3d from, to;  // the bridge's ends
  };
  std::vector<Crate> crates;

  static constexpr double half_width = 0.5;  // m
  // Those that have left their bridge: fallen below it, or past an edge of it.
  int thrown_off() const {
    int off = 0;
    for (const Crate& crate : crates) {
      const Eigen::Vector3d p = position(*crate.body);
      const bool on = p.z() > crate.from.z() - 3 && p.x() > crate.from.x() &&
                      p.x() < crate.to.x() && std::abs(p.y() - crate.from.y()) < 2 * half_width;
      off += on ? 0 : 1;
    }
    return off;
  }
};

template <class Family>
Bridges make_bridges(const PlaygroundSettings& settings, int count = 50) {
  Bridges bridges{std::make_unique<Playground>(settings), {}};
  Playground& world = *bridges.world;
  world.ground();
  btRigidBody& post = world.ghost(0, {0.3, 0.3, 0.3}, pose_at(btVector3(0, 0, -50)));
  const int planks = 10;
  const double half_arc = 0.5;  // rad: it hangs through by a quarter of its length's half
  const Eigen::Vector3d x(1, 0, 0), y(0, 1, 0);
  for (int n = 0; n < count; ++n) {
    const Eigen::Vector3d from(14. * (n % 5), 3. * (n / 5), 5);
    Eigen::Vector3d at = from;
    btRigidBody* last = &post;
    for (int k = 0; k < planks; ++k) {
      const double slope = -half_arc + 2 * half_arc * (k + 0.5) / planks;
      const Eigen::Vector3d along(std::cos(slope), 0, std::sin(slope));
      btRigidBody& plank = world.box(10, {0.5, Bridges::half_width, 0.05},
                                     frame_along(at + along / 2, along, along.cross(y)));
      world.hinge<Family>(*last, plank, frame_along(at, x, y));
      last = &plank;
      at += along;
    }
    world.hinge<Family>(*last, post, frame_along(at, x, y));
    const Eigen::Vector3d middle = (from + at) / 2 + Eigen::Vector3d(0.2 * (n % 7 - 3), 0, 0.5);
    bridges.crates.push_back({&world.box(50, {0.3, 0.3, 0.3}, middle), from, at});
  }
  return bridges;
}

struct BridgesResult {
  double fed = 0;    // J: the sum of what joints give, over the steps in which they do
  double gains = 0;  // J: the sum of what each step gains of mechanical energy, contacts and all
  double largest_gain = 0;  // J, in a step
  double end_kinetic = 0;   // J
  double mean_gap = 0;      // m, over joints and steps
  double max_gap = 0;       // m
  int thrown_off = 0;       // crates
};

template <class Family>
BridgesResult run_bridges(int iterations, double hz, double seconds, int count) {
  PlaygroundSettings settings;
  settings.iterations = iterations;
  const Bridges bridges = make_bridges<Family>(settings, count);
  Playground& world = *bridges.world;
  const int steps = int(std::lround(seconds * hz));
  BridgesResult result;
  JointWork work(world.world().bullet());
  double energy = world.energy();
  for (int i = 0; i < steps; ++i) {
    work.beginStep();
    world.step(1 / hz);
    result.fed += std::max(0., work.endStep(1 / hz));
    const double energy_now = world.energy(), gain = energy_now - energy;
    energy = energy_now;
    result.gains += gain > 0 ? gain : 0;
    result.largest_gain = std::max(result.largest_gain, gain);
    const Playground::Gap gap = world.gap();
    result.mean_gap += gap.mean / steps;
    result.max_gap = std::max(result.max_gap, gap.largest);
  }
  result.end_kinetic = world.kinetic();
  result.thrown_off = bridges.thrown_off();
  return result;
}

// A square net of size x size plates, each tied to its neighbours by a ball joint, falls on a static ball.
template <class Family>
PlaygroundPtr make_net(const PlaygroundSettings& settings, int size = 15) {
  auto world = std::make_unique<Playground>(settings);
  world->round(0, std::make_unique<btSphereShape>(btScalar(size / 4.)),
               pose_at(btVector3(btScalar((size - 1) / 2. + 0.2), btScalar((size - 1) / 2. - 0.1),
                                 btScalar(-size / 4. - 0.5))));
  std::vector<btRigidBody*> plates;
  for (int j = 0; j < size; ++j) {
    for (int i = 0; i < size; ++i) {
      const Eigen::Vector3d at(i, j, 0);
      plates.push_back(&world->box(1, {0.4, 0.4, 0.1}, at));
      if (i > 0)
        world->join<Family>(Kind::ball, *plates[plates.size() - 2], *plates.back(),
                            pose_at(to_bullet(Eigen::Vector3d(at - Eigen::Vector3d(0.5, 0, 0)))));
      if (j > 0)
        world->join<Family>(Kind::ball, *plates[plates.size() - 1 - size_t(size)], *plates.back(),
                            pose_at(to_bullet(Eigen::Vector3d(at - Eigen::Vector3d(0, 0.5, 0)))));
    }
  }
  return world;
}

}  // namespace scenes
