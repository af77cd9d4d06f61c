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
// The same of a spring whose row begins with what it comes to for the joint alone: of what others change of that cfm^n is left. (Hair of ten
// links is shaken by springs that are given, and not by these.)
constexpr Scalar max_yield_cfm = Scalar(0.7);

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

/// Softness as a fraction of K = J M^-1 J^T of the coordinate.
inline equations::Softness<Scalar> softnessOf(const Spring& spring, Scalar dt, Scalar K) {
  if (!spring.hasUnits())
    return equations::softness_by_frequency<Scalar>(spring.angular_frequency, spring.damping_ratio,
                                                    dt, Scalar(1));
  auto soft = equations::softness<Scalar>(spring.stiffness, spring.damping, dt);
  soft.gamma /= K;
  return soft;
}

inline AxisPart springPart(const Spring& spring, Scalar error, Scalar dt, Scalar K, Scalar lower,
                           Scalar upper) {
  const auto soft = softnessOf(spring, dt, K);
  const Scalar cfm = soft.gamma / dt;
  return {{-equations::baumgarte(error, soft.beta, dt), cfm, lower, upper},
          cfm <= max_spring_cfm,
          true};
}

/// A coordinate and the limit that it has broken, or comes nearer to by the motion as it is.
struct NearLimit {
  bool at_low;
  Scalar side;         ///< 1 if the coordinate grows to the inside, else -1
  Scalar gap, inward;  ///< to the limit, and speed to the inside

  NearLimit(const Axis& axis, const AxisMotion& m) : at_low(m.position <= axis.low) {
    if (!at_low && m.position < axis.high) {
      const Scalar next = m.position + m.velocity / m.fps;
      at_low = next - axis.low < axis.high - next;
    }
    side = at_low ? Scalar(1) : Scalar(-1);
    gap = side * (m.position - (at_low ? axis.low : axis.high));
    inward = side * m.velocity;
  }
};

/// To the inside: of a limit that was reached in the last step, or that is met from beyond it.
inline Scalar reboundSpeed(const Axis& axis, const AxisMotion& m, const NearLimit& limit) {
  const bool reached = limit.gap * m.fps < Scalar(0.1) * m.incoming;  // in the last step
  const Scalar came = limit.gap > 0 && !axis.locked() ? (reached ? m.incoming : Scalar(0))
                                                      : btMax(m.incoming, -limit.inward);
  const Scalar speed = axis.bias * axis.relaxation * came;
  // No rebound goes further than half way to the other limit in a step.
  return axis.locked() ? speed : btMin(speed, (axis.high - axis.low) * m.fps / 2);
}

/// `incoming` becomes the speed towards the limit that the part is to stop.
inline AxisPart limitPart(const Axis& axis, const AxisMotion& m, Scalar& incoming) {
  const bool locked = axis.locked();
  const NearLimit limit(axis, m);
  const Scalar lower = locked || !limit.at_low ? -infinity : Scalar(0);
  const Scalar upper = locked || limit.at_low ? infinity : Scalar(0);
  // Towards the inside is positive, for both sides.
  const Scalar side = limit.side, gap = limit.gap;
  if (axis.hasLimitSpring()) {
    if (gap > 0 && !locked) return {};
    return springPart(axis.limit_spring, side * gap, 1 / m.fps, m.K, lower, upper);
  }
  const Scalar rebound = reboundSpeed(axis, m, limit);
  if (gap > 0 && !locked) {
    if (rebound > 0) return rigidPart(side * rebound, 0, lower, upper);
    // Not there yet: the step may close the gap, and no more. Bullet's softness means nothing here.
    incoming = btMax(Scalar(0), -limit.inward);
    return rigidPart(side * -gap * m.fps, 0, lower, upper);
  }
  // As in Bullet: a rebound if the joint comes in, of the speed with which it did.
  Scalar speed = btMin(-m.fps * m.limit_erp * axis.bias * gap, m.max_speed);
  if (rebound > 0) speed = btMax(speed, rebound);
  return rigidPart(side * speed, m.limit_cfm, lower, upper);
}

/// To the target at the motor's speed, or as the last stretch is to be closed.
inline Scalar approachSpeed(const Axis& axis, const AxisMotion& m) {
  const Scalar most = btFabs(axis.motor_velocity),
               closing = m.fps * m.motor_erp * (axis.servo_target - m.position);
  return btMax(-most, btMin(closing, most));
}

inline AxisPart motorPart(const Axis& axis, const AxisMotion& m) {
  if (axis.drive != Axis::Drive::servo) {
    const Scalar target = axis.drive == Axis::Drive::pose   ? -m.fps * axis.motor_gain * m.position
                          : axis.drive == Axis::Drive::rate ? m.position
                          : axis.drive == Axis::Drive::approach
                              ? approachSpeed(axis, m)
                              : m.motor_factor * axis.motor_velocity;
    const Scalar given = m.motor_inertia * axis.max_motor_impulse + axis.max_motor_force / m.fps;
    const Scalar bound = btMin(given, infinity);
    return rigidPart(target, m.motor_cfm, -bound, bound);
  }
  const Scalar bound = axis.max_servo_force / m.fps;
  return springPart(axis.servo_spring, m.position - axis.servo_target, 1 / m.fps, m.K, -bound,
                    bound);
}

inline AxisPart ownSpringPart(const Axis& axis, const AxisMotion& m) {
  const bool is_bounded = axis.spring_drives && axis.max_servo_force < infinity;
  const Scalar bound = is_bounded ? axis.max_servo_force / m.fps : infinity;
  AxisPart part =
      springPart(axis.spring, m.position - axis.spring_rest, 1 / m.fps, m.K, -bound, bound);
  if (axis.spring_drives)
    part.row.target += (1 - softnessOf(axis.spring, 1 / m.fps, m.K).beta) * axis.motor_velocity;
  part.rigid = part.row.cfm <= max_yield_cfm;
  return part;
}

inline AxisPart frictionPart(const Axis& axis, const AxisMotion& m) {
  const Scalar bound = axis.max_friction / m.fps;
  return rigidPart(0, 0, -bound, bound);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
