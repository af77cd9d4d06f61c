// Purpose: everything that can act along one free coordinate of a joint: a limit, a motor or a servo, and friction.
// Each part is a row of its own along the same J, with its own target and bounds; the limit's comes last, so that
// an iteration over the rows leaves it obeyed. A part is an impulse that falls with the velocity u of the coordinate,
//   Lambda(u) = clamp((target - u) / softness, lower, upper),
// vertical if rigid. A spring too soft for Bullet's iteration is written as the impulse that it comes to where the
// sum of the parts meets the free motion u = u_free + K Lambda.
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
  Scalar motor_erp;             ///< of a drive that approaches its target
  Scalar motor_cfm, limit_cfm;  ///< as Bullet has them: fractions of K
  Scalar motor_factor;          ///< of motor_velocity: Bullet's motors slow down before a limit
  Scalar motor_inertia = 1;     ///< of a normalized motor, kg m^2
  // Where a part is a spring:
  /// At the end of the step, if nothing acted along the coordinate, and the gain.
  Scalar free_velocity;
  Scalar K;  ///< J M^-1 J^T of the row, after the joint's equalities
};

/// The row: J v = target, with Bullet's softness and bounds in impulses.
struct AxisRow {
  Scalar target = 0, cfm = 0, lower = 0, upper = 0;
};

/// What a joint remembers of an axis that has rows.
struct AxisState {
  const Axis* axis = nullptr;
  /// The parts' in this step, along the coordinate, as far as a solver lets them be read.
  std::array<Scalar, Axis::parts> impulse = {};
  Scalar incoming = 0;  ///< speed towards a limit that this step's row stops, else 0
  Scalar last_incoming =
      0;             ///< the same of the last step. Two, so that getInfo2 may be called again
  Scalar taken = 0;  ///< J: by that row, of which a rebound in the next step may give back
  // Of a part that is an impulse given beforehand (`given`); of one that is a spring on ExactJointSolver, K alone:
  Scalar K = 0;                     ///< J M^-1 J^T of the coordinate
  Scalar expected = 0;              ///< velocity of the coordinate with that impulse and no other
  Scalar disturbance = 0;           ///< what others added to that velocity in the last step
  Scalar foreseen_disturbance = 0;  ///< what they are expected to add in this one
  /// Where Bullet has the parts' rows among those of the joint; -1: the part does not act.
  std::array<signed char, Axis::parts> row = {-1, -1, -1, -1, -1};
  /// J v = sign * d/dt of the coordinate (+1 or -1): which way Bullet counts the impulse.
  signed char sign = 1;
  bool acted : 1;     ///< whether there is a row in this step
  bool given : 1;     ///< whether a part is an impulse, given whatever other joints do
  bool seen : 1;      ///< whether a solver has shown what they did to it
  bool foreseen : 1;  ///< whether that is reckoned with in this step
  bool yields : 1;    ///< whether its spring is stiff enough to be a row, in the last step

  AxisState() : acted(false), given(false), seen(false), foreseen(false), yields(true) {}
  void beginStep() {
    if (acted) {
      last_incoming = incoming;
      acted = given = foreseen = false;
    } else {
      last_incoming = 0;
      impulse = {};
      seen = false;
    }
  }
};

/// The rows of an axis of which a part is a spring. Returns whether one of them is an impulse that is given.
bool solveAxis(const Axis& axis, const AxisMotion& motion, AxisState& state,
               AxisRow (&rows)[Axis::parts]);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
