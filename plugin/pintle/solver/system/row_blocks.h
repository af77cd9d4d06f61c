// Purpose: J of the rows of a component, three at a time, and A^-1 J^T, A the inertia of each body: products of both with vectors, and
// what rows lack of their aim, x = aim - softness y - J v.
#pragma once

#include <pintle/solver/constants.h>
#include <pintle/solver/linalg/block_columns.h>
#include <pintle/solver/model/inverse_inertia.h>

#include <array>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Of nodes: up to three rows of one joint. Who makes them says which bodies they are on (JointMatrix).
class RowBlocks {
 public:
  /// A^-1 of each body, for who sets them before the rows.
  std::vector<InverseInertia>& bodies() { return m_bodies; }
  /// Row `i` of joint c, divided by root_K; `by_root_K` is 1 over that. All rows must be set before the first factor, and again where
  /// bodies have changed.
  void setRow(int c, int i, const RowJacobian& J, double root_K, double by_root_K);
  /// The same, divided by the root of its own K, or by `else_by` where it has none. Returns which.
  double setRowByItsK(int c, int i, const RowJacobian& J, double else_by);
  /// The same of all rows of joint c.
  void setRows(int c, const IslandRow* from, int count);
  /// Whether the row at `at` acts (row, below), with a softness relative to K. One that does not has the impulse that is asked for, which
  /// answers (addResponse), but is no unknown. Set before each factor.
  void setActing(size_t at, bool acts, double softness) {
    const double next = acts ? softness : 1;
    if (m_softness[at] == next && (m_acts[at] != 0) == acts) return;
    m_is_factorised = false;
    m_softness[at] = next;
    m_acts[at] = acts;
  }
  /// A vector of all unknowns. That of row i of joint c is at row(c, i): velocities divided by root_K before, impulses times root_K after
  /// x = K^-1 x. What lies between the joints' must be 0.
  size_t vectorSize() const { return size_t(stride) * m_bodies_of.size(); }
  size_t row(int c, int i) const { return size_t(stride * m_node[size_t(c)]) + rowOfJoint(i); }
  /// From the first one of a joint on.
  static size_t rowOfJoint(int i) { return size_t(i + i / block); }
  /// v += A^-1 J^T x, x impulses times root_K.
  void addResponse(const double* x, Vector6d* v) const;
  /// x -= J v of the rows that act.
  void subtractVelocities(const Vector6d* v, double* x) const;
  /// x = `aim` - softness y - J v of the rows that act. Returns the largest, in m/s or rad/s; infinity if one is not a number.
  double findResidual(const double* aim, const double* y, const Vector6d* v, double* x) const;

 protected:
  static constexpr int block = block_size, stride = block_stride;
  /// Three rows of a joint on one of its bodies: J, a lane for each row, and A^-1 J^T of each, with two zeros.
  struct Rows {
    double J[6][stride] = {}, answer[block][2 * stride] = {};
  };

  bool isIdle(int node) const {
    const double* const acts = m_acts.data() + stride * node;
    return acts[0] == 0 && acts[1] == 0 && acts[2] == 0;
  }
  Rows& rows(int node, int side) { return m_rows[size_t(2 * node + side)]; }
  /// A row that moves a body by L and A, and is answered so.
  void set(Rows& to, int lane, const Vector3d& L, const Vector3d& A, const Vector6d& answer);

  std::vector<int> m_node;  ///< where each joint begins, and what else has nodes
  std::vector<std::array<int, 2>> m_bodies_of;  ///< of each node; -1: none
  std::vector<Rows> m_rows;                     ///< of each node on either body
  std::vector<double> m_root_K, m_softness;     ///< of each row
  std::vector<double> m_acts;                   ///< of each row: 1, or 0
  std::vector<InverseInertia> m_bodies;
  // Of a matrix of the rows: that it is up to date.
  bool m_is_assembled = false;  ///< but for nodes that were idle
  bool m_is_factorised = false;
};

/// Equality, but for rounding: a step begins with the rows with which the last one ended.
template <class A, class B>
bool isSame(const A& a, const B& b) {
  const double missed2 = (a - b).squaredNorm();
  return missed2 == 0 ||
         missed2 < same_row * same_row * b.squaredNorm();  // not where both overflow
}

/// u += J v
PINTLE_INLINE void addVelocity(const double (&J)[6][FourLanes::count], const double* v,
                               FourLanes& u) {
  for (int j = 0; j < 6; ++j) u.add(FourLanes(J[j]), v[j]);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
