// A motor turns a shaft, and a joint turns a second one at an angle to it.
//
// Two shafts (boxes, half extents (0.5, 0.1, 0.1) m, 1 kg) turn about their own x axes on hinges to
// the world; their lines meet in the origin at the angle `bend`, where the joint connects them. A
// strong motor keeps the first one at its speed. The second one may have to turn a load, and
// has turned for `warm_up` before anything is measured.
//
// A universal joint with axis 1 normal to both shafts at first turns the second shaft to
//   out(th) = atan2(cos b sin th, cos th),   out' = cos b / (1 - sin^2 b sin^2 th)
// where the first one has turned by th: the document's ratio, with th counted from the shafts'
// plane there. A constant velocity joint has out = th.
//
// Measured, each in the mean over a step, by the poses:
//   min, max          speed of the second shaft over that of the first
//   ripple            half of their difference
//   universal error   the largest difference between the second shaft's angle and out(th), rad
//   velocity error    the same of th
//   gap               m, the largest distance between the shafts' ends

#pragma once

#include <BulletDynamics/ConstraintSolver/btUniversalConstraint.h>
#include <pintle/joints/constant_velocity_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/universal_joint.h>

#include <algorithm>
#include <cmath>

#include "catalog.h"
#include "world.h"

namespace scenes {

struct DriveShaftSettings {
  double bend = radians(30);
  double rpm = 300;
  double load = 0;       // N m, against the second shaft
  double dt = 1.0 / 60;  // s
  int iterations = 10;
  double turns = 3;    // that are measured
  double warm_up = 1;  // turns
  bool from_rest = false;
  bool angular_only = false;  // of a constant velocity joint
  SolverFactory make_solver = {};
};

struct DriveShaftResult {
  double min = HUGE_VAL, max = -HUGE_VAL;
  double ripple = 0;
  double universal_error = 0, velocity_error = 0;  // rad
  double max_gap = 0;                              // m
  bool finite = true;
  double microseconds_per_step = 0;  // wall-clock: does not repeat
};

// The joint between the shafts' ends.
template <class Joint>
Joint& couple(World& world, btRigidBody& first, btRigidBody& second,
              const DriveShaftSettings& settings) {
  if constexpr (std::is_same_v<Joint, pintle::ConstantVelocityJoint>) {
    const btVector3 x(1, 0, 0), end(btScalar(0.5), 0, 0);
    Joint& joint = world.add_joint<Joint>(first, second, end, -end, x, x);
    joint.setAngularOnly(settings.angular_only);
    return joint;
  } else {
    // Axis 1 across the first shaft, axis 2 across the second one.
    const Eigen::Vector3d across(-std::sin(settings.bend), std::cos(settings.bend), 0);
    return world.add_joint<Joint>(first, second, btVector3(0, 0, 0), btVector3(0, 0, 1),
                                  to_bullet(across));
  }
}

template <class Joint>
DriveShaftResult drive_shaft(const DriveShaftSettings& settings) {
  World world(0, settings.iterations, settings.make_solver);
  const double W = settings.rpm * 2 * pi / 60, b = settings.bend;
  constexpr bool constant = std::is_same_v<Joint, pintle::ConstantVelocityJoint>;
  const Scene scene =
      drive_shaft_scene(constant ? Kind::constant_velocity : Kind::universal, b, settings.rpm);
  const std::vector<btRigidBody*> bodies = world.add_bodies(scene);
  btRigidBody &ground = *bodies[0], &first = *bodies[1], &second = *bodies[2];
  const Eigen::Vector3d x_first(1, 0, 0), x_second(std::cos(b), std::sin(b), 0);

  const auto add_bearing = [&](const scenes::Joint& bearing, btRigidBody& shaft) -> auto& {
    return world.add_joint<pintle::QuaternionHinge>(ground, shaft, to_bullet(bearing.in_a),
                                                    to_bullet(bearing.in_b), true);
  };
  auto& motor = add_bearing(scene.joints[0], first);
  add_bearing(scene.joints[1], second);
  motor.enableAngularMotor(true, btScalar(W), btScalar(1e6));
  couple<Joint>(world, first, second, settings);
  if (settings.from_rest) {
    first.setAngularVelocity(btVector3(0, 0, 0));
    second.setAngularVelocity(btVector3(0, 0, 0));
  }

  // How far a shaft has turned, by its y axis, which was in the shafts' plane at first.
  const auto turned = [](const btRigidBody& shaft, const Eigen::Vector3d& along) {
    const Eigen::Vector3d y = direction_in_world(shaft, {0, 1, 0});
    return std::atan2(y.z(), y.dot(Eigen::Vector3d(-along.y(), along.x(), 0)));
  };
  Unwrap unwrap_first(0), unwrap_second(0);
  double th = 0, out = 0;
  const double turn_of_step = W * settings.dt;
  const int warm_up = int(std::lround(settings.warm_up * 2 * pi / turn_of_step));
  const int steps = warm_up + int(std::lround(settings.turns * 2 * pi / turn_of_step));
  DriveShaftResult result;
  for (int step = 0; step < steps; ++step) {
    second.applyTorque(to_bullet(-settings.load * x_second));
    world.step(settings.dt);
    const double th_before = th, out_before = out;
    th = unwrap_first(turned(first, x_first));
    out = unwrap_second(turned(second, x_second));
    result.finite = std::isfinite(th) && std::isfinite(out);
    if (!result.finite) break;
    if (step < warm_up) continue;
    const double ratio = (out - out_before) / (th - th_before);
    result.min = std::min(result.min, ratio);
    result.max = std::max(result.max, ratio);
    const double universal = std::atan2(std::cos(b) * std::sin(th), std::cos(th));
    result.universal_error =
        std::max(result.universal_error, std::abs(std::remainder(out - universal, 2 * pi)));
    result.velocity_error =
        std::max(result.velocity_error, std::abs(std::remainder(out - th, 2 * pi)));
    const Eigen::Vector3d end(0.5, 0, 0);
    result.max_gap = std::max(result.max_gap,
                              (point_in_world(first, end) - point_in_world(second, -end)).norm());
  }
  result.ripple = (result.max - result.min) / 2;
  result.microseconds_per_step = world.microseconds_per_step();
  return result;
}

}  // namespace scenes
