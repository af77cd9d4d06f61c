// A wall of bricks in mortar: fixed joints that break where a ball of 300 kg strikes it.

#include <algorithm>

#include "catalog.h"

namespace scenes {

Scene brick_wall_scene() {
  constexpr int rows = 7, columns = 7;
  const Vector3d half(0.3, 0.15, 0.15);        // m
  const double brick_mass = 25, mortar = 400;  // kg; N s in a step

  Scene scene{"brick_wall", "a ball breaks a wall of bricks in mortar"};
  scene.show(
      Group::known, "Brick wall",
      "A ball of 300 kg at 12 m/s strikes a wall. Its mortar is joints that break by their load.");
  scene.bodies[0] = solid(box(0, {30, 30, 1}, {0, 0, -1}));
  const auto lay = [&](int a, int b, const Vector3d& point) {
    scene.connect(Kind::fixed, a, b, at(point)).breaks_at = mortar;
  };
  int below[columns] = {};
  for (int row = 0; row < rows; ++row) {
    int bricks[columns];
    const double shift = row % 2 == 0 ? -half.x() / 2 : half.x() / 2;  // a bond
    for (int i = 0; i < columns; ++i) {
      const Vector3d place((2 * i - columns + 1) * half.x() + shift, 0, (2 * row + 1) * half.z());
      bricks[i] = scene.add(solid(box(brick_mass, 0.97 * half, place)));
      if (i > 0) lay(bricks[i - 1], bricks[i], place - Vector3d(half.x(), 0, 0));
      const Vector3d under = place - Vector3d(0, 0, half.z());
      lay(row == 0 ? 0 : below[i], bricks[i], under + Vector3d(-shift, 0, 0));
      const int other = row % 2 == 0 ? i - 1 : i + 1;
      if (row > 0 && other >= 0 && other < columns)
        lay(below[other], bricks[i], under + Vector3d(shift, 0, 0));
    }
    std::copy(bricks, bricks + columns, below);
  }
  Body ball = solid(sphere(300, 0.4, {0.2, -5, 1.3}));
  ball.velocity = {0, 12, 2};
  scene.add(ball);
  scene.seconds = 2.5;
  scene.errors = {Error::gap, Error::axis, Error::gained};
  scene.energy_scale = 0.5 * 300 * 148;
  scene.compared = Compared::as_games_run;
  scene.in_gallery = false;
  return scene;
}

}  // namespace scenes
