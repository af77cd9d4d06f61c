// Purpose: joints and contacts together, in velocity. Rows are those of the start of the step,
//   M (v - v*) = J^T lambda,   J v and lambda of each row on its law (axis_law.h)
// and are solved by blocks: contacts one by one, the rows of a component of joints all at once, by the factor of their K.
//
// What rows ask for is that nothing moves along them. So each block takes as much kinetic energy as its impulses can: KE(v) never
// is above KE(v*), converged or not. What such a step leaves open is closed by moving poses (pose_correction.h).
#pragma once

#include <pintle/solver/contacts.h>
#include <pintle/solver/joint_matrix.h>
#include <pintle/solver/solver_options.h>
#include <pintle/solver/workspace.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct JointBlock {
  const Component* component;
  JointMatrix* K;
  Workspace* work;
};

/// all_at_once: the rows of a component, from the impulses of the last step. one_by_one: as contacts are, from none: this needs no
/// factor, and takes kinetic energy whatever happens.
enum class Sweep { all_at_once, one_by_one };

/// Of all bodies of the island: `velocities`, m/s and rad/s. Of each component: v, u, lambda and pieces of its workspace.
SolveReport solveInVelocity(const Island& island, std::vector<JointBlock>& blocks,
                            std::vector<ContactRow>& contacts, const SolverOptions& options,
                            Sweep sweep, int most, std::vector<Vector6d>& velocities);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
