// A load of 1000 kg swings on a rope of 20 links of 1 kg, from 20 degrees.

#include "catalog.h"

namespace scenes {

Scene crane_scene() {
  constexpr int links = 20;
  const double length = 0.5, load_mass = 1000, load_size = 0.5;  // m, kg, m
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(radians(20), Vector3d::UnitY()));
  const Vector3d along = turn * Vector3d(0, 0, -1);

  Scene scene{"crane", "load 1000:1 on a rope of 20 links"};
  scene.show(Group::known, "Crane", "A tonne on a rope of twenty links of a kilogram each.");
  for (int i = 0; i < links; ++i) {
    const Vector3d middle = (i + 0.5) * length * along;
    const int link = scene.add(box(1, {0.05, 0.05, length / 2}, middle, turn));
    scene.connect(Kind::ball, link - 1, link, at(i * length * along));
  }
  const Vector3d hook = links * length * along;
  const int load =
      scene.add(box(load_mass, Vector3d::Constant(load_size), hook + load_size * along, turn));
  scene.connect(Kind::ball, load - 1, load, at(hook));
  scene.errors = {Error::gap, Error::trajectory, Error::energy};
  scene.energy_scale = load_mass * standard_gravity * links * length * (1 - std::cos(radians(20)));
  scene.probe_body = load;
  scene.horizon = scene.seconds;
  return scene;
}

}  // namespace scenes
