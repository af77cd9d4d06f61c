// Purpose: joints and contacts together, in velocity. Rows are those of the start of the step,
//   M (v - v*) = J^T lambda,   J v and lambda of each row on its law (axis_law.h)
// and are solved by blocks: contacts one by one, the rows of a component of joints all at once, by the factor of their K. Rows with
// bounds are among the latter until contacts change which of them act, and then among the former.
//
// Each block minimises the dual function KE(v) - KE(v*) - lambda . target over its own impulses. From none on, it never rises: so
// KE(v) is never above KE(v*), converged or not, but for what targets ask for. What such a step leaves open is closed by moving
// poses (pose_correction.h).
#pragma once

#include <pintle/solver/block_solver.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Memory of the passes.
struct PassMemory {
  size_t bytes() const { return bytesOf(sources, touched, start, changes, bounds, blocks); }
  void reserve(size_t of_bodies, size_t components, size_t of_bounds) {
    pintle::reserve(of_bodies, sources, touched, start, changes);
    pintle::reserve(of_bounds, bounds);
    pintle::reserve(components, blocks);
  }

  struct Source {
    const InverseInertia* alone;               ///< null: it has no joints
    const JointMatrix::Matrix6d* with_joints;  ///< null: it has none, or they are not known yet
  };
  void prepare(size_t of_bodies) {
    sources.resize(of_bodies);
    touched.resize(of_bodies);
    start.resize(of_bodies);
    changes.resize(of_bodies);
  }
  std::vector<Source> sources;     ///< of each body: what impulses do to it
  std::vector<char> touched;       ///< of each body: by contacts
  std::vector<Vector6d> start;     ///< of each body: its velocity before a pass
  std::vector<Vector6d> changes;   ///< of each body: of the impulses of contacts, in a pass
  std::vector<ContactRow> bounds;  ///< rows of joints that are solved as contacts are, part by part
  std::vector<BlockSolver> blocks;
};

/// No stop of the component gives back any of the speed with which it is met. Returns whether one would have.
bool stopRebounds(Island& island, const Component& component);

/// Of these bodies of the island: `velocities`, m/s and rad/s (it has room for all). Of each component: v, u, lambda and pieces of its
/// workspace.
SolveReport solveInVelocity(const Island& island, std::vector<BlockOfJoints>& blocks,
                            Span<const int> bodies, Span<ContactRow> contacts,
                            const SolverOptions& options, Sweep sweep, int most,
                            std::vector<Vector6d>& velocities, PassMemory& memory);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
