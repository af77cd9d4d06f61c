// A quarter of a car drops onto its springs: the tyre between ground and hub, the suspension
// between hub and chassis, each a slider with a spring; the wheel turns on the hub at 60 rad/s.

#include "catalog.h"

namespace scenes {

Scene suspension_scene() {
  const double hub_mass = 40, wheel_mass = 20, chassis_mass = 400;  // kg
  const double tyre_stiffness = 200e3, stiffness = 20e3;            // N/m
  const auto frequency = [](double k, double mass) { return std::sqrt(k / mass) / (2 * pi); };

  Scene scene{"suspension", "quarter car drops onto its springs"};
  scene.show(Group::measured, "Suspension", "A quarter of a car drops onto its springs.");
  const int hub = scene.add(box(hub_mass, {0.1, 0.1, 0.1}, {0, 0, 0.3}));
  Body wheel = box(wheel_mass, {0.3, 0.1, 0.3}, {0, 0, 0.3});
  wheel.angular_velocity = {0, 60, 0};
  const int turning = scene.add(wheel);
  const int chassis = scene.add(box(chassis_mass, {0.8, 0.6, 0.2}, {0, 0, 0.9}));
  const Vector3d up = Vector3d::UnitZ();
  scene.connect(Kind::slider, 0, hub, with_x({0, 0, 0.3}, up)).spring = {
      frequency(tyre_stiffness, hub_mass), 0.05};
  scene.connect(Kind::slider, hub, chassis, with_x({0, 0, 0.6}, up)).spring = {
      frequency(stiffness, 1 / (1 / hub_mass + 1 / chassis_mass)), 0.3};
  scene.connect(Kind::hinge, hub, turning, with_z({0, 0, 0.3}, Vector3d::UnitY()));
  scene.seconds = 3;
  scene.errors = {Error::trajectory, Error::gap};
  scene.probe_body = chassis;
  scene.horizon = scene.seconds;
  return scene;
}

}  // namespace scenes
