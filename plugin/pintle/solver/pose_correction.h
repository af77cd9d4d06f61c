// Purpose: joints that are open are brought together by moving poses, which carries no momentum and feeds no kinetic energy.
#pragma once

#include <pintle/solver/broyden.h>
#include <pintle/solver/solver_options.h>
#include <pintle/solver/workspace.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// m and rad, of a body: before its velocity moves it.
using PoseChange = Vector6d;

/// Whether a row is to be closed by moving poses.
bool isOpen(const Island& island, const Component& component);

/// Of each body of the component: the least move, in the metric of the masses, that closes what its rows have open, and what the
/// velocities leave: Newton's iteration for the poses at the end of the step. `has_factor`: K is that with which the velocities were
/// found, of the rows of the start. Returns what is left open, m or rad.
double correctPoses(const Island& island, const Component& component, const SolverOptions& options,
                    double tolerance, Workspace& work, JointMatrix& K, bool has_factor,
                    PoseChange* changes);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
