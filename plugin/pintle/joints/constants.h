// Purpose: constants of the joints, each with its unit, its reason, and what fails beyond it: of their equations, and then of their rows on
// Bullet's iterating solvers.
#pragma once

#include <pintle/precision.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// 2 / (1 + cos(swing)) of a hinge, above which its axes are all but opposite, and its angle is none.
constexpr Scalar max_h_scale = 20;

/// cos^2 of the angle between the axes of a universal joint. Axes that are off their right angle by more than 60 degrees go back first: what acts
/// along the angles would be torques that fight about one direction.
constexpr Scalar max_cross_cosine2 = Scalar(0.75);

/// Cosine of the angle between the axes of a hinge, below which Bullet's angle may differ from the twist by more than the 0.3 rad that its
/// accumulated angle makes up for in a step.
constexpr Scalar min_cosine_of_axes = Scalar(0.9);

/// rad: the middle angle of a joint of six degrees of freedom that is locked, between two that are not, is within this of 0. Farther, their axes come
/// together.
constexpr Scalar max_locked_middle = Scalar(1.4);

/// rad/s, slow: angles that differ from Euler's come back to them at this speed (joints/euler_turn.h).
constexpr Scalar settling_speed = 1;

/// Cosine of 85 degrees: a spring about an outer angle keeps at least this fraction of its pull.
constexpr Scalar min_cosine_of_springs = Scalar(0.0872);

/// rad: a coordinate of a gear that changes in a step by so much more than twice what velocities have made of it was put elsewhere. With less,
/// what other joints close of theirs would be taken for that.
constexpr Scalar max_strange_turn = SIMD_PI / 4;

/// m: the same of a position. Joints close gaps at 1 m/s, 0.03 m in a step at 30 Hz.
constexpr Scalar max_strange_move = Scalar(0.25);

/// Fraction of a pose drive's bound that the torque along the expected one may have. With more, too little is left across it to stop what it did
/// not expect: ragdolls whose drives are at their bounds shake.
constexpr Scalar max_part_along = Scalar(0.95);

/// s: a joint is taken as one that starts apart for so long at most. What is still open then is held open by a load, or by a mouse that drags
/// it, and closes as ERP says.
constexpr Scalar longest_start = 1;

/// Fraction of the largest speeds of correction: a joint that is to be corrected at less has come together.
constexpr Scalar apart_fraction = Scalar(0.1);

/// A body's angular speed changes by this factor in a step at most, if its motion goes on as it does. Without it fast pendulums gain energy; with
/// 2 what jerks at the ends of short ropes is taken for motion, and opens them further than stock's.
constexpr Scalar max_spin_change = Scalar(1.05);

/// Fraction of the impulses of the last step from which equalities go on after the first pass. Less leaves chains and ragdolls further open than
/// stock's; with more, bridges swing for longer before they sleep, and links that overlap and collide have more energy than stock's.
constexpr Scalar warm_start = Scalar(0.5);

/// Passes: with so many at most a start that is not right is not made up for.
constexpr int few_passes = 2;

/// Fraction of K. Bullet iterates a soft row by lambda <- rhs - cfm lambda: from here on it diverges.
constexpr Scalar diverging_cfm = 1;

/// m/s and rad/s. Bullet makes no second pass if the first one changed nothing, or less than its residual threshold: what started then
/// would stay as it is. A row that the first one changed by more than this says that there is another.
constexpr Scalar goes_on = Scalar(1e-3);

/// Fraction of the largest impulse of a joint: what changes by no more between passes has only been rounded. (In single precision rows that are
/// orthogonal leave some tens of roundings.)
constexpr Scalar rounding_of_impulses = 64 * SIMD_EPSILON;

/// Passes: a joint may rest from this one on. (Two have to agree: btNNCGConstraintSolver moves bodies by what the last but one did.)
constexpr int passes_to_rest = 3;

/// rad: no joint leaves its bodies turning by more in a step. Bullet turns none by more than pi/4, but its gyroscopic term multiplies the
/// velocity of what turns by thousands.
constexpr Scalar max_turn_of_step = 1000;

/// m/s, rad/s: slower bodies stand still. Of an error a step leaves a part, or its rounding: after a few
/// steps a denormal, with which a processor is a hundred times as slow.
constexpr Scalar min_speed = SIMD_EPSILON * SIMD_EPSILON;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
