// Purpose: K = J A^-1 J^T + softness of a component: what its rows lose of their velocities by their own impulses, all together. A
// holds the inertia of each body, 3 for the linear part and 3 x 3 for the turn.
//
// A body of d joints couples them all, d^2 / 2 of them. Where that is more than couple each to it, the body stays an unknown:
//   [K  J_h; J_h^T  -A_h] [impulses; velocities of these bodies]
// which is quasi-definite, and has a factor (linear/symmetric_factor.h). So a star is linear in its joints.
#pragma once

#include <pintle/solver/linalg/minimum_degree.h>
#include <pintle/solver/linalg/symmetric_factor.h>
#include <pintle/solver/system/row_blocks.h>

#include <utility>

namespace pintle {
inline namespace PINTLE_PRECISION {

class JointMatrix : public RowBlocks {
 public:
  /// The bodies of a joint; -1: one that is no unknown. Not both.
  using Joint = std::array<int, 2>;

  /// The axes that the factors of each body hold (IslandBody::locked).
  using Locks = std::vector<std::array<bool, 6>>;

  /// Symbolic: depends on who is coupled to whom, and on locks, alone. Allocates.
  void analyse(const std::vector<Joint>& joints, const Locks& locks);
  /// The number of rows of each joint, which may change from step to step. Must be called after analyse.
  void setSizes(const std::vector<int>& rows);

  /// (Nothing is done where it is the same matrix as before.)
  bool factorise(double least_pivot);
  /// How often it was, since the last time that this was asked.
  int takeFactorisations() { return std::exchange(m_factorisations, 0); }

  void solve(double* x) const { m_factor.solve(x); }
  /// Whether the velocity of a body is one of the unknowns.
  bool isUnknown(int body) const { return m_stays[size_t(body)]; }
  /// What joints do to impulses on bodies, and by these to other impulses: -R^T K^-1 R, R the rows' velocities of them without joints.
  /// K^-1 = L^-T D^-1 L^-1: so two impulses see each other by those blocks of L^-1 R that both have. `to`: those of an impulse of 1 along
  /// `J`, on one or two of the bodies (-1: none), are added.
  void findPath(const Joint& bodies, const RowJacobian& J, PathBlocks& to);
  /// The most blocks that impulses on a body have, and those of all bodies.
  int pathLength(int body) const;
  int longestPath() const { return m_longest_path; }
  /// Adds to v what holds the rows that act. `x`: memory for the unknowns.
  void hold(Vector6d* v, std::vector<double>& x) const {
    setZero(vectorSize(), x);
    subtractVelocities(v, x.data());
    solve(x.data());
    addResponse(x.data(), v);
  }
  size_t bytes() const;
  /// That its rows, its blocks and their factor have.
  size_t numbers() const {
    return m_rows.size() * sizeof(Rows) / sizeof(double) + m_matrix.size() + m_factor.numbers();
  }

 private:
  /// A block of K, of a row and a column. `place`: in the factor.
  struct Coupling {
    int row, column;
    size_t place;
  };
  /// What is added to one, at its place in m_matrix: of nodes i and k, by their rows on a body.
  struct Product {
    size_t place;
    int body, i, rows_i, k, rows_k;
    bool is_first;  ///< of those at this place
  };
  /// The same of a node and the linear or angular half of a body that stays.
  struct Staying {
    size_t place;
    int body, node, rows, half;
    bool is_row;  ///< the body is the row
  };
  struct End {
    int joint, side;
  };

  void assemble();
  bool findWhole();
  void leaveOutWhatDoesNotAct();
  void addProducts();
  void placeInMatrix();
  int addVelocities(int body, const Vector6d& answer, double* x) const;
  int nodesOf(int c) const { return (m_size[size_t(c)] + block - 1) / block; }
  int nodeOfBody(int b) const { return m_node[m_joints.size() + size_t(b)]; }
  template <class OfPair, class OfStaying>
  void forEachBlock(const OfPair& ofPair, const OfStaying& ofStaying) const;

  std::vector<Joint> m_joints;
  std::vector<std::vector<End>> m_ends;  ///< of each body, in the order of elimination
  std::vector<char> m_stays;             ///< of each body: it is an unknown
  /// In the order of elimination: joints, and bodies that stay (numbers from that of joints on), each with those later ones that it
  /// is coupled to.
  std::vector<MinimumDegree::Column> m_columns;
  std::vector<int> m_size;       ///< of each joint: rows
  std::vector<char> m_rows_of;   ///< of each node: so many
  std::vector<char> m_is_whole;  ///< of each node: all of them act
  std::vector<Product> m_products;
  std::vector<Staying> m_staying;
  std::vector<Coupling> m_couplings;
  double m_least_pivot = 0;  ///< of that factor
  int m_factorisations = 0;
  std::vector<char> m_is_in_matrix;  ///< of each node
  std::vector<double>
      m_matrix;  ///< of all rows of those, without softness: its blocks, in the order of the factor's
  std::vector<SymmetricFactor::Run> m_runs;  ///< of these
  std::vector<Matrix3d> m_inertia_of;  ///< of bodies that stay: their scaled inverse in the matrix
  SymmetricFactor m_factor;
  std::vector<double> m_path;  ///< a vector of all unknowns, of zeros
  int m_longest_path = 0;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
