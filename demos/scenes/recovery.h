// Two free boxes start with their joint badly violated (recovery.cpp), and a joint of any type pulls
// itself together. A hinge's axis is z of each box. A lock has no axis: its error is the whole turn
// between the frames, about any direction.
//
// Measured:
//   steps          after how many steps the error is within 1 degree for good; -1: never
//   angular speed  the largest of either body after any step, rad/s: a correction that is exact
//                  but throws the bodies about is no recovery
//   turning        the same by how far they turn in a step, whatever moves them

#pragma once

#include <algorithm>
#include <cmath>

#include "catalog.h"
#include "world.h"

namespace scenes {

struct RecoverySettings {
  double angle = pi / 4;              // rad
  Eigen::Vector3d about = {1, 0, 0};  // unit vector, of a hinge in the x-y plane
  bool lock = false;                  // the error is that of the whole orientation
  double dt = 1.0 / 60;               // s
  int iterations = 10;
  double seconds = 10;
  double tolerance = radians(1);  // rad
  SolverFactory make_solver = {};
};

struct RecoveryResult {
  int steps = -1;                // -1: never
  double max_angular_speed = 0;  // rad/s
  double max_turning = 0;        // rad/s
  double start_axis_angle = 0;   // rad, or that of a lock: the settings' angle, but for rounding
  double end_axis_angle = 0;     // rad
  double max_gap = 0;            // m
  bool finite = true;            // false: the run ended in NaN or infinity
  double microseconds_per_step = 0;  // wall-clock: does not repeat
};

// The angle by which the second body is turned against the first, rad, in [0, pi].
inline double angle_between(const btRigidBody& a, const btRigidBody& b) {
  const Eigen::Quaterniond turn(Eigen::Matrix3d(rotation(a).transpose() * rotation(b)));
  return 2 * std::atan2(turn.vec().norm(), std::abs(turn.w()));
}

// `configure` is called with the joint before the first step.
template <class Hinge, class Configure = AsConstructed>
RecoveryResult recovery(const RecoverySettings& settings, Configure configure = {}) {
  const Eigen::Vector3d axis(0, 0, 1);
  const Scene scene = recovery_scene(settings.angle, settings.about);
  const Joint& joint = scene.joints[0];
  const Eigen::Vector3d anchor_a = joint.in_a.translation(), anchor_b = joint.in_b.translation();
  World world(scene.gravity, settings.iterations, settings.make_solver);
  const std::vector<btRigidBody*> bodies = world.add_bodies(scene);
  btRigidBody &a = *bodies[1], &b = *bodies[2];
  // With the rounding of a quaternion, as users turn bodies: stock's fixed joint is lost by it.
  btQuaternion turn;
  b.getCenterOfMassTransform().getBasis().getRotation(turn);
  b.setCenterOfMassTransform(btTransform(turn, b.getCenterOfMassPosition()));
  configure(world.add_joint_of<Hinge>(joint, bodies));

  const auto axis_angle = [&] {
    if (settings.lock) return angle_between(a, b);
    return angle_between(direction_in_world(a, axis), direction_in_world(b, axis));
  };
  RecoveryResult result;
  result.start_axis_angle = axis_angle();
  const int steps = int(std::lround(settings.seconds / settings.dt));
  for (int step = 1; step <= steps; ++step) {
    const Eigen::Matrix3d before_a = rotation(a), before_b = rotation(b);
    world.step(settings.dt);
    for (const auto& [body, before] : {std::pair(&a, before_a), std::pair(&b, before_b)}) {
      const Eigen::Matrix3d by = rotation(*body) * before.transpose();
      result.max_turning =
          std::max(result.max_turning, Eigen::AngleAxisd(by).angle() / settings.dt);
    }
    result.end_axis_angle = axis_angle();
    // Written so that NaN counts as outside.
    const bool inside = result.end_axis_angle <= settings.tolerance;
    if (!inside) {
      result.steps = -1;
    } else if (result.steps < 0) {
      result.steps = step;
    }
    const double speed =
        std::max(to_eigen(a.getAngularVelocity()).norm(), to_eigen(b.getAngularVelocity()).norm());
    const double gap = (point_in_world(a, anchor_a) - point_in_world(b, anchor_b)).norm();
    result.finite = std::isfinite(speed) && std::isfinite(gap);
    if (!result.finite) break;
    result.max_angular_speed = std::max(result.max_angular_speed, speed);
    result.max_gap = std::max(result.max_gap, gap);
  }
  result.microseconds_per_step = world.microseconds_per_step();
  return result;
}

}  // namespace scenes
