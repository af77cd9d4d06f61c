// Purpose: what a joint keeps of its settings: of its equalities, and of what can act along a free coordinate.
// What a step makes of them is in axis.h and row.h.
#pragma once

#include <pintle/precision.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A parameter as Bullet's constraints have it, >= 0: one that is set overrides a general one.
class Parameter {
 public:
  Parameter() = default;
  Parameter(Scalar value) : m_value(value) {}
  bool isSet() const { return m_value >= 0; }
  Scalar orElse(Scalar other) const { return isSet() ? m_value : other; }

 private:
  Scalar m_value = -1;
};

/// Bullet's, of one axis.
struct AxisParameters {
  Parameter limit_erp, limit_cfm, motor_cfm;
  Parameter motor_erp;  ///< by which a motor slows down before its target; unset: the limit's
};

/// ERP and CFM of a group of equalities: the part of C that a step takes away, and Bullet's softness.
struct ErpCfm {
  Parameter erp, cfm;
  Scalar factor = 1;  ///< of the ERP
};

/// A spring and damper by its own frequency and damping ratio, or, if one of the last two is set, by those.
struct Spring {
  Scalar angular_frequency = 0;  ///< rad/s
  Scalar damping_ratio = 0;
  Scalar stiffness = 0;  ///< N/m, or N m/rad
  Scalar damping = 0;    ///< N s/m, or N m s/rad

  bool hasUnits() const { return stiffness > 0 || damping > 0; }
  bool isSet() const { return angular_frequency > 0 || hasUnits(); }
};

/// Settings along a coordinate. Units are those of the coordinate: rad, rad/s, N m s for an angle.
struct Axis {
  enum class Drive : unsigned char {
    off,
    velocity,
    pose,      ///< to coordinate 0, in parts
    rate,      ///< at the speed that stands in the place of the coordinate
    approach,  ///< to servo_target, at no more than motor_velocity
    servo
  };
  /// In the order of their rows: what comes later is obeyed the better, and Bullet reads the last one's impulse.
  enum Part {
    spring_pull,   ///< of the spring, as found for the joint alone
    spring_yield,  ///< what others change of that, of a stiff one
    friction,
    motor,
    limit,
    parts
  };
  static constexpr Part each_part[] = {spring_pull, spring_yield, friction, motor, limit};

  Scalar low = 1, high = -1;  ///< low > high: free
  Scalar bias = Scalar(0.3);
  Scalar relaxation = 1;
  Spring limit_spring;

  Drive drive = Drive::off;
  Drive chosen = Drive::velocity;  ///< what enable turns on
  /// Whether max_motor_impulse is a change of speed, rad/s: times the inertia of body a about the row.
  bool normalized_motor = false;
  bool is_any_angle = false;  ///< low and high are what Bullet's clients call no limit: (-pi, pi)
  /// True if `spring` is that of a pose drive, which has no motor: max_servo_force bounds it, and its rest moves at motor_velocity.
  bool spring_drives = false;
  Scalar motor_velocity = 0;
  Scalar max_motor_impulse = 0;  ///< N m s, a step
  Scalar max_motor_force = 0;  ///< N m, added to it: what Bullet bounds differs from joint to joint
  Scalar motor_gain = 0;       ///< of a drive to a pose: the part of the way to 0 that a step goes
  Scalar servo_target = 0;
  Spring servo_spring;
  Scalar max_servo_force = 0;  ///< N m
  Scalar max_friction = 0;     ///< N m
  Spring spring;               ///< beside motor and limit
  Scalar spring_rest = 0;      ///< the coordinate at which it bears nothing

  const AxisParameters* own = nullptr;  ///< before the joint's

  void choose(Drive how) {
    chosen = how;
    enable(drive != Drive::off);
  }
  void enable(bool on) { drive = on ? chosen : Drive::off; }

  bool limited() const { return low <= high && !is_any_angle; }
  bool locked() const { return low == high; }
  /// Motor, servo, friction or spring: a row in every step, whatever the coordinate.
  bool driven() const { return drive != Drive::off || max_friction > 0 || spring.isSet(); }
  bool hasLimitSpring() const { return limit_spring.isSet(); }
  /// Whether a part that acts is a spring.
  bool isSoft(bool limit_acts) const {
    return drive == Drive::servo || spring.isSet() || (limit_acts && hasLimitSpring());
  }
  /// How far the coordinate is from the limit that it is nearest to: negative beyond it.
  Scalar distance(Scalar position) const {
    return position - low < high - position ? position - low : high - position;
  }
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
