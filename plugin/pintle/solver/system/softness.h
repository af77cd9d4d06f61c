// Purpose: how much joints of loops give: their rows may repeat or contradict each other. Then K has no inverse, and is regularised by a
// part s of each row's own (Tikhonov 1963):
//   u + s K_rr Lambda = target,   s = min(dependent_softness, newton_tolerance / (dependent_margin dt |K_rr Lambda|))
#pragma once

#include <pintle/solver/solver_options.h>
#include <pintle/solver/system/workspace.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Of each joint: whether it may be in a loop: it is not where it can be taken off, end by end. `joints`: their bodies, -1: one that
/// does not move.
std::vector<char> findLoops(int bodies, const std::vector<std::array<int, 2>>& joints);

/// work.of_loop: of each joint, relative to the K of its rows.
void findSoftness(const Island& island, const Component& component, const SolverOptions& options,
                  const std::vector<char>& in_loop, Workspace& work);

/// Whether a row is open by more than `tolerance`, m or rad, or gives by as much in a loop: moving poses is to close it.
bool isOpen(const Island& island, const Component& component, const Workspace& end,
            double tolerance);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
