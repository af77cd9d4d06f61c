// Purpose: what a component's joints gave or took, back by its velocities; the poses at the end of the step stay.
//
// Bodies that joints hold on arcs go along their chords, with the chord's velocity. That gives energy while they come to turn faster,
// and takes it while they turn slower: in smooth motion, in each step, by the change of S = 1/8 (v - v*) M (v - v*).
// Of v - v* = c + l, c holds bodies on arcs, and l bears a load. Where they swing about it, l M c is more than c M c; that is how average
// acceleration vibrates, which neither gains nor loses, and is left to it.
#pragma once

#include <pintle/solver/component_memory.h>
#include <pintle/solver/pose_changes.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Keeps what c holds, 1/4 c M c, or 0 where c M c is not more than 2 l M c, at the end of a step that was found by its factor K: before
/// K, or that end, is another one.
void keepWhirls(const Island& island, const Component& component, const SolverOptions& options,
                ComponentMemory& kept);

/// Whether joints gave or took by arcs what the ledger has in sum with this step, and it is known to more than what their gaps may do.
/// What c holds is kept.
bool isOfArcs(const Island& island, const Component& component, const SolverOptions& options,
              ComponentMemory& kept);

/// Arcs give back what was taken of them; else no more is taken than what is too much. It works by one factor of all velocities: of a
/// component that hangs on nothing, of all but its motion as one body, and so its momenta stay. Returns its work, J.
double balance(const Island& island, const Component& component, const SolverOptions& options,
               ComponentMemory& kept, PoseChange* changes);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
