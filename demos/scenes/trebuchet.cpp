// A trebuchet: a weight falls, and a light sling throws a stone. The sling lets go by a joint that breaks.

#include "catalog.h"

namespace scenes {

Scene trebuchet_scene() {
  constexpr int links = 4;                                // of the sling
  const double pivot = 5, long_arm = 6, short_arm = 1.6;  // m
  const double weight_mass = 1500, stone_mass = 40;       // kg
  const double sling = 4.8, drop = 1.2;                   // m, and the weight's below its hinge
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();

  Scene scene{"trebuchet", "1500 kg throw a stone of 40 kg"};
  scene.show(Group::known, "Trebuchet",
             "1500 kg fall, and a sling of four links throws a stone of 40 kg. Its last joint "
             "breaks by its load: it lets go.");
  scene.bodies[0] = solid(box(0, {150, 150, 1}, {0, 0, -1}));
  for (const double side : {-1., 1.}) {
    const Vector3d foot(0, 1.1 * side, 0);
    scene.add(box(0, {0.15, 0.12, pivot / 2 + 0.1}, foot + pivot / 2 * z));
    scene.add(box(0, {1.8, 0.12, 0.12}, foot + 0.12 * z));
  }
  // The arm's long end starts near the ground.
  const double rise = std::asin((pivot - 0.5) / long_arm);
  const Vector3d along(std::cos(rise), 0, std::sin(rise)), axle(0, 0, pivot);
  const Vector3d low = axle - long_arm * along, high = axle + short_arm * along;
  const int arm = scene.add(
      box(200, {(long_arm + short_arm) / 2, 0.12, 0.15}, (low + high) / 2, turn_between(x, along)));
  scene.connect(Kind::hinge, 0, arm, with_z(axle, y));
  const int weight = scene.add(box(weight_mass, {0.8, 0.8, 0.7}, high - drop * z));
  scene.connect(Kind::hinge, arm, weight, with_z(high, y));
  int last = arm;
  const double length = sling / links;
  Vector3d end = low;
  for (int i = 0; i < links; ++i) {
    // It lies along the ground, under the arm.
    const int link = scene.add(box(1, {length / 2, 0.1, 0.1}, end + length / 2 * x));
    scene.connect(Kind::ball, last, link, at(end));
    end += length * x;
    last = link;
  }
  Body stone = solid(sphere(stone_mass, 0.25, end + 0.25 * x));
  stone.friction = 0;
  scene.connect(Kind::ball, last, scene.add(stone), at(end)).breaks_at = 90;  // N s in a step
  scene.seconds = 5.5;
  scene.errors = {Error::gap, Error::axis, Error::gained};
  scene.energy_scale = weight_mass * standard_gravity * 2 * short_arm;
  scene.compared = Compared::as_games_run;
  return scene;
}

}  // namespace scenes
