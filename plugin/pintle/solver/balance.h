// Purpose: what a component's joints gave or took, back by its velocities; the poses at the end of the step stay.
//
// Bodies that joints hold on arcs go along their chords, with the chord's velocity. That gives energy while they come to turn faster,
// and takes it while they turn slower: in smooth motion, in each step, by the change of S = 1/8 (v - v*) M (v - v*).
#pragma once

#include <pintle/solver/pose_correction.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// J: the most that arcs hold, by the velocities with which the step ends: 2 S.
double energyOfArcs(const Island& island, const Component& component, const Workspace& end);
/// J: of the same, what is by turns alone, and by no load: 1/4 phi^2 of the kinetic energy, phi the largest turn in the step.
double energyOfTurns(const Island& island, const Component& component, const Workspace& end);
/// Whether that is all that joints give and take: not where a stop bears something, which takes, nor where a body turns further than
/// Bullet follows it (turn.h).
bool actsByArcs(const Island& island, const Component& component, const Workspace& end);
/// J: what joints may do that are open by `tolerance` (m or rad) at the end of the step.
double workOfGaps(const Island& island, const Component& component, const Workspace& end,
                  double tolerance);

/// Scales the velocities of the component by one factor, so that this works by -`energy` (J), or by as much of it as it can: it doubles
/// at most what there is. Of one that `is_free`, all but its motion as one body, and so its momenta stay. Returns its work.
double balance(const Island& island, const Component& component, bool is_free, double energy,
               std::vector<Vector6d>& v, PoseChange* changes);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
