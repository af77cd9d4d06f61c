// A weight on a rod, and on a rope that is slack at first.
//
// A cube of 2 kg and 0.1 m hangs 1 m below a point. Stock joints have no distance: they make a rod of
// a stick and a rope of ten, each stick 1 % of the weight's mass, with ball joints between. (A stick
// on its own changes the period by -8e-4: its mass is no part of the closed form.)
//
// Rod: released from `amplitude`. Measured:
//   period      mean over all full swings of 20 s, relative to the closed form (pendulum.h) of a
//               point mass
//   stretch     the largest difference between the distance and 1 m
//   energy      its largest change, over that of the swing
// Rope: released at rest 0.3 m beside the point, so that it falls, goes taut, and swings. Measured:
//   stretch     how much longer than 1 m it is at most
//   gain        energy that it has at most above that of the start, over m g 1 m. (Bullet counts a
//               step's kinetic energy before its height: half a step's motion, 0.03 here, is no gain)
// Ideal: 0.

#pragma once

#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>

#include <algorithm>
#include <cmath>

#include "pendulum.h"
#include "world.h"

namespace scenes {

struct RopeSettings {
  bool slack = false;              // a rope, slack at first; else a rod
  double amplitude = radians(60);  // rad, of the rod's swing
  double dt = 1.0 / 60;            // s
  int iterations = 10;
  double seconds = 20;
  SolverFactory make_solver = {};
};

struct RopeResult {
  double period_error = -1;  // relative, positive: too slow; -1: not one full swing
  double max_stretch = 0;    // m
  double energy_error = 0;  // relative: of the rod the largest change, of the rope the largest gain
  bool finite = true;
  double microseconds_per_step = 0;  // wall-clock: does not repeat
};

// Hangs `weight` on the origin, as a rod or a rope of 1 m.
template <class Joint>
void suspend(World& world, btRigidBody& fixed, btRigidBody& weight, bool slack) {
  const btVector3 centre(0, 0, 0);
  if constexpr (std::is_same_v<Joint, btPoint2PointConstraint>) {
    // Sticks in zigzag from the point to the weight, each half as long as it is wide at the joints.
    const int sticks = slack ? 10 : 1;
    const double length = 1.0 / sticks;
    const Eigen::Vector3d way = position(weight) / sticks;
    const Eigen::Vector3d side =
        Eigen::Vector3d(0, 1, 0) * std::sqrt(std::max(0., length * length - way.squaredNorm()));
    btRigidBody* last = &fixed;
    btVector3 end = centre;
    const btVector3 half(btScalar(length / 2), btScalar(0.01), btScalar(0.01));
    for (int i = 0; i < sticks; ++i) {
      const Eigen::Vector3d along = way + (i % 2 == 0 ? 1 : -1) * side;
      const Eigen::Vector3d from = i * way + (i % 2 == 0 ? Eigen::Vector3d(0, 0, 0) : side);
      btRigidBody& stick = world.add_box(
          0.02, half,
          btTransform(shortestArcQuat(btVector3(1, 0, 0), to_bullet(along.normalized())),
                      to_bullet(from + along / 2)));
      world.add_joint<Joint>(*last, stick, end, btVector3(-half.x(), 0, 0));
      last = &stick;
      end = btVector3(half.x(), 0, 0);
    }
    world.add_joint<Joint>(*last, weight, end, centre);
  } else {
    auto& joint = world.add_joint<Joint>(fixed, weight, centre, centre, btScalar(1));
    if (slack) joint.setLimit(0, 1);
  }
}

template <class Joint>
RopeResult rope(const RopeSettings& settings) {
  World world(standard_gravity, settings.iterations, settings.make_solver);
  const btVector3 half(btScalar(0.05), btScalar(0.05), btScalar(0.05));
  const double A = settings.amplitude;
  const btVector3 start =
      settings.slack ? btVector3(btScalar(0.3), 0, 0) : to_bullet({std::sin(A), 0, -std::cos(A)});
  btRigidBody& fixed = world.add_box(0, half, btTransform::getIdentity());
  btRigidBody& weight = world.add_box(2, half, pose_at(start));
  suspend<Joint>(world, fixed, weight, settings.slack);

  const double torque = 2 * standard_gravity;  // m g times 1 m
  const double start_energy = energy(weight, standard_gravity);
  const double scale = settings.slack ? torque : torque * (1 - std::cos(A));
  RopeResult result;
  double last_angle = A, first_pass = 0, last_pass = 0;
  int passes = 0;
  const int steps = int(std::lround(settings.seconds / settings.dt));
  for (int step = 1; step <= steps; ++step) {
    world.step(settings.dt);
    const Eigen::Vector3d p = position(weight);
    const double gained = (energy(weight, standard_gravity) - start_energy) / scale;
    const double longer = p.norm() - 1;
    result.finite = std::isfinite(gained) && std::isfinite(longer);
    if (!result.finite) break;
    result.energy_error = std::max(result.energy_error, settings.slack ? gained : std::abs(gained));
    result.max_stretch = std::max(result.max_stretch, settings.slack ? longer : std::abs(longer));
    const double angle = std::atan2(p.x(), -p.z());
    if (last_angle < 0 && angle >= 0 && angle - last_angle < pi) {
      last_pass = (step - 1 - last_angle / (angle - last_angle)) * settings.dt;
      if (passes++ == 0) first_pass = last_pass;
    }
    last_angle = angle;
  }
  if (passes > 1)
    result.period_error =
        (last_pass - first_pass) / (passes - 1) / pendulum_period(2, torque, A) - 1;
  result.microseconds_per_step = world.microseconds_per_step();
  return result;
}

}  // namespace scenes
