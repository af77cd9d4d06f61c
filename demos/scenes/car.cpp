// A car drives over a bumpy road: each wheel turns on a hinge, and its hub slides on a spring.

#include "catalog.h"

namespace scenes {

Scene car_scene() {
  const double wheel_radius = 0.34, track = 0.86, base = 1.3;  // m
  const double speed = 16;                                     // rad/s, of the driven wheels

  Scene scene{"car", "springs, wheels and a motor over bumps"};
  scene.show(Group::known, "Car", "Springs, axles and a motor over bumps.");
  scene.bodies[0].half_extents = {60, 60, 1};
  scene.bodies[0].pose = at({0, 0, -1});
  scene.bodies[0].collides = true;
  const Vector3d y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  for (int i = 0; i < 9; ++i) {  // half logs, to the left and to the right by turns
    const double side = i % 3 == 0 ? 0 : i % 2 == 0 ? 0.9 : -0.9;
    scene.add(solid(cylinder(0, 0.22, side == 0 ? 1.9 : 0.8, {4.2 + 1.7 * i, side, -0.11},
                             turn_between(z, y))));
  }

  const int chassis = scene.add(solid(box(900, {2.0, 0.6, 0.22}, {0, 0, 0.78})));
  const int cabin = scene.add(solid(box(120, {0.85, 0.55, 0.24}, {-0.25, 0, 1.26})));
  scene.connect(Kind::fixed, chassis, cabin, at({-0.25, 0, 1.0}));
  for (const double x : {-base, base}) {
    for (const double side : {-track, track}) {
      const Vector3d centre(x, side, wheel_radius + 0.01);
      const int hub = scene.add(box(25, {0.1, 0.09, 0.1}, centre));
      const int wheel =
          scene.add(solid(cylinder(20, wheel_radius, 0.12, centre, turn_between(z, y))));
      Joint& strut = scene.connect(Kind::slider, chassis, hub, with_x(centre, z));
      strut.spring = {1.6 * std::sqrt(900. / 4 / 25), 0.35};  // of a quarter of the car on a hub
      Joint& axle = scene.connect(Kind::hinge, hub, wheel, with_z(centre, y));
      if (x < 0) axle.motor = {[=](double time) { return speed * std::min(1., time / 1.5); }, 450};
    }
  }
  scene.seconds = 6;
  scene.errors = {Error::gap, Error::axis};
  scene.compared = Compared::as_games_run;
  return scene;
}

}  // namespace scenes
