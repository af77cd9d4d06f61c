// What tests of ExactJointSolver's worlds have in common.
#pragma once

#include <pintle/solver/exact_joint_solver.h>

#include <scenes/world.h>

#include <memory>

#include "support.h"

namespace exact_support {

/// Stock joints are solved by the rows that they write themselves (upgraded_joints_test.cpp has the others).
inline std::unique_ptr<btConstraintSolver> exact() {
  auto solver = std::make_unique<pintle::ExactJointSolver>();
  solver->setUpgradesBulletJoints(false);
  return solver;
}

inline btTransform at(double x, double y, double z) {
  return scenes::pose_at(support::vec(x, y, z));
}

inline btTransform at(const btVector3& x, const btQuaternion& turn = btQuaternion::getIdentity()) {
  return btTransform(turn, x);
}

inline void addFloor(scenes::World& world) {
  world.add_box(0, support::vec(50, 50, 1), at(0, 0, -1), true);
}

}  // namespace exact_support
