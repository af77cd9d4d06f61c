// An arm of six motors carries a load through the air.

#include "catalog.h"

namespace scenes {

Scene robot_arm_scene() {
  Scene scene{"robot_arm", "six motors move a load"};
  scene.show(Group::known, "Robot arm", "Six motors move a load of 30 kg.");
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  // Each turns back and forth at a rhythm of its own.
  const auto drive = [](Joint& joint, double amplitude, double period, double torque) {
    joint.motor = {
        [=](double time) { return amplitude * 2 * pi / period * std::cos(2 * pi * time / period); },
        torque};
  };
  const int base = scene.add(cylinder(40, 0.24, 0.16, {0, 0, 0.22}));
  scene.add(cylinder(0, 0.3, 0.03, {0, 0, 0.03}));  // its foot
  const int shoulder = scene.add(box(25, {0.13, 0.2, 0.17}, {0, 0, 0.55}));
  const int upper = scene.add(box(18, {0.09, 0.09, 0.42}, {0, 0, 1.14}));
  const int fore = scene.add(box(9, {0.37, 0.065, 0.065}, {0.44, 0, 1.6}));
  const int wrist = scene.add(cylinder(3, 0.06, 0.09, {0.92, 0, 1.6}, turn_between(z, x)));
  const int hand = scene.add(box(2, {0.06, 0.1, 0.04}, {1.09, 0, 1.6}));
  const int load = scene.add(box(30, {0.16, 0.16, 0.16}, {1.31, 0, 1.6}));
  drive(scene.connect(Kind::hinge, 0, base, with_z({0, 0, 0.06}, z)), 1.1, 5, 4000);
  drive(scene.connect(Kind::hinge, base, shoulder, with_z({0, 0, 0.38}, z)), 0.4, 2.5, 3000);
  drive(scene.connect(Kind::hinge, shoulder, upper, with_z({0, 0, 0.72}, y)), 0.5, 4, 4000);
  drive(scene.connect(Kind::hinge, upper, fore, with_z({0, 0, 1.6}, y)), -0.7, 3, 3000);
  drive(scene.connect(Kind::hinge, fore, wrist, with_z({0.82, 0, 1.6}, x)), 1.5, 2, 1500);
  drive(scene.connect(Kind::hinge, wrist, hand, with_z({1.02, 0, 1.6}, y)), 0.8, 2.2, 1500);
  scene.connect(Kind::fixed, hand, load, at({1.15, 0, 1.6}));
  scene.seconds = 6;
  scene.errors = {Error::gap, Error::axis};
  scene.compared = Compared::as_games_run;
  return scene;
}

}  // namespace scenes
