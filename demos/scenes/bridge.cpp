// Planks on hinges span a gap in an arc that sags, and three boxes fall on them.

#include "catalog.h"

namespace scenes {

Scene bridge_scene(int planks) {
  const double length = 0.2, thickness = 0.03, opening = radians(60);  // m, m, of the arc
  const double turn_of_plank = opening / planks;
  const double radius = length / (2 * std::sin(turn_of_plank / 2));
  // The end of the first i planks, on the arc about a point above the middle.
  const auto end = [&](double i) {
    const double angle = -opening / 2 + i * turn_of_plank;
    return Vector3d(radius * std::sin(angle), 0, -radius * std::cos(angle));
  };

  Scene scene{"bridge", std::to_string(planks) + " planks and three boxes, with contacts"};
  scene.show(Group::measured, "A long bridge", "A hundred planks and three boxes.");
  int last = 0;
  for (int i = 0; i < planks; ++i) {
    const Eigen::Quaterniond slope(
        Eigen::AngleAxisd(opening / 2 - (i + 0.5) * turn_of_plank, Vector3d::UnitY()));
    Body plank = box(10, {0.45 * length, 1, thickness}, (end(i) + end(i + 1)) / 2, slope);
    plank.collides = true;
    const int next = scene.add(plank);
    scene.connect(Kind::hinge, last, next, with_z(end(i), Vector3d::UnitY()));
    last = next;
  }
  scene.connect(Kind::hinge, 0, last, with_z(end(planks), Vector3d::UnitY()));
  for (const double place : {0.3, 0.5, 0.75}) {
    Body load = box(50, {0.3, 0.3, 0.3}, end(place * planks) + Vector3d(0, 0, 0.8));
    load.collides = true;
    scene.add(load);
  }
  scene.seconds = 2;
  scene.errors = {Error::gap};
  return scene;
}

}  // namespace scenes
