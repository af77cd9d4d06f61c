// Purpose: velocities that belong to the poses at the end of a step (RATTLE; Andersen 1983; Hairer, Lubich and Wanner, Geometric Numerical
// Integration, VII.1). The first tier's impulses p_0 along the rows of the start lead bodies to where their rows hold, with velocities that
// are those of the way there. Impulses p_1 along the rows of the end, J_1, make velocities hold them there:
//   J_1 v = target,   A (v - v_way) = J_1^T p_1
// of equalities, motors and limits that act; a limit's target is then 0, if it does not rebound. A row whose impulse p_0 + p_1 its law does
// not allow has no p_1. What yields by its softness has none either.
#pragma once

#include <pintle/solver/solver_options.h>
#include <pintle/solver/system/joint_matrix.h>
#include <pintle/solver/system/workspace.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Memory of it.
struct EndMemory {
  void reserve(size_t rows, size_t unknowns) {
    pintle::reserve(rows, holds, target, J);
    pintle::reserve(unknowns, lack_of_way, lack_of_end, impulses);
  }
  size_t bytes() const { return bytesOf(holds, target, J, lack_of_way, lack_of_end, impulses); }

  // Row by row:
  std::vector<char> holds;     ///< at the end
  std::vector<double> target;  ///< m/s or rad/s, less the velocity of static and kinematic bodies
  std::vector<RowJacobian> J;  ///< there
  // In the units of K: what rows that hold lack by the velocities of the way, and by those of the end; and p_1.
  std::vector<double> lack_of_way, lack_of_end, impulses;
};

struct EndVelocities {
  /// From those of the way. Not where forces act in halves: then the step is no such one, and is to be solved as others are.
  bool differ = false;
  /// J: what joints do by p_1, and because forces work along the way, and not along the mean of the velocities before and after the step.
  double work = 0;
  /// J: of the impulses p_1, and of p_0, which bear loads, too. Of motion on arcs one gives what the other one takes.
  double of_arcs = 0, of_first = 0;
};

/// From work.v, with which bodies go their way to work.moved, to velocities that hold there; work.way keeps the others. Impulses are added to
/// work.lambda and kept in work.at_end. K is that of the end, if anything was to be solved.
EndVelocities finishVelocities(const Island& island, const Component& component,
                               const SolverOptions& options, JointMatrix& K, Workspace& work,
                               EndMemory& memory);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
