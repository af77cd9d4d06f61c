// Purpose: joints that are open are brought together by moving poses, which carries no momentum and feeds no energy.
#pragma once

#include <pintle/solver/newton.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// m and rad, of a body.
using PoseChange = Vector6d;

/// Of each body of the component: the least move, in the metric of the masses, that closes what its rows have open, and what
/// the velocities left. `has_factor`: K has that with which they were found, which is good enough for what they left.
void correctPoses(const Island& island, const Component& component, const SolverOptions& options,
                  Workspace& work, JointMatrix& K, bool has_factor,
                  std::vector<PoseChange>& changes);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
