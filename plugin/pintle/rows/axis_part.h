// Purpose: the parts that can act along an axis, one by one: a limit, a motor or servo, friction.
#pragma once

#include <pintle/equations/impulse.h>
#include <pintle/rows/axis.h>

#include <LinearMath/btMinMax.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

// Bullet iterates a soft row by lambda <- rhs - cfm lambda, which leaves cfm^n of the answer after
// n iterations. Softer springs than this are solved here, and written as the impulse that they are.
constexpr Scalar max_spring_cfm = Scalar(0.1);

/// lambda = clamp((target - u) / softness, lower, upper), softness from cfm, a fraction of K. One part
/// alone is the row.
struct AxisPart {
  AxisRow row;
  bool rigid = true;  ///< Bullet's solver can run it as a row
  bool on = false;
};

inline AxisPart rigidPart(Scalar target, Scalar cfm, Scalar lower, Scalar upper) {
  return {{target, cfm, lower, upper}, cfm < 1, true};
}

inline AxisPart springPart(const Spring& spring, Scalar error, Scalar dt, Scalar lower,
                           Scalar upper) {
  const auto soft = equations::softness_by_frequency<Scalar>(spring.angular_frequency,
                                                             spring.damping_ratio, dt, Scalar(1));
  const Scalar cfm = soft.gamma / dt;
  return {{-equations::baumgarte(error, soft.beta, dt), cfm, lower, upper},
          cfm <= max_spring_cfm,
          true};
}

/// `incoming` becomes the speed towards the limit that the part is to stop.
inline AxisPart limitPart(const Axis& axis, const AxisMotion& m, Scalar& incoming) {
  // The side that is broken, or nearer after the motion as it is.
  const bool locked = axis.locked();
  bool at_low = m.position <= axis.low;
  if (!at_low && m.position < axis.high) {
    const Scalar next = m.position + m.velocity / m.fps;
    at_low = next - axis.low < axis.high - next;
  }
  const Scalar lower = locked || !at_low ? -infinity : Scalar(0);
  const Scalar upper = locked || at_low ? infinity : Scalar(0);
  // Towards the inside is positive from here on, for both sides.
  const Scalar side = at_low ? Scalar(1) : Scalar(-1);
  const Scalar gap = side * (m.position - (at_low ? axis.low : axis.high));
  const Scalar inward = side * m.velocity;

  if (axis.hasLimitSpring()) {
    if (gap > 0 && !locked) return {};
    return springPart(axis.limit_spring, side * gap, 1 / m.fps, lower, upper);
  }
  // No rebound goes further than half way to the other limit in a step.
  const auto away = [&](Scalar speed) {
    return locked ? speed : btMin(speed, (axis.high - axis.low) * m.fps / 2);
  };
  const Scalar rebound = axis.bias * axis.relaxation;
  if (gap > 0 && !locked) {
    const bool reached = gap * m.fps < Scalar(0.1) * m.incoming;  // in the last step
    if (reached && rebound * m.incoming > 0)
      return rigidPart(side * away(rebound * m.incoming), 0, lower, upper);
    // Not there yet: the step may close the gap, and no more. Bullet's softness means nothing here.
    incoming = btMax(Scalar(0), -inward);
    return rigidPart(side * -gap * m.fps, 0, lower, upper);
  }
  // As in Bullet: a rebound if the joint comes in, of the speed with which it did.
  Scalar speed = btMin(-m.fps * m.limit_erp * axis.bias * gap, m.max_speed);
  const Scalar came = btMax(m.incoming, -inward);
  if (rebound * came > 0) speed = btMax(speed, away(rebound * came));
  return rigidPart(side * speed, m.limit_cfm, lower, upper);
}

inline AxisPart motorPart(const Axis& axis, const AxisMotion& m) {
  if (axis.drive != Axis::Drive::servo) {
    const Scalar target = axis.drive == Axis::Drive::pose   ? -m.fps * axis.motor_gain * m.position
                          : axis.drive == Axis::Drive::rate ? m.position
                                                            : m.motor_factor * axis.motor_velocity;
    const Scalar given = m.motor_inertia * axis.max_motor_impulse + axis.max_motor_force / m.fps;
    const Scalar bound = btMin(given, infinity);
    return rigidPart(target, m.motor_cfm, -bound, bound);
  }
  const Scalar bound = axis.max_servo_force / m.fps;
  return springPart(axis.servo_spring, m.position - axis.servo_target, 1 / m.fps, -bound, bound);
}

inline AxisPart frictionPart(const Axis& axis, const AxisMotion& m) {
  const Scalar bound = axis.max_friction / m.fps;
  return rigidPart(0, 0, -bound, bound);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
