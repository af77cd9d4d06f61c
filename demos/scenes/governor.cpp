// A flyball governor swings while it turns: two rods on a shaft, a weight at the end of each, and a
// slider that hangs on their middles by stiff springs with dampers. Problem A05 of the IFToMM
// library of multibody benchmarks.

#include "catalog.h"

namespace scenes {

Scene governor_scene() {
  const double density = 3000, length = 1, thickness = 0.01, size = 0.1;  // kg/m^3, m
  const double stiffness = 8e5, damping = 4e4, rest = 0.5;                // N/m, N s/m, m
  const double below = radians(30);  // of the rods, below the horizontal
  const double rod_mass = density * length * thickness * thickness,
               slider_mass = density * size * size * size;
  const double reduced_mass = 1 / (1 / rod_mass + 1 / slider_mass);
  const Spring spring = {std::sqrt(stiffness / reduced_mass) / (2 * pi),
                         damping / (2 * std::sqrt(stiffness * reduced_mass))};

  Scene scene{"governor", "stiff flyball governor"};
  scene.problem = "IFToMM A05";
  scene.show(Group::measured, "Governor", "Weights on a shaft lift a slider by stiff springs.");
  const auto turning = [&](Body body) {
    spin(body, {0, 0, 2 * pi}, {0, 0, 0});
    return scene.add(body);
  };
  const Vector3d half(thickness / 2, thickness / 2, length / 2), up = Vector3d::UnitZ();
  const Vector3d middle(0, 0, length / 2), top(0, 0, length);
  const int shaft = turning(box(rod_mass, half, middle));
  const int slider = turning(box(slider_mass, Vector3d::Constant(size / 2), middle));
  scene.connect(Kind::hinge, 0, shaft, at({0, 0, 0}));
  scene.connect(Kind::slider, shaft, slider, with_x(middle, up));
  for (const double side : {1., -1.}) {
    const Vector3d out(side * size / 2, 0, 0), along(side * std::cos(below), 0, -std::sin(below));
    const Vector3d pin = top + out;
    const int rod = turning(box(rod_mass, half, pin + length / 2 * along, turn_between(up, along)));
    // On a ball joint in its centre it is a mass in a point.
    const int weight = turning(sphere(5, size / 2, pin + length * along));
    scene.connect(Kind::hinge, shaft, rod, with_z(pin, Vector3d::UnitY()));
    scene.connect(Kind::ball, rod, weight, at(pin + length * along));
    Joint& coupler = scene.connect(Kind::distance, slider, rod, at(middle + out));
    coupler.in_b.setIdentity();
    coupler.range = {rest, rest};
    coupler.spring = spring;
  }
  scene.gravity = 9.81;
  scene.seconds = 10;
  scene.errors = {Error::trajectory, Error::gap};
  scene.compared = Compared::nowhere;  // Bullet has no joint for it
  scene.probe_body = slider;
  scene.horizon = scene.seconds;
  return scene;
}

}  // namespace scenes
