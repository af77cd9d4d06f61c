// Purpose: what the solve of a component of joints works with, and what it leaves.
#pragma once

#include <pintle/solver/broyden.h>
#include <pintle/solver/island.h>

#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct SolveReport {
  bool converged = false;
  bool is_solvable = true;  ///< which rows act was found, and they have a factor
  int steps = 0, factors = 0;
  double error = 0;  ///< the largest, m or rad
};

struct Workspace {
  std::vector<Vector6d> v;  ///< of each body: where the solve begins, and with which the step ends
  std::vector<double> u, lambda;  ///< of each row: its velocity, and its impulse, N s or N m s
  std::vector<double> load;      ///< of each row: its mean impulse in this step and those before it
  std::vector<LawPiece> pieces;  ///< of each row: the piece of its law on which it is
  std::vector<double> softness;  ///< of each row that acts, relative to 1 / K
  std::vector<Matrix3d> stiffness;  ///< of each body: added to its inertia (load_stiffness.h)
  std::vector<double> of_loop;      ///< of each joint: the softness of its rows (softness.h)

  /// What a solve has found.
  struct Solution {
    std::vector<Vector6d> v;
    std::vector<double> u, lambda;
    std::vector<LawPiece> pieces;
  };
  Solution solution() const { return {v, u, lambda, pieces}; }
  void take(const Solution& from) {
    v = from.v;
    u = from.u;
    lambda = from.lambda;
    pieces = from.pieces;
  }

  // Memory of the solves.
  std::vector<double> y, x;  ///< impulses, and a residual, in the units of K (joint_matrix.h)
  std::vector<double> y_before_pass, y_before_choice;
  std::vector<char> touched;                         ///< of each body: by contacts
  std::vector<Eigen::Matrix<double, 6, 6>> answers;  ///< of each body (JointMatrix::findAnswers)
  std::vector<Vector6d> base;  ///< of each body: its velocity without impulses of joints
  std::vector<MovedBody> moved;
  std::vector<double> straight, goal;  ///< of each row: other velocities
  std::vector<RowJacobian> J;          ///< of each row at the end of the step
  std::vector<char> closes, bends;     ///< of each row: whether moving poses closes it
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
