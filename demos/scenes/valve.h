// A motor turns a valve's wheel several turns onto its stop, and back onto the other one.
//
// A wheel (a square plate, half extents (0.3, 0.3, 0.03) m, 4 kg) turns about z on a hinge to the
// world with stops at 0 and at `turns` turns. The motor drives it up for the first half of the run
// and down for the second half. The wheel's true angle is counted from its pose, step by step.
//
// Measured, rad:
//   top, bottom   where the wheel stands at the end of each half
//   overshoot     the farthest that the wheel went beyond a stop
//   reading error the largest difference between the joint's accumulated angle and the true one
// Ideal: top = 2 pi turns, bottom = 0, overshoot 0, reading error 0.
// A joint that wraps its limits to one turn sees 0 to 0, give or take rounding, for whole turns: it
// locks, or it never stops.

#pragma once

#include <algorithm>
#include <cmath>

#include "world.h"

namespace scenes {

struct ValveSettings {
  double turns = 5;       // between the stops
  double speed = 12;      // rad/s, of the motor
  double max_torque = 5;  // N m, of the motor
  double dt = 1.0 / 60;   // s
  int iterations = 10;
  double seconds_each_way = 4;
  SolverFactory make_solver = {};
};

struct ValveResult {
  double top = 0;     // rad
  double bottom = 0;  // rad
  double overshoot = 0;
  bool has_reading = false;  // the joint counts turns
  double top_reading = 0;    // rad: what the joint says at the end of the first half
  double max_reading_error = 0;
  bool finite = true;
  double microseconds_per_step = 0;  // wall-clock: does not repeat
};

// `configure` is called with the hinge before the first step, after its limits are set.
template <class Hinge, class Configure = AsConstructed>
ValveResult valve(const ValveSettings& settings, Configure configure = {}) {
  World world(standard_gravity, settings.iterations, settings.make_solver);
  const btVector3 half_extents(btScalar(0.3), btScalar(0.3), btScalar(0.03));
  btRigidBody& wheel = world.add_box(4, half_extents, btTransform::getIdentity());
  Hinge& hinge = world.add_joint<Hinge>(wheel, btTransform::getIdentity());
  const double stop = 2 * pi * settings.turns;
  hinge.setLimit(btScalar(0), btScalar(stop));
  configure(hinge);

  const auto wrapped_angle = [&wheel] {
    const Eigen::Vector3d spoke = direction_in_world(wheel, {1, 0, 0});
    return std::atan2(spoke.y(), spoke.x());
  };
  ValveResult result;
  result.has_reading = HasAccumulatedAngle<Hinge>::value;
  Unwrap unwrap(0);
  const int half = int(std::lround(settings.seconds_each_way / settings.dt));
  for (int step = 0; step < 2 * half; ++step) {
    const bool up = step < half;
    hinge.enableAngularMotor(true, btScalar(up ? settings.speed : -settings.speed),
                             btScalar(settings.max_torque * settings.dt));
    world.step(settings.dt);
    const double angle = unwrap(wrapped_angle());
    result.finite = std::isfinite(angle);
    if (!result.finite) break;
    (up ? result.top : result.bottom) = angle;
    result.overshoot = std::max({result.overshoot, angle - stop, -angle});
    if constexpr (HasAccumulatedAngle<Hinge>::value) {
      const double reading = double(hinge.getAccumulatedHingeAngle());
      if (up) result.top_reading = reading;
      result.max_reading_error = std::max(result.max_reading_error, std::abs(reading - angle));
    }
  }
  result.microseconds_per_step = world.microseconds_per_step();
  return result;
}

}  // namespace scenes
