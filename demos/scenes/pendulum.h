// A compound pendulum swings far: its period has a closed form at any amplitude.
//
// A box of half extents (0.5, 0.1, 0.1) m and 1 kg hangs by the end (-0.5, 0, 0) on a hinge to the
// world and is released at rest, `amplitude` away from its lowest position. The hinge axis is level
// for tilt 0; otherwise it is tilted out of the level by `tilt`, so that the hinge also carries a
// load along its axis, and only g cos(tilt) drives the swing.
//
// The exact period, with d = 0.5 m and I the moment of inertia about the hinge axis:
//   T = 2 pi sqrt(I / (m g cos(tilt) d)) / AGM(1, cos(amplitude / 2)),
// where AGM is the arithmetic-geometric mean: 4 K(sin(amplitude / 2)) in place of 2 pi, K the
// complete elliptic integral of the first kind.
//
// Measured:
//   period      mean over all full swings of the run, s; its error relative to T. A joint that
//               loses energy swings less far and so faster: the error is negative
//   gap         distance between the two anchors of the hinge, m
//   axis angle  angle between the two axes of the hinge, rad
//   energy      its largest change over the energy of the swing m g cos(tilt) d (1 - cos amplitude)

#pragma once

#include <algorithm>
#include <cmath>

#include "../measures/courses.h"
#include "catalog.h"
#include "world.h"

namespace scenes {

struct PendulumSettings {
  double amplitude = radians(120);  // rad, from the lowest position, below pi
  double tilt = radians(30);        // rad, of the hinge axis out of the level
  double dt = 1.0 / 60;             // s
  int iterations = 10;
  double seconds = 20;
  SolverFactory make_solver = {};
};

struct PendulumResult {
  double period = 0;            // s; 0: not one full swing
  double exact_period = 0;      // s
  double period_error = -1;     // relative, positive: too slow; -1: not one full swing
  double max_gap = 0;           // m
  double max_axis_angle = 0;    // rad
  double max_energy_error = 0;  // relative, absolute value
  bool finite = true;
  double microseconds_per_step = 0;  // wall-clock: does not repeat
};

inline double arithmetic_geometric_mean(double a, double b) {
  // Each round doubles the number of right digits.
  for (int i = 0; i < 8; ++i) {
    const double mean = (a + b) / 2;
    b = std::sqrt(a * b);
    a = mean;
  }
  return a;
}

// s; inertia about the hinge axis in kg m^2, torque = m g d in N m.
inline double pendulum_period(double inertia, double torque, double amplitude) {
  return 2 * pi * std::sqrt(inertia / torque) /
         arithmetic_geometric_mean(1, std::cos(amplitude / 2));
}

// `configure` is called with the hinge before the first step.
template <class Hinge, class Configure = AsConstructed>
PendulumResult pendulum(const PendulumSettings& settings, Configure configure = {}) {
  const Scene scene = pendulum_scene(settings.amplitude, settings.tilt);
  const Joint& joint = scene.joints[0];
  const Eigen::Vector3d anchor = joint.in_b.translation(), hinge_axis = joint.in_b.linear().col(2);
  const double arm = anchor.norm();

  // The swing's plane in the world: `down` is the lowest direction square to the axis.
  const Eigen::Vector3d axis = joint.in_a.linear().col(2);
  const Eigen::Vector3d up(0, 0, 1), down = (up.dot(axis) * axis - up).normalized();
  const Eigen::Vector3d side = axis.cross(down);

  World world(scene.gravity, settings.iterations, settings.make_solver);
  const std::vector<btRigidBody*> bodies = world.add_bodies(scene);
  btRigidBody& box = *bodies[size_t(joint.b)];
  configure(world.add_joint<Hinge>(box, to_bullet(anchor), to_bullet(hinge_axis)));

  const double inertia = double(box.getLocalInertia().y()) + arm * arm;
  const double torque = standard_gravity * std::cos(settings.tilt) * arm;
  const double start_energy = energy(box, standard_gravity);
  const double swing_energy = torque * (1 - std::cos(settings.amplitude));

  PendulumResult result;
  result.exact_period = pendulum_period(inertia, torque, settings.amplitude);
  measures::Period period(settings.amplitude);
  const int steps = int(std::lround(settings.seconds / settings.dt));
  for (int step = 1; step <= steps; ++step) {
    world.step(settings.dt);
    const Eigen::Vector3d arm_direction = direction_in_world(box, {1, 0, 0});
    const double angle = std::atan2(arm_direction.dot(side), arm_direction.dot(down));
    period.observe(step * settings.dt, angle);
    const double gap = point_in_world(box, anchor).norm();
    const double energy_error =
        std::abs(energy(box, standard_gravity) - start_energy) / swing_energy;
    result.finite = std::isfinite(gap) && std::isfinite(energy_error);
    if (!result.finite) break;
    result.max_gap = std::max(result.max_gap, gap);
    result.max_axis_angle =
        std::max(result.max_axis_angle, angle_between(direction_in_world(box, hinge_axis), axis));
    result.max_energy_error = std::max(result.max_energy_error, energy_error);
  }
  result.period = period.value();
  if (result.period > 0) result.period_error = result.period / result.exact_period - 1;
  result.microseconds_per_step = world.microseconds_per_step();
  return result;
}

}  // namespace scenes
