// Purpose: joints and contacts together, in velocity. Rows are those of the start of the step,
//   M (v - v*) = J^T lambda,   J v and lambda of each row on its law (axis_law.h)
// Equalities hold whatever happens: they are eliminated by one factor. Rows that can yield, contacts and their friction, limits, motors,
// servos and friction of joints, are solved by projected Gauss-Seidel, among contacts on the Schur complement of the equalities
// (contact_response.h). In the end limits that press are rows of the factor, and hold as joints do. Where nothing touches, so are motors and
// friction that act.
//
// Each step minimises the dual function KE(v) - KE(v*) - lambda . target over some of the impulses. From none on, or from a warm start
// that is no worse, it never rises: so KE(v) is never above KE(v*), converged or not, but for what targets ask for. What such a
// step leaves open is closed by moving poses (projection.h).
#pragma once

#include <pintle/solver/solve/block_solver.h>
#include <pintle/solver/system/contact_response.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Memory of the passes.
struct PassMemory {
  size_t bytes() const { return bytesOf(base, bounds, blocks) + response.bytes(); }
  void reserve(size_t components, size_t of_bounds) {
    pintle::reserve(of_bounds, bounds);
    pintle::reserve(components, blocks);
  }

  std::vector<Vector6d> base;      ///< of each body: its velocity without impulses
  std::vector<ContactRow> bounds;  ///< rows of joints that are solved as contacts are, part by part
  std::vector<BlockSolver> blocks;
  ContactResponse response;
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
