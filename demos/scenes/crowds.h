// Many joints among contacts, as a game's frame holds them. They serve benchmarks and tests, and are not in the
// catalog.

#pragma once

#include "scene.h"

namespace scenes {

// Ragdolls fall on a floor and on each other, five above each other, each turned another way.
Scene ragdolls_scene(int count = 20);
// The same in a pile: nine beside each other.
Scene ragdoll_pile_scene(int count = 50);
// Doors on one hinge each, with limits: a third at rest, a third opened and shut by a motor, a third held shut
// by it.
Scene doors_scene(int count = 100);
// Cars with four driven wheels, each on a slider that is its suspension's travel.
Scene vehicles_scene(int count = 20);
// A square net of plates, each tied to its neighbours by a ball joint, falls on a ball that stays.
Scene net_scene(int size = 15);
// The same, hung by two of its corners, and on the ground.
Scene hanging_net_scene(int size = 15);
Scene lying_net_scene(int size = 15);
// The same, flat in a frame that holds all of its rim, and a ball of 50 kg falls on it.
Scene taut_net_scene(int size = 15);
// Planks hang between two banks, and a load of so many planks' mass is dropped on the middle.
Scene loaded_bridge_scene(int planks = 100, double ratio = 100);
// A closed track around two wheels, of which one is driven. Its first link is the probe's.
Scene track_scene(int links = 200);
// Boxes fall on a floor, five above each other: contacts, and no joint.
Scene boxes_scene(int count = 100);

// Rope bridges of ten planks, held at both ends, with a crate dropped on each.
struct CrateBridges {
  Scene scene;
  struct Crate {
    int body;
    Vector3d from, to;  // the bridge's ends
  };
  std::vector<Crate> crates;
  static constexpr double half_width = 0.5;  // m
};
CrateBridges crate_bridges(int count = 50);

}  // namespace scenes
