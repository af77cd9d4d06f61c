// A ball of two tonnes on a light chain swings into a wall.

#include "catalog.h"

namespace scenes {

Scene wrecking_ball_scene() {
  constexpr int links = 10;
  constexpr double link_mass = 3;                                          // kg
  const double length = 0.42, ball_mass = 670 * link_mass, radius = 0.55;  // m, kg, m
  const Vector3d top(0, 0, 6.2);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(radians(68), Vector3d::UnitY()));
  const Vector3d along = turn * Vector3d(0, 0, -1);

  Scene scene{"wrecking_ball", "two tonnes on a chain of 30 kg against a wall"};
  scene.show(Group::known, "Wrecking ball", "Two tonnes on a light chain swing into a wall.");
  scene.bodies[0].half_extents = {20, 20, 1};
  scene.bodies[0].pose = at({0, 0, -1});
  scene.bodies[0].collides = true;
  scene.add(box(0, {0.12, 1.6, 0.12}, top + Vector3d(0, 1.48, 0.12)));  // a beam
  scene.add(box(0, {0.15, 0.15, 3.22}, {0, 3.1, 3.1}));
  int last = 0;
  for (int i = 0; i < links; ++i) {
    const int link = scene.add(cylinder(link_mass, i % 2 == 0 ? 0.05 : 0.065, 0.46 * length,
                                        top + (i + 0.5) * length * along, turn));
    scene.connect(Kind::ball, last, link, at(top + i * length * along));
    last = link;
  }
  const Vector3d hook = top + links * length * along;
  const int ball = scene.add(solid(sphere(ball_mass, radius, hook + radius * along)));
  scene.connect(Kind::ball, last, ball, at(hook));
  // Bricks in a bond.
  for (int row = 0; row < 6; ++row) {
    for (int i = 0; i < 4; ++i) {
      const double y = (i - 1.5) * 0.82 + (row % 2 == 0 ? -0.2 : 0.2);
      scene.add(solid(box(30, {0.2, 0.4, 0.2}, {1.1, y, 0.2 + 0.4 * row})));
    }
  }
  scene.seconds = 5;
  scene.errors = {Error::gap};
  scene.compared = Compared::as_games_run;
  return scene;
}

}  // namespace scenes
