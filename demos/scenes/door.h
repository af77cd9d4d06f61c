// A heavy door is thrown at a soft stop, with a draught that presses it on.
//
// The door is a panel of half extents (0.45, 0.02, 1) m and 30 kg on a vertical hinge along its
// edge x = -0.45: its centre of mass is 0.45 m off the hinge axis, so its inertia about the hinge,
// I, is four times that about its centre. It starts at angle 0 with `speed`, feels a constant
// torque t, and meets its stop at `stop`.
//
// The stop is asked for by a frequency f and a damping ratio z. Beyond the stop, by x rad, it
// should act on the door as a one-sided damped spring of w = 2 pi f, k = I w^2, c = 2 z I w:
//   I x'' = t - max(0, k x + c x').
// door_reference integrates this. Without draught it has closed forms (z < 1): the farthest x is
// (x'_0 / w) exp(-z (pi/2 - asin z) / sqrt(1 - z^2)), and the door comes off the stop with
// exp(-z (pi - 2 asin z) / sqrt(1 - z^2)) of its speed x'_0.
// A joint without setLimitSpring gets setLimit's softness, bias and relaxation instead.
//
// Measured:
//   overshoot   the farthest beyond the stop, rad
//   rebound     largest speed of the first way back, once off the stop, over that of the way there
//   bounces     how often the door turned round from backward to forward
//   rest time   when the door's speed fell below 0.01 rad/s for good, s; -1: never
//   rest angle  at the end of the run, beyond the stop, rad; the reference's is t / k

#pragma once

#include <algorithm>
#include <cmath>

#include "world.h"

namespace scenes {

struct DoorSettings {
  double stop = pi / 2;        // rad
  double speed = 3;            // rad/s, at the start
  double draught = 30;         // N m: t
  double frequency = 3;        // Hz: f
  double damping_ratio = 0.3;  // z
  // Only for a joint without setLimitSpring; setLimit's defaults.
  double softness = 0.9, bias = 0.3, relaxation = 1;
  double dt = 1.0 / 60;  // s
  int iterations = 10;
  double seconds = 10;
  SolverFactory make_solver = {};
};

struct DoorResult {
  double overshoot = 0;  // rad
  double rebound = 0;    // ratio of speeds
  int bounces = 0;
  double rest_time = -1;  // s; -1: never
  double rest_angle = 0;  // rad
  double max_gap = 0;     // m: distance between the two anchors of the hinge
  bool finite = true;
  double microseconds_per_step = 0;  // wall-clock: does not repeat
};

// Turns a door's course (time, angle beyond the stop, speed) into what is measured.
class DoorObserver {
 public:
  void observe(double time, double beyond, double speed) {
    result_.overshoot = std::max(result_.overshoot, beyond);
    result_.rest_angle = beyond;
    if (std::abs(speed) >= 0.01) {
      result_.rest_time = -1;
    } else if (result_.rest_time < 0) {
      result_.rest_time = time;
    }
    // Speeds below 0.01 rad/s do not count as a way there or back.
    if (forward_ && speed < -0.01) {
      forward_ = false;
    } else if (!forward_ && speed > 0.01) {
      forward_ = true;
      ++result_.bounces;
    }
    if (result_.bounces > 0) return;
    if (forward_) {
      there_ = std::max(there_, speed);
    } else if (beyond <= 0) {
      back_ = std::max(back_, -speed);
    }
    result_.rebound = there_ > 0 ? back_ / there_ : 0;
  }

  const DoorResult& result() const { return result_; }

 private:
  DoorResult result_;
  bool forward_ = true;
  double there_ = 0, back_ = 0;  // rad/s
};

// kg and m.
constexpr double door_mass = 30;
constexpr double door_half_width = 0.45, door_half_depth = 0.02, door_half_height = 1;

// Inertia of the door about its hinge, kg m^2: I.
constexpr double door_inertia() {
  constexpr double a = door_half_width, b = door_half_depth;
  return door_mass * ((a * a + b * b) / 3 + a * a);
}

// What the settings ask for: the head comment's equation, by the midpoint rule in steps of 10 us.
inline DoorResult door_reference(const DoorSettings& settings) {
  const double w = 2 * pi * settings.frequency, z = settings.damping_ratio;
  const double push = settings.draught / door_inertia();
  const auto acceleration = [&](double x, double speed) {
    return x > 0 ? push - std::max(0.0, w * w * x + 2 * z * w * speed) : push;
  };
  constexpr double h = 1e-5;
  DoorObserver observer;
  double x = -settings.stop, speed = settings.speed;
  const int steps = int(std::lround(settings.seconds / h));
  for (int step = 1; step <= steps; ++step) {
    const double mid_x = x + h / 2 * speed;
    const double mid_speed = speed + h / 2 * acceleration(x, speed);
    x += h * mid_speed;
    speed += h * acceleration(mid_x, mid_speed);
    observer.observe(step * h, x, speed);
  }
  return observer.result();
}

// `configure` is called with the hinge before the first step, after its limit is set.
template <class Hinge, class Configure = AsConstructed>
DoorResult door(const DoorSettings& settings, Configure configure = {}) {
  World world(standard_gravity, settings.iterations, settings.make_solver);
  const btVector3 half_extents = to_bullet({door_half_width, door_half_depth, door_half_height});
  const double arm = door_half_width;
  const Eigen::Vector3d anchor(-arm, 0, 0);
  btRigidBody& panel = world.add_box(door_mass, half_extents, pose_at({btScalar(arm), 0, 0}));
  panel.setAngularVelocity(btVector3(0, 0, btScalar(settings.speed)));
  panel.setLinearVelocity(btVector3(0, btScalar(settings.speed * arm), 0));
  Hinge& hinge = world.add_joint<Hinge>(panel, pose_at(to_bullet(anchor)));

  // Low enough that the door never comes back to it.
  const btScalar low = btScalar(-0.95 * pi), high = btScalar(settings.stop);
  if constexpr (HasLimitSpring<Hinge>::value) {
    hinge.setLimit(low, high);
    hinge.setLimitSpring(btScalar(settings.frequency), btScalar(settings.damping_ratio));
  } else {
    hinge.setLimit(low, high, btScalar(settings.softness), btScalar(settings.bias),
                   btScalar(settings.relaxation));
  }
  configure(hinge);

  DoorObserver observer;
  Unwrap unwrap(0);
  double max_gap = 0;
  bool finite = true;
  const int steps = int(std::lround(settings.seconds / settings.dt));
  for (int step = 1; step <= steps && finite; ++step) {
    panel.applyTorque(btVector3(0, 0, btScalar(settings.draught)));
    world.step(settings.dt);
    const Eigen::Vector3d edge = direction_in_world(panel, {1, 0, 0});
    const double angle = unwrap(std::atan2(edge.y(), edge.x()));
    observer.observe(step * settings.dt, angle - settings.stop,
                     double(panel.getAngularVelocity().z()));
    max_gap = std::max(max_gap, point_in_world(panel, anchor).norm());
    finite = std::isfinite(angle) && std::isfinite(max_gap);
  }
  DoorResult result = observer.result();
  result.max_gap = max_gap;
  result.finite = finite;
  result.microseconds_per_step = world.microseconds_per_step();
  return result;
}

}  // namespace scenes
