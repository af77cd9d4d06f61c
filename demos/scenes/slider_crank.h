// A motor turns a crank at constant speed; a rod drives a piston along its slider. The piston's
// position has a closed form.
//
// In the plane y = 0, gravity along it: the crank (0.3 m, 1 kg) turns about y on a hinge to the world,
// the rod (0.9 m, 1 kg) is held by two ball joints, and the piston (2 kg) slides along x on a
// slider to the world. A loop: three kinds of joint hold each other. All start in the motion that
// they are to have.
//
// With the crank at w t from the axis,
//   x(t) = r cos(w t) + sqrt(l^2 - r^2 sin^2(w t)).
//
// Measured:
//   piston   the largest difference of the piston from x(t), m
//   reading  the same of the slider's own position (stock's is that of the step before)
//   gap      the largest distance between the two anchors of a pin, or of the piston from its axis, m
//   crank    the largest difference of the crank from w t, rad

#pragma once

#include <algorithm>
#include <cmath>

#include "catalog.h"
#include "world.h"

namespace scenes {

struct SliderCrankSettings {
  double speed = 2 * pi;  // rad/s, of the crank
  double crank = 0.3;     // m
  double rod = 0.9;       // m, longer than the crank
  double dt = 1.0 / 60;   // s
  int iterations = 10;
  double seconds = 5;
  SolverFactory make_solver = {};
};

struct SliderCrankResult {
  double max_piston_error = 0;   // m
  double max_reading_error = 0;  // m
  double max_gap = 0;            // m
  double max_crank_error = 0;    // rad
  bool finite = true;
  double microseconds_per_step = 0;  // wall-clock: does not repeat
};

inline double slider_crank_position(const SliderCrankSettings& settings, double angle) {
  const double across = settings.crank * std::sin(angle);
  return settings.crank * std::cos(angle) +
         std::sqrt(settings.rod * settings.rod - across * across);
}

template <class Hinge, class Ball, class Slider>
SliderCrankResult slider_crank(const SliderCrankSettings& settings) {
  const double r = settings.crank, l = settings.rod, w = settings.speed;
  World world(standard_gravity, settings.iterations, settings.make_solver);
  const Scene scene = slider_crank_scene(w, r, l);
  const std::vector<btRigidBody*> bodies = world.add_bodies(scene);
  btRigidBody &ground = *bodies[0], &crank = *bodies[1], &rod = *bodies[2], &piston = *bodies[3];
  const auto frame_a = [&](int joint) { return to_bullet(scene.joints[size_t(joint)].in_a); };
  const auto frame_b = [&](int joint) { return to_bullet(scene.joints[size_t(joint)].in_b); };
  Hinge& hinge = world.add_joint<Hinge>(ground, crank, frame_a(0), frame_b(0), true);
  hinge.enableAngularMotor(true, btScalar(w), btScalar(1000));
  world.add_joint<Ball>(crank, rod, frame_a(1).getOrigin(), frame_b(1).getOrigin());
  world.add_joint<Ball>(rod, piston, frame_a(2).getOrigin(), frame_b(2).getOrigin());
  Slider& slider = world.add_joint<Slider>(ground, piston, frame_a(3), frame_b(3), true);

  SliderCrankResult result;
  Unwrap unwrap(0);
  const auto gap = [](const btRigidBody& a, double x_a, const btRigidBody& b, double x_b) {
    return (point_in_world(a, {x_a, 0, 0}) - point_in_world(b, {x_b, 0, 0})).norm();
  };
  const int steps = int(std::lround(settings.seconds / settings.dt));
  for (int step = 1; step <= steps; ++step) {
    world.step(settings.dt);
    const double angle = w * settings.dt * step;
    const Eigen::Vector3d p = position(piston), arm = direction_in_world(crank, {1, 0, 0});
    result.finite = p.allFinite();
    if (!result.finite) break;
    const double right = slider_crank_position(settings, angle);
    const double off = std::hypot(p.y(), p.z());
    result.max_piston_error = std::max(result.max_piston_error, std::abs(p.x() - right));
    result.max_reading_error =
        std::max(result.max_reading_error, std::abs(double(slider.getLinearPos()) - right));
    result.max_gap = std::max({result.max_gap, off, gap(ground, 0, crank, -r / 2),
                               gap(crank, r / 2, rod, -l / 2), gap(rod, l / 2, piston, 0)});
    result.max_crank_error =
        std::max(result.max_crank_error, std::abs(unwrap(std::atan2(arm.z(), arm.x())) - angle));
  }
  result.microseconds_per_step = world.microseconds_per_step();
  return result;
}

}  // namespace scenes
