// Purpose: everything that can act along one free coordinate of a joint: a limit, a motor or a
// servo, and friction, and the one row that they share. Each is an impulse that falls with the
// velocity u of the coordinate,
//   Lambda(u) = clamp((target - u) / softness, lower, upper),
// vertical if rigid. Their sum meets the free motion u = u_free + K Lambda in one point; the row is
// the piece of the sum around that point. So a joint never has two rows along one direction (which
// a direct solver finds singular), and each part's impulse is known from the row's.
#pragma once

#include <pintle/rows/axis_settings.h>

#include <array>

namespace pintle {
inline namespace PINTLE_PRECISION {

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
