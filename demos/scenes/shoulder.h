// A limb is thrown against the limits of its shoulder, and then hangs in them.
//
// The limb is a box of half extents (0.3, 0.06, 0.08) m and 3 kg, held at one end; the shoulder is
// fixed to the world, its cone about a horizontal axis, so that gravity pulls the limb into the
// cone's edge. Bullet damps the limb (by a part of 0.6 of its speeds a second), so that it
// comes to rest.
//
// Measured, from the limb's pose:
//   swing, twist   the farthest beyond each limit, rad. The swing is measured as the distance of its
//                  rotation vector from the ellipse with the two spans as semiaxes.
//   top speed      the largest angular speed, rad/s
//   rest speed     the largest angular speed in the last second, rad/s
// Ideal: nothing beyond, no more speed than gravity adds (here up to 8 rad/s), at rest in the end.

#pragma once

#include <algorithm>
#include <cmath>

#include "catalog.h"
#include "directions.h"
#include "world.h"

namespace scenes {

inline Eigen::Matrix3d to_eigen(const btMatrix3x3& m) {
  Eigen::Matrix3d r;
  for (int i = 0; i < 3; ++i) r.row(i) = to_eigen(m[i]).transpose();
  return r;
}

// Of body a against b, from joint frame to joint frame.
inline SwingTwistAngles swing_twist_angles(const btRigidBody& a, const btTransform& frame_a,
                                           const btRigidBody& b, const btTransform& frame_b) {
  return swing_twist_angles((rotation(b) * to_eigen(frame_b.getBasis())).transpose() *
                            (rotation(a) * to_eigen(frame_a.getBasis())));
}

struct ShoulderSettings {
  double span_1 = 0.8, span_2 = 0.8, twist_span = 0.5;  // rad
  Eigen::Vector3d spin = {3, 6, -5};                    // rad/s, of the throw, in the limb's frame
  double damping = 0.6;                                 // a part of the speeds, a second
  double gravity = standard_gravity;
  double dt = 1.0 / 60;  // s
  int iterations = 10;
  double seconds = 20;
  SolverFactory make_solver = {};
};

struct ShoulderResult {
  double swing_beyond = -HUGE_VAL, twist_beyond = -HUGE_VAL;  // rad
  double top_speed = 0, rest_speed = 0;                       // rad/s
  double end_swing_beyond = 0, end_twist_beyond = 0;          // rad, at the end
  double max_gap = 0;                                         // m
  bool finite = true;
  double microseconds_per_step = 0;  // wall-clock: does not repeat
};

// `configure` is called with the joint before the first step, after its limits are set.
template <class Joint, class Configure = AsConstructed>
ShoulderResult shoulder(const ShoulderSettings& settings, Configure configure = {}) {
  World world(settings.gravity, settings.iterations, settings.make_solver);
  Scene scene =
      cone_shoulder_scene({settings.span_1, settings.span_2, settings.twist_span}, settings.spin);
  scene.bodies[1].damping = settings.damping;
  const std::vector<btRigidBody*> bodies = world.add_bodies(scene);
  btRigidBody &body = *bodies[0], &limb = *bodies[1];
  const btTransform in_body = to_bullet(scene.joints[0].in_a),
                    in_limb = to_bullet(scene.joints[0].in_b);
  Joint& joint = world.add_joint<Joint>(limb, body, in_limb, in_body);
  joint.setLimit(btScalar(settings.span_1), btScalar(settings.span_2),
                 btScalar(settings.twist_span));
  configure(joint);

  ShoulderResult result;
  const int steps = int(std::lround(settings.seconds / settings.dt));
  const int last_second = steps - int(std::lround(1 / settings.dt));
  for (int step = 0; step < steps; ++step) {
    world.step(settings.dt);
    const SwingTwistAngles at = swing_twist_angles(limb, in_limb, body, in_body);
    const double speed = to_eigen(limb.getAngularVelocity()).norm();
    result.finite = std::isfinite(speed) && std::isfinite(at.swing_1) && std::isfinite(at.twist);
    if (!result.finite) break;
    result.end_swing_beyond =
        distance_from_ellipse(at.swing_1, at.swing_2, settings.span_1, settings.span_2);
    result.end_twist_beyond = std::abs(at.twist) - settings.twist_span;
    result.swing_beyond = std::max(result.swing_beyond, result.end_swing_beyond);
    result.twist_beyond = std::max(result.twist_beyond, result.end_twist_beyond);
    result.top_speed = std::max(result.top_speed, speed);
    if (step >= last_second) result.rest_speed = std::max(result.rest_speed, speed);
    result.max_gap =
        std::max(result.max_gap, point_in_world(limb, to_eigen(in_limb.getOrigin())).norm());
  }
  result.microseconds_per_step = world.microseconds_per_step();
  return result;
}

}  // namespace scenes
