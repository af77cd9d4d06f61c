// A chain of boxes hangs on hinges from the origin, and falls from horizontal.
//
// N boxes of half extents (0.5, 0.1, 0.1) m lie in a line along +x. Each has mass 1 kg, but the
// last has mass `ratio`. Hinge i stands at x = i; its axis is (0, 1, 0) for even i and
// (0, 0.8, 0.6) for odd i, so that the chain leaves its plane. Hinge 0 holds the first box to the
// world.
//
// Measured, over all hinges after each step:
//   gap         distance between the two anchors of a hinge, m
//   axis angle  angle between the two axes of a hinge, rad
//   energy      its change since the start over g N^2/2, the height energy of N unit links. Bullet's
//               velocities are those of the middle of a step, and lag behind its positions: energy that is
//               taken of both as they stand errs by half a step's exchange. `in step` is that of the
//               velocity where it belongs, dt v / 2 before the position.
//   tip         centre of the last box at the end, m
// An ideal hinge has gap and axis angle 0; the energy would stay. Heavy tips (large ratio) and few
// iterations are hard for an iterative solver.

#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "catalog.h"
#include "world.h"

namespace scenes {

struct ChainSettings {
  int links = 10;        // N
  double ratio = 1;      // mass of the last link, kg
  double dt = 1.0 / 60;  // s
  int iterations = 10;   // of the solver
  double seconds = 5;    // duration of the run
  SolverFactory make_solver = {};
};

struct ChainResult {
  double mean_gap = 0;              // m: the mean over all steps of the step's largest gap
  double max_gap = 0;               // m
  double max_axis_angle = 0;        // rad
  double max_energy_error = 0;      // relative, absolute value
  double end_energy_error = 0;      // relative, positive: gained energy
  double in_step_energy_error = 0;  // relative, the largest absolute value, in step
  double energy_gain = 0;           // in step, above the start, over the largest exchange of energy
  double start_gap = 0;             // m: 0, but for rounding
  double start_axis_angle = 0;      // rad: 0, but for rounding
  Eigen::Vector3d tip = {0, 0, 0};  // m
  bool finite = true;               // false: the run ended in NaN or infinity
  double microseconds_per_step = 0;  // wall-clock: does not repeat
};

struct ChainErrors {
  double gap = 0;
  double axis_angle = 0;
};

// The largest gap and axis angle in the chain as it stands.
inline ChainErrors chain_errors(const Scene& scene, const std::vector<btRigidBody*>& bodies) {
  ChainErrors errors;
  for (const Joint& joint : scene.joints) {
    const btRigidBody &a = *bodies[size_t(joint.a)], &b = *bodies[size_t(joint.b)];
    const double gap =
        (point_in_world(b, joint.in_b.translation()) - point_in_world(a, joint.in_a.translation()))
            .norm();
    const double angle = angle_between(direction_in_world(b, joint.in_b.linear().col(2)),
                                       direction_in_world(a, joint.in_a.linear().col(2)));
    if (!std::isfinite(gap) || !std::isfinite(angle)) return {HUGE_VAL, HUGE_VAL};
    errors.gap = std::max(errors.gap, gap);
    errors.axis_angle = std::max(errors.axis_angle, angle);
  }
  return errors;
}

// `configure` is called with each hinge before the first step.
template <class Hinge, class Configure = AsConstructed>
ChainResult chain(const ChainSettings& settings, Configure configure = {}) {
  World world(standard_gravity, settings.iterations, settings.make_solver);
  const Scene scene = chain_scene(settings.links, settings.ratio);
  const std::vector<btRigidBody*> bodies = world.add_bodies(scene);
  const std::vector<btRigidBody*> links(bodies.begin() + 1, bodies.end());
  for (const Joint& joint : scene.joints) configure(world.add_joint_of<Hinge>(joint, bodies));

  const auto total_energy = [&links] {
    double sum = 0;
    for (const btRigidBody* link : links) sum += energy(*link, standard_gravity);
    return sum;
  };
  const auto kinetic_energy = [&links] {
    double sum = 0;
    for (const btRigidBody* link : links) sum += energy(*link, 0);
    return sum;
  };
  const auto lifting_power = [&links] {  // W: of velocities against gravity
    double sum = 0;
    for (const btRigidBody* link : links)
      sum += standard_gravity * double(link->getLinearVelocity().z() / link->getInvMass());
    return sum;
  };
  const double energy_scale = standard_gravity * settings.links * settings.links / 2;
  const double start_energy = total_energy();

  ChainResult result;
  const ChainErrors start = chain_errors(scene, bodies);
  result.start_gap = start.gap;
  result.start_axis_angle = start.axis_angle;
  const int steps = int(std::lround(settings.seconds / settings.dt));
  const double start_height = start_energy - kinetic_energy();
  double start_in_step = 0, exchange = 0, gain = 0;
  for (int step = 0; step < steps; ++step) {
    world.step(settings.dt);
    const double now = total_energy(), height = now - kinetic_energy(),
                 in_step = now - settings.dt / 2 * lifting_power();
    if (step == 0) start_in_step = in_step;
    result.in_step_energy_error =
        std::max(result.in_step_energy_error, std::abs(in_step - start_in_step) / energy_scale);
    exchange = std::max(exchange, std::abs(height - start_height));
    gain = std::max(gain, in_step - start_in_step);
    const ChainErrors errors = chain_errors(scene, bodies);
    result.mean_gap += errors.gap / steps;
    result.max_gap = std::max(result.max_gap, errors.gap);
    result.max_axis_angle = std::max(result.max_axis_angle, errors.axis_angle);
    result.end_energy_error = (total_energy() - start_energy) / energy_scale;
    result.max_energy_error = std::max(result.max_energy_error, std::abs(result.end_energy_error));
    result.finite = std::isfinite(errors.gap) && std::isfinite(result.end_energy_error);
    if (!result.finite) break;
  }
  result.energy_gain = exchange > 0 ? gain / exchange : 0;
  result.tip = position(*links.back());
  result.microseconds_per_step = world.microseconds_per_step();
  return result;
}

}  // namespace scenes
