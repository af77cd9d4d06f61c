// Purpose: the first tier of a component of joints: impulses lambda along the rows of the start of the step, J_0, so that rows are on
// their laws (axis_law.h) at its end (SHAKE; Ryckaert 1977):
//   A (v - v_base) = J_0^T lambda,   u(v) and lambda of each row on its law
// Velocities follow from impulses. So K = J_0 A^-1 J_0^T is the chord of u by lambda: one symmetric factor, and a few solves with it
// (joint_matrix.h). They lead there by Broyden's method, which learns from each one what rows do otherwise.
#pragma once

#include <pintle/solver/system/active_set.h>
#include <pintle/solver/system/broyden.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Solves the component from work.v and work.lambda to there. `work.stiffness` is added to the inertia of its bodies. Where it does
/// not converge, work.v stays. What is missed by next to nothing of the kinetic energy to which forces alone would lead (J) is not
/// solved for: then the report has no steps, and K no factor.
/// Memory of the first tier.
struct ChordMemory {
  void reserve(size_t bodies, size_t unknowns) {
    pintle::reserve(bodies, base, change);
    broyden.reserve(unknowns);
  }
  size_t bytes() const { return bytesOf(base, change) + broyden.bytes(); }

  std::vector<Vector6d> base;    ///< of each body: its velocity without impulses of joints
  std::vector<Vector6d> change;  ///< of each body: of the velocity that is foreseen
  Broyden broyden;
};

SolveReport solveByChord(const Island& island, const Component& component,
                         const SolverOptions& options, double energy_by_forces, JointMatrix& K,
                         Workspace& work, ChordMemory& memory);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
