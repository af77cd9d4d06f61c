// Purpose: geometric stiffness (Tournier et al. 2015, Andrews et al. 2017): a joint's force f stays where its lever r turns, so that
// bodies swing about their joints under the load, by
//   I d2phi/dt2 = -G phi,   G = sum (r . f) 1 - (r f^T + f r^T) / 2
// Where that is faster than a step resolves, they get the least inertia S with which it is not: dt^2 G <= stable_swing (I + S).
#pragma once

#include <pintle/solver/solver_options.h>
#include <pintle/solver/system/joint_matrix.h>
#include <pintle/solver/system/workspace.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// work.load, with the impulses of a step. An impulse alone says little: where swings are not resolved, one step bears all and the
/// next one nothing.
void addLoad(const std::vector<double>& impulses, Workspace& work);

/// work.stiffness from work.load: what is added to the inertia of each body, kg m^2, so that it swings no faster than (w dt)^2 =
/// `stable_swing`. Of joints that hold a point or a distance.
void findStiffness(const Island& island, const Component& component, double stable_swing,
                   Workspace& work);

/// The same with the impulses that are found. Returns whether these make a body unstable with the inertia that was foreseen. (Too much
/// inertia only takes energy.)
bool foreseeLoad(const Island& island, const Component& component, double stable_swing,
                 Workspace& work);
/// The inertia of the bodies of K: their own, and work.stiffness.
void stiffen(const Island& island, const Component& component, const Workspace& work,
             JointMatrix& K);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
