// Joints under conditions that no scene should have: a rig of two bodies on two joints of a kind,
// with one thing about it extreme.

#pragma once

#include <functional>
#include <string>
#include <vector>

#include "../engines/bullet.h"

namespace extreme {

struct Case {
  std::string joint;  // the rig
  std::string what;   // is extreme
  scenes::Scene scene;
  double size = 1;      // m: what a gap is compared with
  double speed = 1;     // m/s: the most that gravity, start and impulses account for
  double dt = 1. / 60;  // s
  int iterations = 10;
  bool is_long = false;  // takes seconds: not in the tests
  // Before the first step, and before every step.
  std::function<void(engines::BulletEngine&)> prepare = {};
  std::function<void(engines::BulletEngine&, int step)> act = {};
  std::string name() const { return joint + ", " + what; }
};

std::vector<Case> cases();

}  // namespace extreme
