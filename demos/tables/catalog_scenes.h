// For tables of the catalog's scenes, which any joints are built into.

#pragma once

#include <cmath>
#include <functional>
#include <memory>

#include "../engines/bullet.h"
#include "../measures/run.h"
#include "../scenes/catalog.h"
#include "table.h"

namespace tables {

// One of the catalog's scenes, built with a contender's joints.
using Make = std::function<std::unique_ptr<engines::BulletEngine>(const scenes::Scene&)>;

inline Make with(engines::MakeJoint make_joint) {
  return [=](const scenes::Scene& scene) { return engines::make_bullet(scene, 10, make_joint); };
}

inline double microseconds_per_step(const measures::Outcome& outcome) {
  return 1e6 * outcome.seconds / outcome.steps;
}

// Of a hinge against the ground about z: b's x axis.
inline double angle_about_z(const engines::State& state) {
  return std::atan2(state.pose(1, 0), state.pose(0, 0));
}

}  // namespace tables
