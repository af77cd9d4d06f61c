// A box hangs by its end on a hinge whose axis is tilted out of the level, and swings.

#include "catalog.h"

namespace scenes {

Scene pendulum_scene(double amplitude, double tilt) {
  const double arm = 0.5;
  const Vector3d axis(0, std::cos(tilt), std::sin(tilt));
  const Vector3d lowest(0, std::sin(tilt), -std::cos(tilt));
  Eigen::Matrix3d hanging;  // x down, y along the axis
  hanging << lowest, axis, lowest.cross(axis);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(amplitude, axis) * hanging);

  Scene scene{"pendulum", "box on a tilted hinge, from 120 degrees"};
  scene.show(Group::measured, "Pendulum", "One link, swinging from 120 degrees on a tilted axis.");
  const int bob = scene.add(box(1, {arm, 0.1, 0.1}, turn * Vector3d(arm, 0, 0), turn));
  scene.connect(Kind::hinge, 0, bob, with_z({0, 0, 0}, axis));
  scene.errors = {Error::trajectory, Error::gap, Error::energy};
  scene.energy_scale = standard_gravity * std::cos(tilt) * arm * (1 - std::cos(amplitude));
  scene.probe_body = bob;
  scene.probe = {arm, 0, 0};
  scene.horizon = scene.seconds;
  return scene;
}

}  // namespace scenes
