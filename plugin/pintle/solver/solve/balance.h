// Purpose: what a component's joints gave or took, back by its velocities; the poses at the end of the step stay. That is what they gave
// beyond their ledger; or all of it, where they can neither give nor take (isEven). Nothing, if then forces act in halves: so steps are symplectic,
// and what joints gave comes back.
#pragma once

#include <pintle/solver/cache/component_memory.h>
#include <pintle/solver/solve/pose_changes.h>
#include <pintle/solver/solver_options.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// J: what bodies have of their velocities because moving poses has turned them beside their way. Bullet keeps velocities, and not momenta.
double energyOfTurns(const Island& island, const Component& component, const Workspace& end);

/// Takes what is too much, or evens out what joints that do not give gave and took, by one factor of all velocities: of a component that hangs
/// on nothing, of all but its motion as one body, and so its momenta stay. Poses end at work.moved as before. Returns its work, J.
double balance(const Island& island, const Component& component, const SolverOptions& options,
               ComponentMemory& kept);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
