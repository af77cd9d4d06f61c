// Purpose: K = J A^-1 J^T + softness of a component: what its rows lose of their velocities by their own impulses, all together. A
// holds the inertia of each body, 3 for the linear part and 3 x 3 for the turn.
//
// A body of d joints couples them all, d^2 / 2 of them. Where that is more than couple each to it, the body stays an unknown:
//   [K  J_h; J_h^T  -A_h] [impulses; velocities of these bodies]
// which is quasi-definite, and has a factor (linear/symmetric_factor.h). So a star is linear in its joints.
#pragma once

#include <pintle/solver/island.h>
#include <pintle/solver/linear/minimum_degree.h>
#include <pintle/solver/linear/symmetric_factor.h>

#include <utility>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Of an inertia about the axes that the body's factors leave free; 0 about the others.
Matrix3d inverseWhereFree(const IslandBody& body, Matrix3d inertia);

/// A^-1 of a body, in the world: 0 where its factors hold it.
struct InverseInertia {
  Vector3d linear;
  Matrix3d angular;
  double scale[2];  ///< square roots of the mass, and of a mean of the inertia

  /// With `stiffness` (kg m^2, symmetric, not negative) added to what turns.
  InverseInertia(const IslandBody& body, const Matrix3d& stiffness);
  /// Of an impulse, N s and N m s.
  Vector6d answer(const Vector3d& along, const Vector3d& about) const {
    Vector6d to;
    to << linear.cwiseProduct(along), angular * about;
    return to;
  }
};

class JointMatrix {
 public:
  /// The bodies of a joint; -1: one that is no unknown. Not both.
  using Joint = std::array<int, 2>;

  /// The axes that the factors of each body hold (IslandBody::locked).
  using Locks = std::vector<std::array<bool, 6>>;

  /// Symbolic: depends on who is coupled to whom, and on locks, alone. Allocates.
  void analyse(const std::vector<Joint>& joints, const Locks& locks);
  /// The number of rows of each joint, which may change from step to step. Must be called after analyse.
  void setSizes(const std::vector<int>& rows);

  /// A^-1 of each body, for who sets them before the rows.
  std::vector<InverseInertia>& bodies() { return m_bodies; }
  /// Row `i` of joint c, divided by root_K; `by_root_K` is 1 over that. All rows must be set before the first factor, and again where
  /// bodies have changed.
  void setRow(int c, int i, const RowJacobian& J, double root_K, double by_root_K);
  /// Whether the row at `at` acts (row, below), with a softness relative to K. One that does not has the impulse that is asked for, which
  /// answers (addResponse), but is no unknown. Set before each factor.
  void setActing(size_t at, bool acts, double softness) {
    const double next = acts ? softness : 1;
    if (m_softness[at] != next || (m_acts[at] != 0) != acts) m_is_factorised = false;
    m_softness[at] = next;
    m_acts[at] = acts;
  }
  /// (Nothing is done where it is the same matrix as before.)
  bool factorise(double least_pivot);
  /// How often it was, since the last time that this was asked.
  int takeFactorisations() { return std::exchange(m_factorisations, 0); }

  /// A vector of all unknowns. That of row i of joint c is at row(c, i): velocities divided by root_K before, impulses times root_K after
  /// x = K^-1 x. What lies between the joints' must be 0.
  size_t vectorSize() const { return size_t(stride) * size_t(m_factor.blocks()); }
  size_t row(int c, int i) const { return size_t(stride * m_node[size_t(c)] + i + i / block); }
  void solve(double* x) const { m_factor.solve(x); }
  /// Whether the velocity of a body is one of the unknowns.
  bool isUnknown(int body) const { return m_stays[size_t(body)]; }
  /// What joints do to impulses on bodies, and by these to other impulses: -R^T K^-1 R, R the rows' velocities of them without joints.
  /// K^-1 = L^-T D^-1 L^-1: so two impulses see each other by those blocks of L^-1 R that both have. `to`: those of an impulse of 1 along
  /// `J`, on one or two of the bodies (-1: none), are added. `most`: blocks that lie higher are left out. Their joints do not hold in
  /// what is found, so that all moves more easily than it does.
  void findPath(const Joint& bodies, const RowJacobian& J, int most, PathBlocks& to);
  /// Blocks: the longest path that may be cut. None where bodies are unknowns: joints that do not hold would leave these at rest.
  int longestPath() const { return m_longest_path; }
  /// v += A^-1 J^T x, x impulses times root_K.
  void addResponse(const double* x, Vector6d* v) const;
  /// x -= J v of the rows that act.
  void subtractVelocities(const Vector6d* v, double* x) const;
  /// Adds to v what holds the rows that act. `x`: memory for the unknowns.
  void hold(Vector6d* v, std::vector<double>& x) const {
    setZero(vectorSize(), x);
    subtractVelocities(v, x.data());
    solve(x.data());
    addResponse(x.data(), v);
  }
  /// x = `aim` - softness y - J v of the rows that act. Returns the largest, in m/s or rad/s; infinity if one is not a number.
  double findResidual(const double* aim, const double* y, const Vector6d* v, double* x) const;

  size_t bytes() const;

 private:
  static constexpr int block = block_size, stride = block_stride;
  /// Three rows of a joint on one of its bodies: J, a lane for each row, and A^-1 J^T of each, with two zeros.
  struct Rows {
    double J[6][stride] = {}, answer[block][2 * stride] = {};
  };
  /// A block of K, of a row and a column.
  struct Coupling {
    int row, column;
    size_t place;
  };
  /// What is added to one: of nodes i and k, by their rows on a body.
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

  bool isIdle(int node) const {
    const double* const acts = m_acts.data() + stride * node;
    return acts[0] == 0 && acts[1] == 0 && acts[2] == 0;
  }
  void assemble();
  bool findWhole();
  void leaveOutWhatDoesNotAct();
  void addProducts();
  int addVelocities(int body, const Vector6d& answer, double* x) const;
  Rows& rows(int node, int side) { return m_rows[size_t(2 * node + side)]; }
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
  std::vector<int> m_size;         ///< of each joint: rows
  std::vector<int> m_node;         ///< where each joint begins, and each body that stays
  std::vector<Joint> m_bodies_of;  ///< of each node; none: it is that of a body
  std::vector<char> m_rows_of;     ///< of each node: so many
  std::vector<char> m_is_whole;    ///< of each node: all of them act
  std::vector<Product> m_products;
  std::vector<Staying> m_staying;
  std::vector<Rows> m_rows;  ///< of each node on either body
  std::vector<Coupling> m_couplings;
  std::vector<double> m_root_K, m_softness;  ///< of each row
  std::vector<double> m_acts;                ///< of each row: 1, or 0
  bool m_is_assembled = false;  ///< m_matrix is that of the rows, but for nodes that were idle
  bool m_is_factorised = false;
  double m_least_pivot = 0;  ///< of that factor
  int m_factorisations = 0;
  std::vector<char> m_is_in_matrix;  ///< of each node
  std::vector<double>
      m_matrix;  ///< of all rows of those, without softness, where the factor has blocks
  std::vector<InverseInertia> m_bodies;
  std::vector<Matrix3d> m_inertia_of;  ///< of bodies that stay: their scaled inverse in the matrix
  SymmetricFactor m_factor;
  std::vector<double> m_path;  ///< a vector of all unknowns, of zeros
  int m_longest_path = 0;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
