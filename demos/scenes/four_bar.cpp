// A parallel linkage hangs and swings from 60 degrees: a coupler on three cranks, where two would
// do, so that the third one closes a redundant loop. All hinges are parallel.

#include "catalog.h"

namespace scenes {

Scene four_bar_scene() {
  const double length = 1, amplitude = radians(60);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(-amplitude, Vector3d::UnitY()));
  const Vector3d along = turn * Vector3d(0, 0, -length);

  Scene scene{"four_bar", "parallel linkage with a redundant crank"};
  scene.show(Group::measured, "Four-bar linkage", "A closed loop of hinges.");
  const int coupler = scene.add(box(2, {length, 0.05, 0.05}, along));
  for (const double x : {-length, 0., length}) {
    const Vector3d foot(x, 0, 0);
    const int crank = scene.add(box(1, {0.05, 0.05, length / 2}, foot + along / 2, turn));
    scene.connect(Kind::hinge, 0, crank, with_z(foot, Vector3d::UnitY()));
    scene.connect(Kind::hinge, crank, coupler, with_z(foot + along, Vector3d::UnitY()));
  }
  scene.errors = {Error::trajectory, Error::gap, Error::energy};
  scene.energy_scale = 3.5 * standard_gravity * length * (1 - std::cos(amplitude));
  scene.probe_body = coupler;
  scene.horizon = scene.seconds;
  return scene;
}

}  // namespace scenes
