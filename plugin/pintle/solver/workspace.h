// Purpose: what the solve of a component of joints works with, and what it leaves.
#pragma once

#include <pintle/solver/broyden.h>
#include <pintle/solver/island.h>

#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct SolveReport {
  bool converged = false;
  int steps = 0, factors = 0;
  double error = 0;  ///< the largest, m or rad
};

struct Workspace {
  std::vector<Vector6d> v;  ///< of each body: where the solve begins, and with which the step ends
  std::vector<double> u, lambda;  ///< of each row: its velocity, and its impulse, N s or N m s
  std::vector<double> load;  ///< of each row: its mean impulse, of this step and of those before
  std::vector<LawPiece> pieces;  ///< of each row: the piece of its law on which it is
  std::vector<double> softness;  ///< of each row that acts, relative to 1 / K
  std::vector<double> y, x;      ///< impulses, and a residual, in the units of K (joint_matrix.h)
  std::vector<Matrix3d> stiffness;  ///< of each body: added to its inertia (chord.h)
  std::vector<double> of_loop;      ///< of each joint: the softness of its rows (softness.h)
  std::vector<Vector6d> base;       ///< of each body: its velocity without impulses of joints
  std::vector<MovedBody> moved;
  std::vector<double> straight, goal;
  std::vector<RowJacobian> J;
  std::vector<char> closes;
  struct Place {
    const IslandRow* row;
    int joint;
    size_t r, at;  ///< among the rows of the component, and among the unknowns of K
  };
  std::vector<Place> bounded, all;  ///< rows
  Broyden broyden;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
