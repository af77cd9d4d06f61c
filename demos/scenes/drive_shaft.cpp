// A motor turns a shaft, and a universal or constant velocity joint turns a second one at an angle to
// it. Both shafts turn on hinges to the ground and meet in the origin.
//
// A constant velocity joint has out = th. A universal joint with axis 1 normal to both shafts at
// first has out = atan2(cos b sin th, cos th), bend b.

#include "catalog.h"

namespace scenes {

Scene drive_shaft_scene(Kind coupling, double bend, double rpm) {
  const bool universal = coupling == Kind::universal;
  const double speed = rpm * 2 * pi / 60;  // rad/s
  const Isometry3d bent(Eigen::AngleAxisd(bend, Vector3d::UnitZ()));
  const Vector3d along_first(1, 0, 0), along_second = bent * along_first;

  Scene scene;
  scene.name = universal ? "drive_shaft" : "constant_velocity";
  scene.title = std::string(universal ? "universal" : "constant velocity") + " joint at " +
                std::to_string(int(std::lround(degrees(bend)))) + " degrees, " +
                std::to_string(int(std::lround(rpm))) + " rpm";
  if (universal) {
    scene.show(Group::known, "Drive shaft", "A universal joint at 30 degrees and 300 rpm.");
  } else {
    scene.show(
        Group::wrong, "A shaft that ripples",
        "Bullet has no constant velocity joint: its universal joint speeds up and slows down "
        "twice a turn. Look at the distance from the true path.");
    scene.mended = {Error::trajectory, 0.03, 1e-3};
  }
  scene.gravity = 0;
  Body first_shaft = box(1, {0.5, 0.1, 0.1}, -0.5 * along_first);
  Body second_shaft =
      box(1, {0.5, 0.1, 0.1}, 0.5 * along_second, Eigen::Quaterniond(bent.rotation()));
  first_shaft.angular_velocity = speed * along_first;
  second_shaft.angular_velocity = (universal ? std::cos(bend) : 1) * speed * along_second;
  const int first = scene.add(first_shaft), second = scene.add(second_shaft);
  scene.connect(Kind::hinge, 0, first, with_z({-0.5, 0, 0}, along_first)).motor = {
      [speed](double) { return speed; }, 1e4};
  scene.connect(Kind::hinge, 0, second, with_z(0.5 * along_second, along_second));
  if (universal) {
    scene.connect(coupling, first, second, bent);  // z across the first, y across the second
  } else {
    Joint& joint = scene.connect(coupling, first, second, at({0, 0, 0}));
    joint.in_b = scene.bodies[second].pose.inverse() * bent;
  }
  scene.seconds = 2;
  scene.errors = {Error::trajectory, Error::axis};
  scene.probe_body = second;
  scene.probe = {0, 1, 0};  // 1 m off the axis: metres are radians
  scene.horizon = scene.seconds;
  scene.closed_form = [=](double time) -> Vector3d {
    const double th = speed * time;
    const double out = universal ? std::atan2(std::cos(bend) * std::sin(th), std::cos(th)) : th;
    return bent * Vector3d(0.5, std::cos(out), std::sin(out));
  };
  return scene;
}

}  // namespace scenes
