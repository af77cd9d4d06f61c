// A ball of 50 kg falls into a net of knots on ball joints, which hangs in a frame.

#include "catalog.h"

namespace scenes {

Scene net_in_frame_scene() {
  constexpr int knots = 8;                                  // each way
  const double mesh = 0.4, sag = 0.7, height = 2.6;         // m
  const double half = mesh * (knots + 1) / 2, beam = 0.07;  // m
  const double ball_mass = 50, radius = 0.35, above = 1.2;  // kg, m, m

  Scene scene{"net", "50 kg fall into a net of 64 knots"};
  scene.show(
      Group::known, "Net",
      "A ball of 50 kg falls into a net of 64 knots of 500 g. All of its loops pull at once.");
  scene.bodies[0] = solid(box(0, {10, 10, 1}, {0, 0, -1}));
  for (const double side : {-1., 1.}) {
    scene.add(box(0, {half + 2 * beam, beam, beam}, {0, side * (half + beam), height}));
    scene.add(box(0, {beam, half + 2 * beam, beam}, {side * (half + beam), 0, height}));
    for (const double other : {-1., 1.})
      scene.add(box(0, {beam, beam, height / 2},
                    {side * (half + beam), other * (half + beam), height / 2 - beam}));
  }
  // Knot 0 and the one after the last are of the rim.
  const auto place = [&](int i, int j) {
    const double x = i * mesh - half, y = j * mesh - half, u = x / half, v = y / half;
    return Vector3d(x, y, height - sag * (1 - u * u) * (1 - v * v));
  };
  int index[knots + 2][knots + 2] = {};
  const auto tie = [&](int i, int j, int k, int l) {  // at the rim, or in the middle of two
    const bool rim = index[i][j] == 0 || index[k][l] == 0;
    const Vector3d end = index[i][j] == 0 ? place(i, j) : place(k, l);
    scene.connect(Kind::ball, index[i][j], index[k][l],
                  at(rim ? end : (place(i, j) + place(k, l)) / 2));
  };
  for (int i = 1; i <= knots; ++i) {
    for (int j = 1; j <= knots; ++j)
      index[i][j] = scene.add(solid(box(0.5, {0.13, 0.13, 0.03}, place(i, j))));
  }
  for (int i = 1; i <= knots + 1; ++i) {
    for (int j = 1; j <= knots; ++j) {
      if (index[i - 1][j] + index[i][j] > 0) tie(i - 1, j, i, j);
      if (index[j][i - 1] + index[j][i] > 0) tie(j, i - 1, j, i);
    }
  }
  scene.add(solid(sphere(ball_mass, radius, {0.1, -0.15, height + above})));
  scene.seconds = 3.5;
  scene.errors = {Error::gap, Error::gained};
  scene.energy_scale = ball_mass * standard_gravity * (above + sag);
  scene.in_gallery = false;
  return scene;
}

}  // namespace scenes
