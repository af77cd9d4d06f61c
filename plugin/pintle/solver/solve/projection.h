// Purpose: joints that are open are brought together by moving poses, which carries no momentum and feeds no kinetic energy: the standard
// projection (Hairer, Lubich and Wanner 2006, IV.4) of the poses q at the end of the step, in the metric of the masses,
//   d A d -> min   with   C(q + d) = 0:   d = A^-1 J^T lambda,   K lambda = -C(q),   K = J A^-1 J^T
// again from each q + d, by a factor of K that is kept while it contracts, with Broyden's corrections (broyden.h). Limits that are passed are
// among the C. Where they are in the way, equalities are closed without them.
#pragma once

#include <pintle/solver/solve/pose_changes.h>
#include <pintle/solver/solver_options.h>
#include <pintle/solver/system/broyden.h>
#include <pintle/solver/system/joint_matrix.h>
#include <pintle/solver/system/workspace.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct PosesReport {
  double open = 0;      ///< m or rad: what is left
  bool arrives = true;  ///< joints hold where velocities lead
  bool moves = false;   ///< bodies are moved beside the way of their velocities
};

/// Memory of it.
struct ProjectionMemory {
  void reserve(size_t bodies, size_t rows, size_t unknowns) {
    pintle::reserve(bodies, start, nearest, first, way);
    pintle::reserve(rows, u, goal, J, closes, bends, may_pass);
    pintle::reserve(unknowns, open);
    broyden.reserve(unknowns);
  }
  size_t bytes() const {
    return bytesOf(start, nearest, first, way, u, goal, J, closes, bends, may_pass, open) +
           broyden.bytes();
  }

  // Body by body:
  std::vector<MovedBody> start;    ///< at the end of the step
  std::vector<MovedBody> nearest;  ///< where least is open
  std::vector<MovedBody> first;    ///< where an earlier iteration or part of the way has led
  std::vector<Vector6d> way;       ///< an iteration, as a velocity
  // Row by row:
  std::vector<double> u, goal;  ///< measured over the step, and wanted
  std::vector<RowJacobian> J;   ///< where bodies are
  std::vector<char> closes;     ///< poses close it
  std::vector<char> bends;      ///< it is measured at the end
  std::vector<char> may_pass;   ///< poses may pass it
  std::vector<double> open;     ///< what was open at first, in the units of K
  Broyden broyden;
};

/// Of each body of the component: the least move, in the metric of the masses, that closes what its rows have open, and what the
/// velocities leave: Newton's iteration for the poses at the end of the step, work.moved. `has_factor`: K is that with which the velocities were
/// found, of the rows of the start.
PosesReport projectPoses(const Island& island, const Component& component,
                         const SolverOptions& options, Workspace& work, JointMatrix& K,
                         bool has_factor, ProjectionMemory& memory);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
