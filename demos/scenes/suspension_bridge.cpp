// Four carts roll over a bridge, whose deck hangs by ropes from two cables between towers.

#include <algorithm>

#include "catalog.h"

namespace scenes {

Scene suspension_bridge_scene() {
  constexpr int planks = 16;
  const double length = 0.8, half_width = 1.1, sag = 2.2;  // m
  const double half = planks * length / 2, deck = 1.5,
               low = 2.1;  // m, heights of the deck and the cables' middle
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();

  Scene scene{"suspension_bridge", "a deck on ropes from two cables, and four carts"};
  scene.show(
      Group::known, "Suspension bridge",
      "Four carts of 150 kg roll over planks that hang by ropes from two cables of thin links.");
  // Nothing else steers the carts.
  constexpr double kerb_at = 0.95;  // m, from the middle
  const auto kerb = [](double mass, double half_length, const Vector3d& middle) {
    Body of = solid(box(mass, {half_length, 0.05, 0.1}, middle));
    of.friction = 0;
    return of;
  };
  for (const double side : {-1., 1.}) {  // banks and towers
    Body bank = solid(box(0, {4.5, 1.6, deck / 2}, {side * (half + 4.5), 0, deck / 2 - 0.05}));
    bank.friction = 0.9;
    scene.add(bank);
    for (const double across : {-1., 1.}) {
      scene.add(box(0, {0.12, 0.12, (low + sag) / 2},
                    {side * (half + 0.1), 1.35 * across, (low + sag) / 2}));
      scene.add(kerb(0, 4.5, {side * (half + 4.5), kerb_at * across, deck + 0.1}));
    }
  }
  int deck_of[planks], last = 0;
  for (int i = 0; i < planks; ++i) {
    const Vector3d start((i * length) - half, 0, deck - 0.05);
    deck_of[i] =
        scene.add(solid(box(80, {0.48 * length, half_width, 0.05}, start + length / 2 * x)));
    scene.connect(Kind::hinge, last, deck_of[i], with_z(start, y));
    last = deck_of[i];
    for (const double across : {-1., 1.}) {
      const Vector3d middle = start + length / 2 * x + kerb_at * across * y + 0.15 * z;
      scene.connect(Kind::fixed, last, scene.add(kerb(8, 0.48 * length, middle)), at(middle));
    }
  }
  scene.connect(Kind::hinge, 0, last, with_z({half, 0, deck - 0.05}, y));
  for (const double across : {-1., 1.}) {
    // A parabola. A link ends above the middle of each plank, where a rope hangs.
    const auto knot = [&](int i) {
      const double at_x = i == 0       ? -half
                          : i > planks ? half
                                       : (i - 0.5) * length - half,
                   part = at_x / half;
      return Vector3d(at_x, 1.35 * across, low + sag * part * part);
    };
    int link = 0;
    for (int i = 0; i <= planks; ++i) {
      const Vector3d along = knot(i + 1) - knot(i);
      const int next = scene.add(
          cylinder(3, 0.03, along.norm() / 2, knot(i) + along / 2, turn_between(z, along)));
      scene.connect(Kind::ball, link, next, at(knot(i)));
      link = next;
      if (i == planks) break;
      const Vector3d top = knot(i + 1), foot(top.x(), half_width * across, deck - 0.05);
      Joint& rope = scene.connect(Kind::distance, next, deck_of[i], at(top));
      rope.in_b = scene.bodies[size_t(deck_of[i])].pose.inverse() * at(foot);
      rope.range = {0, (top - foot).norm()};
    }
    scene.connect(Kind::ball, 0, link, at(knot(planks + 1)));
  }
  for (int i = 0; i < 4; ++i) {
    const Vector3d middle(-half - 0.9 - 1.3 * i, 0, deck + 0.42);
    const int cart = scene.add(solid(box(150, {0.45, 0.45, 0.15}, middle)));
    for (const double front : {-1., 1.}) {
      for (const double side : {-1., 1.}) {
        const Vector3d hub = middle + Vector3d(0.32 * front, 0.56 * side, -0.2);
        Body tyre = solid(cylinder(10, 0.2, 0.12, hub, turn_between(z, y)));
        tyre.friction = 0.9;
        scene.connect(Kind::hinge, cart, scene.add(tyre), with_z(hub, y)).motor = {
            [](double time) { return 12.5 * std::min(1., time / 2); }, 40};
      }
    }
  }
  scene.seconds = 9;
  scene.errors = {Error::gap, Error::axis, Error::overshoot};
  scene.compared = Compared::as_games_run;
  scene.in_gallery = false;
  return scene;
}

}  // namespace scenes
