// Purpose: everything that can act along one free coordinate of a joint: a limit, a motor or a
// servo, and friction, and the one row that they share. Each is an impulse that falls with the
// velocity u of the coordinate,
//   Lambda(u) = clamp((target - u) / softness, lower, upper),
// vertical if rigid. Their sum meets the free motion u = u_free + K Lambda in one point; the row is
// the piece of the sum around that point. So a joint never has two rows along one direction (which
// a direct solver finds singular), and each part's impulse is known from the row's.
#pragma once

#include <pintle/precision.h>

#include <array>

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
};

struct Spring {
  Scalar angular_frequency = 0;  ///< rad/s; 0: not a spring
  Scalar damping_ratio = 0;
};

/// Settings along a coordinate. Units are those of the coordinate: rad, rad/s, N m s for an angle.
struct Axis {
  enum class Drive : unsigned char {
    off,
    velocity,
    pose,  ///< to coordinate 0, in parts
    rate,  ///< at the speed that stands in the place of the coordinate
    servo
  };
  enum Part { motor, friction, limit, parts };

  Scalar low = 1, high = -1;  ///< low > high: free
  Scalar bias = Scalar(0.3);
  Scalar relaxation = 1;
  Spring limit_spring;

  Drive drive = Drive::off;
  Drive chosen = Drive::velocity;  ///< what enable turns on
  /// Whether max_motor_impulse is a change of speed, rad/s: times the inertia of body a about the row.
  bool normalized_motor = false;
  Scalar motor_velocity = 0;
  Scalar max_motor_impulse = 0;  ///< N m s, a step
  Scalar max_motor_force = 0;  ///< N m, added to it: what Bullet bounds differs from joint to joint
  Scalar motor_gain = 0;       ///< of a drive to a pose: the part of the way to 0 that a step goes
  Scalar servo_target = 0;
  Spring servo_spring;
  Scalar max_servo_force = 0;  ///< N m
  Scalar max_friction = 0;     ///< N m

  const AxisParameters* own = nullptr;  ///< before the joint's

  void choose(Drive how) {
    chosen = how;
    enable(drive != Drive::off);
  }
  void enable(bool on) { drive = on ? chosen : Drive::off; }

  bool limited() const { return low <= high; }
  bool locked() const { return low == high; }
  /// Motor, servo or friction: a row in every step, whatever the coordinate.
  bool driven() const { return drive != Drive::off || max_friction > 0; }
  /// Whether a single rigid part acts, which is a row as it stands.
  bool isSimple(bool limit_acts) const {
    if (limit_acts) return !driven() && !(limit_spring.angular_frequency > 0);
    return drive == Drive::off || (drive != Drive::servo && !(max_friction > 0));
  }
  /// How far the coordinate is from the limit that it is nearest to: negative beyond it.
  Scalar distance(Scalar position) const {
    return position - low < high - position ? position - low : high - position;
  }
};

/// What the step knows of a coordinate.
struct AxisMotion {
  Scalar position;
  Scalar gain;       ///< what the curvature adds to the velocity in the mean over the step
  Scalar velocity;   ///< at the start of the step, and the gain
  Scalar max_speed;  ///< of the correction of a broken limit
  Scalar incoming;   ///< speed with which a limit was reached in the last step, else 0
  bool limit;        ///< whether the limit may act in this step
  Scalar fps;
  Scalar limit_erp;
  Scalar motor_cfm, limit_cfm;  ///< as Bullet has them: fractions of K
  Scalar motor_factor;          ///< of motor_velocity: Bullet's motors slow down before a limit
  Scalar motor_inertia = 1;     ///< of a normalized motor, kg m^2
  // For more than one part, or a soft one (Axis::isSimple is false):
  /// At the end of the step, if nothing acted along the coordinate, and the gain.
  Scalar free_velocity;
  Scalar K;  ///< J M^-1 J^T of the row, after the joint's equalities
};

/// The row: J v = target, with Bullet's softness and bounds in impulses.
struct AxisRow {
  Scalar target = 0, cfm = 0, lower = 0, upper = 0;
};

/// What a joint remembers of an axis that has a row.
struct AxisState {
  const Axis* axis = nullptr;
  /// Impulses of the parts other than `rest`, in the order of Axis::Part.
  std::array<Scalar, Axis::parts - 1> others = {};
  Scalar incoming = 0;  ///< speed towards a limit that this step's row stops, else 0
  Scalar last_incoming =
      0;             ///< the same of the last step. Two, so that getInfo2 may be called again
  Scalar whole = 0;  ///< impulse of the row, along the coordinate, where a solver lets it be read
  signed char rest =
      Axis::parts;  ///< the part that takes what the others leave; `parts`: none acts
  /// J v = sign * d/dt of the coordinate (+1 or -1): which way Bullet counts the impulse.
  signed char sign = 1;
  bool acted : 1;     ///< whether there is a row in this step
  bool given : 1;     ///< whether it is an impulse, given whatever other joints do
  bool seen : 1;      ///< whether a solver has shown what they did to it
  bool foreseen : 1;  ///< whether that is reckoned with in this step

  AxisState() : acted(false), given(false), seen(false), foreseen(false) {}
  void beginStep() {
    if (acted) {
      last_incoming = incoming;
      acted = given = foreseen = false;
    } else {
      last_incoming = whole = 0;
      seen = false;
    }
  }
  /// No part acts so far.
  void clear() {
    others = {};
    incoming = 0;
    rest = Axis::parts;
  }
  /// Whether nothing but the limit acts, or did in the last step before this one is cleared.
  bool isLimit() const { return rest == Axis::limit && others[0] == 0 && others[1] == 0; }
  /// The impulse of one part, of the row's whole impulse.
  Scalar impulse(Axis::Part part, Scalar of) const {
    if (rest == Axis::parts) return 0;
    return part == rest ? of - others[0] - others[1] : others[part - (part > rest)];
  }
};

/// The row of an axis along which more than one part acts, or a soft one.
AxisRow solveAxis(const Axis& axis, const AxisMotion& motion, AxisState& state);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
