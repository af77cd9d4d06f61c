// Purpose: constants of the exact solver that are no options, each with its unit, its reason, and what fails beyond it.
#pragma once

#include <pintle/precision.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Relative to the largest number of a sum in double precision: less may be rounding.
constexpr double rounding_share = 1e-9;

/// Fraction of what the bodies of a contact would give way alone: where joints leave less of it, and the bodies have no way out
/// without their joints, equalities hold the contact. Robots whose links overlap at their joints stay as calm as on Bullet's solver from
/// 0.005 to 0.04, and may blow up at 0.003.
constexpr double held_share = 1e-2;

/// Times the impulses of the last step: with so many at most a solve begins, where these are too little still. By doubling a motor gives all
/// its bound to a wall within a second at 10 iterations, whatever that is; with 1 one of 100 N m s does not. Without a bound, 9 of 100 machines of
/// links that collide are wilder than on Bullet's solver, by up to 240 times its energy.
constexpr double max_warm_start = 2;

/// Relative to the velocities to which forces lead: less may be rounding, some thousands of roundings of one number.
constexpr double rounding_of_velocities = 1e-12;
/// Relative to the energy to which forces alone would lead: what joints give may be rounding, while it is less. Of each body it is twice as much as
/// of its velocity, and a few bodies add.
constexpr double rounding_of_work = 10 * rounding_of_velocities;

/// Inertia about an axis about which a body does not turn at all, relative to the least one. The body follows rows about that
/// axis by less than rounding_share, and in world space its matrix still has four digits of the least one.
constexpr double unturned_inertia = 1e12;

/// Fraction of a row along each direction that its joint has at the end of the step: below it the row has turned away from all of them, and
/// is taken as it was at the start.
constexpr double least_part_along = 0.1;

/// (w dt)^2 of a swing of w rad/s, from which on explicit steps are not stable: there a root of z^2 + ((w dt)^2 - 2) z + 1 = 0 leaves
/// the unit circle.
constexpr double unstable_swing = 4;

/// Times newton_tolerance, over the length of a step: so fast rows may be where a step ends. A solve leaves them open by that tolerance, and what
/// closes it is no velocity of theirs. At 1 a taut cable of 30 links climbs in single precision, by 5 J a second; at 10 a limb that lies on
/// its limits quivers, at 1e-3 rad/s.
constexpr double end_margin = 3;

/// Rows that differ by less, relative to them, are the same: a step begins with those with which the last one ended, but for rounding.
constexpr double same_row = 1e-12;

/// Length of the shortest lever that turns rows, m. By d of their bodies (m and rad) they change by d^2 over it.
constexpr double least_lever = 1e-3;

/// Revolutions in a step: bodies that turn by more may have gone either way round.
constexpr double followed_turn = 0.25;

/// sin^2 of an angle: below it, it is found by a series, to rounding.
constexpr double sin2_of_series = 1e-5;

/// Backward differences of a body's velocities, with which its next one is foreseen: the motion of a joint is smooth, but for blows.
constexpr int forecast_differences = 4;

/// Nodes: from a leaf of a tree or a chain, this many are eliminated one after the other, which fills nothing. From there on every other one
/// is: that fills as much as a ring, and the rest of the path to the root grows with the logarithm of its length.
constexpr int elimination_chain = 16;

/// Relative to a row's own K: the most that rows of nets give while poses are moved, and times what they gave before in each try. A net's K goes
/// from 1e-8 (a skirt of flat plates) to 1. With 1e-4 at most, limits of a skirt are passed by 20 degrees, with 1e-2 by 6. A larger
/// factor saves tries and gives more than is needed.
constexpr double most_softness = 1e-2, softness_growth = 100;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
