// Purpose: how much joints of loops give: their rows may repeat or contradict each other.
#pragma once

#include <pintle/solver/newton.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// work.softness: of each joint, relative to the 1 / K of its rows.
void findSoftness(const Island& island, const Component& component, const SolverOptions& options,
                  const Fronts& fronts, Workspace& work);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
