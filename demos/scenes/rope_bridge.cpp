// Crates and a safe fall on a rope bridge of planks on hinges.

#include "catalog.h"

namespace scenes {

Scene rope_bridge_scene() {
  constexpr int planks = 18;
  const double length = 0.4, sag = 0.06;  // m, of a plank; of the span
  const double span = planks * length, height = 2.2;

  Scene scene{"rope_bridge", "crates and a safe fall on a bridge of planks"};
  scene.show(Group::known, "Rope bridge",
             "Crates, then a safe of 400 kg. Watch the planks come apart, or not.");
  scene.bodies[0].half_extents = {20, 20, 1};
  scene.bodies[0].pose = at({0, 0, -1});
  scene.bodies[0].collides = true;
  // A parabola through both ends.
  const auto end = [&](int i) {
    const double x = -span / 2 + i * length, part = 2 * x / span;
    return Vector3d(x, 0, height - sag * span * (1 - part * part));
  };
  for (const double side : {-1., 1.})
    scene.add(solid(
        box(0, {0.5, 0.9, height / 2 + 0.04}, {side * (span / 2 + 0.52), 0, height / 2 - 0.04})));
  int last = 0;
  for (int i = 0; i < planks; ++i) {
    const Vector3d along = end(i + 1) - end(i);
    const int plank = scene.add(solid(box(6, {0.46 * along.norm(), 0.7, 0.035}, end(i) + along / 2,
                                          turn_between(Vector3d::UnitX(), along))));
    scene.connect(Kind::hinge, last, plank, with_z(end(i), Vector3d::UnitY()));
    last = plank;
  }
  scene.connect(Kind::hinge, 0, last, with_z(end(planks), Vector3d::UnitY()));
  const double crates[][3] = {{-2.2, 25, 0.22}, {-1.1, 40, 0.28}, {0.9, 25, 0.22}, {2.1, 40, 0.26}};
  for (const auto& [x, mass, half] : crates)
    scene.add(solid(box(mass, Vector3d::Constant(half), {x, 0.1 * x, height + 0.35 + 0.1 * half})));
  scene.add(solid(box(400, {0.33, 0.3, 0.4}, {-0.1, 0, height + 1.6})));
  scene.seconds = 5;
  scene.errors = {Error::gap, Error::axis};
  scene.compared = Compared::as_games_run;
  return scene;
}

}  // namespace scenes
