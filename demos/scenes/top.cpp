// A top spins at 300 rad/s on a ball joint, 30 degrees off upright, and precesses.

#include "catalog.h"

namespace scenes {

Scene top_scene() {
  const double height = 0.15, speed = 300;
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(radians(30), Vector3d::UnitY()));
  const Vector3d axis = turn * Vector3d::UnitZ();

  Scene scene{"top", "spins at 300 rad/s on a ball joint"};
  scene.show(Group::measured, "Top", "A heavy top on a ball joint.");
  Body disc = round(box(1, {0.1, 0.1, 0.02}, height * axis, turn), 0.11);
  spin(disc, speed * axis, {0, 0, 0});
  const int moving = scene.add(disc);
  scene.connect(Kind::ball, 0, moving, at({0, 0, 0}));
  scene.errors = {Error::trajectory, Error::gap, Error::energy};
  scene.energy_scale = 0.5 * disc.inertia.z() * speed * speed;
  scene.probe_body = moving;
  scene.horizon = scene.seconds;
  return scene;
}

}  // namespace scenes
