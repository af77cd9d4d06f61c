// A heavy door is thrown at a soft stop, with a draught that presses it on.
//
// The door's centre of mass is off its hinge: its inertia about the hinge, I, is four times that
// about its centre. It starts at angle 0 and feels a constant torque t. Beyond the stop, by x rad, the
// stop acts on it as a one-sided damped spring of frequency f and damping ratio z, with w = 2 pi f:
//   x'' = t / I - max(0, w^2 x + 2 z w x').
// The closed form is this, integrated by the midpoint rule in steps of 10 us. Without draught the
// farthest x is (x'_0 / w) exp(-z (pi/2 - asin z) / sqrt(1 - z^2)), for z < 1.

#include "catalog.h"

#include <algorithm>
#include <memory>

namespace scenes {
namespace {

constexpr double stop = pi / 2, speed = 3, draught = 30;  // rad, rad/s, N m
constexpr double sample = 1e-3;                           // s

// The door's angles, a sample after the other.
std::vector<double> course(double w, double z, double push, double seconds) {
  const auto acceleration = [&](double x, double v) {
    return x > 0 ? push - std::max(0., w * w * x + 2 * z * w * v) : push;
  };
  constexpr int steps = 100;
  constexpr double h = sample / steps;
  std::vector<double> angles = {0};
  double x = -stop, v = speed;
  while (double(angles.size() - 1) * sample <= seconds) {
    for (int step = 0; step < steps; ++step) {
      const double mid_x = x + h / 2 * v, mid_v = v + h / 2 * acceleration(x, v);
      x += h * mid_v;
      v += h * acceleration(mid_x, mid_v);
    }
    angles.push_back(stop + x);
  }
  return angles;
}

}  // namespace

Scene door_scene(double damping_ratio) {
  const double frequency = 3, arm = 0.45;  // Hz, m
  Scene scene{"door", "a door is thrown at a soft stop"};
  scene.show(Group::measured, "Door", "It is thrown at its springy stop.");
  Body panel = box(30, {arm, 0.02, 1}, {arm, 0, 0});
  spin(panel, {0, 0, speed}, {0, 0, 0});
  panel.torque = {0, 0, draught};
  const int moving = scene.add(panel);
  Joint& hinge = scene.connect(Kind::hinge, 0, moving, at({0, 0, 0}));
  hinge.range = {-0.95 * pi, stop};  // it never comes back to the lower one
  hinge.spring = {frequency, damping_ratio};
  scene.seconds = 10;
  scene.errors = {Error::trajectory, Error::gap};
  scene.compared = Compared::nowhere;
  scene.probe_body = moving;
  scene.probe = {1 - arm, 0, 0};  // 1 m off the axis: metres are radians
  scene.horizon = scene.seconds;
  const double inertia = panel.inertia.z() + panel.mass * arm * arm;
  scene.closed_form =
      [angles = std::make_shared<const std::vector<double>>(course(
           2 * pi * frequency, damping_ratio, draught / inertia, scene.seconds))](double time) {
        const double angle = (*angles)[size_t(std::lround(time / sample))];
        return Vector3d(std::cos(angle), std::sin(angle), 0);
      };
  return scene;
}

}  // namespace scenes
