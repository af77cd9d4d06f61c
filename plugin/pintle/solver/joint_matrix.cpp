#include <pintle/solver/joint_matrix.h>

#include <pintle/solver/bytes.h>

#include <Eigen/LU>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {

Matrix3d inverseWhereFree(const IslandBody& body, Matrix3d inertia) {
  const auto isLocked = [&](int k) { return body.locked[size_t(3 + k)]; };
  for (int k = 0; k < 3; ++k)
    if (isLocked(k)) {
      inertia.row(k).setZero();
      inertia.col(k).setZero();
      inertia(k, k) = 1;
    }
  Matrix3d inverse = inertia.inverse();
  for (int k = 0; k < 3; ++k)
    if (isLocked(k)) inverse(k, k) = 0;
  return inverse;
}

InverseInertia::InverseInertia(const IslandBody& body, const Matrix3d& stiffness)
    : linear(body.inverse_mass),
      angular(stiffness.isZero(0) ? body.inverse_inertia
                                  : inverseWhereFree(body, body.inertia + stiffness)) {
  std::copy(body.scale, body.scale + 2, scale);
}

void JointMatrix::analyse(const std::vector<Joint>& joints, const Locks& locks) {
  const size_t bodies = locks.size();
  m_joints = joints;
  m_ends.assign(bodies, {});
  for (size_t c = 0; c < joints.size(); ++c)
    for (int side = 0; side < 2; ++side)
      if (joints[c][size_t(side)] >= 0)
        m_ends[size_t(joints[c][size_t(side)])].push_back({int(c), side});
  MinimumDegree order(joints.size() + bodies);
  std::vector<int> nodes;
  for (size_t c = 0; c < joints.size(); ++c) nodes.push_back(int(c));
  m_stays.assign(bodies, false);
  for (size_t b = 0; b < m_ends.size(); ++b) {
    const size_t d = m_ends[b].size();
    const int node = int(joints.size() + b);
    m_stays[b] = d * (d - 1) / 2 > 2 * d;  // it is two blocks
    if (!m_stays[b]) {
      std::vector<int> clique;
      for (const End& end : m_ends[b]) clique.push_back(end.joint);
      order.addClique(clique);
      continue;
    }
    nodes.push_back(node);
    order.frees(node);
    for (const End& end : m_ends[b]) order.addClique({node, end.joint});
  }
  // A joint of a body that stays has its pivot from the other one, and waits where that has none for it.
  const auto givesNoPivot = [&](int body, int staying) {
    if (body < 0 || m_stays[size_t(body)]) return true;
    for (size_t k = 0; k < 6; ++k)
      if (locks[size_t(body)][k] && !locks[size_t(staying)][k]) return true;
    return false;
  };
  for (size_t c = 0; c < joints.size(); ++c)
    for (size_t side = 0; side < 2; ++side) {
      const int body = joints[c][side];
      if (body >= 0 && m_stays[size_t(body)] && givesNoPivot(joints[c][1 - side], body))
        order.wait(int(c));
    }
  m_columns = order.order(nodes);
  std::vector<int> position(joints.size());
  for (size_t k = 0; k < m_columns.size(); ++k)
    if (m_columns[k].node < int(joints.size())) position[size_t(m_columns[k].node)] = int(k);
  for (auto& ends : m_ends)
    std::sort(ends.begin(), ends.end(), [&](const End& a, const End& b) {
      return position[size_t(a.joint)] < position[size_t(b.joint)];
    });
}

// Blocks that are added to: visit(body, row, end, column, end) of two ends on a body that does not stay, the row not
// before the column; and visit(node of the body, node of the joint, end) of one that does.
template <class OfPair, class OfStaying>
void JointMatrix::forEachBlock(const OfPair& ofPair, const OfStaying& ofStaying) const {
  for (size_t b = 0; b < m_ends.size(); ++b) {
    const auto& ends = m_ends[b];
    for (size_t p = 0; p < ends.size(); ++p) {
      const int first = m_node[size_t(ends[p].joint)], n = nodesOf(ends[p].joint);
      if (m_stays[b]) {
        for (int i = first; i < first + n; ++i) ofStaying(int(b), i, ends[p].side);
        continue;
      }
      for (size_t q = 0; q <= p; ++q) {
        const int before = m_node[size_t(ends[q].joint)];
        for (int i = first; i < first + n; ++i)
          for (int k = before; k < (p == q ? i + 1 : before + nodesOf(ends[q].joint)); ++k)
            ofPair(b, i, ends[p].side, k, ends[q].side);
      }
    }
  }
}

void JointMatrix::setSizes(const std::vector<int>& rows) {
  m_size = rows;
  m_node.assign(m_joints.size() + m_ends.size(), -1);
  const auto sizeOf = [&](int group) { return group < int(m_joints.size()) ? nodesOf(group) : 2; };
  int nodes = 0;
  for (const auto& column : m_columns) {
    m_node[size_t(column.node)] = nodes;
    nodes += sizeOf(column.node);
  }
  std::vector<std::vector<int>> coupled(static_cast<size_t>(nodes));
  for (const auto& column : m_columns) {
    const int first = m_node[size_t(column.node)], last = first + sizeOf(column.node);
    for (int k = first; k < last; ++k) {
      for (int i = k + 1; i < last; ++i) coupled[size_t(k)].push_back(i);
      for (const int other : column.coupled)
        for (int i = 0; i < sizeOf(other); ++i)
          coupled[size_t(k)].push_back(m_node[size_t(other)] + i);
    }
  }
  m_factor.analyse(std::move(coupled));
  m_rows.assign(2 * size_t(nodes), {});  // of a joint's last node, some rows may stay as they are
  m_root_K.assign(size_t(block * nodes), 1.);
  m_softness.assign(size_t(block * nodes), 1.);
  m_acts.assign(size_t(block * nodes), 0.);
  for (size_t b = 0; b < m_stays.size(); ++b)
    if (m_stays[b]) {
      const auto first = block * nodeOfBody(int(b));
      std::fill_n(m_softness.begin() + first, 2 * block, 0.);
      std::fill_n(m_acts.begin() + first, 2 * block, 1.);
    }
  m_matrix.assign(m_factor.numbers(), 0.);
  m_is_in_matrix.assign(size_t(nodes), false);
  m_is_assembled = false;
  m_places.clear();
  m_couplings.clear();
  forEachBlock(
      [&](size_t, int i, int, int k, int) {
        m_places.push_back(m_factor.place(i, k));
        m_couplings.push_back({i, k, m_places.back()});
      },
      [&](int b, int i, int) {
        for (int half = 0; half < 2; ++half) {
          const int node = nodeOfBody(b) + half, row = std::max(i, node),
                    column = std::min(i, node);
          m_places.push_back(m_factor.place(row, column));
          m_couplings.push_back({row, column, m_places.back()});
        }
      });
  std::sort(m_couplings.begin(), m_couplings.end(),
            [](const Coupling& a, const Coupling& b) { return a.place < b.place; });
  m_couplings.erase(
      std::unique(m_couplings.begin(), m_couplings.end(),
                  [](const Coupling& a, const Coupling& b) { return a.place == b.place; }),
      m_couplings.end());
}

void JointMatrix::setRow(int c, int i, const RowJacobian& J, double root_K) {
  const int node = m_node[size_t(c)] + i / block;
  const double by_root = 1 / root_K;
  m_root_K[row(c) + size_t(i)] = root_K;
  m_is_assembled = false;
  for (int side = 0; side < 2; ++side) {
    const int body = m_joints[size_t(c)][size_t(side)];
    if (body < 0) continue;
    Rows& to = rows(node, side);
    const Vector3d L = by_root * J.L(side), A = by_root * J.A(side);
    for (int k = 0; k < 3; ++k) {
      to.J[k][i % block] = L[k];
      to.J[3 + k][i % block] = A[k];
    }
    Eigen::Map<Vector6d>(to.answer[i % block]) = m_bodies[size_t(body)].answer(L, A);
  }
}

namespace {

using Lanes4d = Eigen::Matrix<double, 4, 1>;

// J v
inline Lanes4d velocity(const double (&J)[6][4], const double* v) {
  const Eigen::Map<const Eigen::Matrix<double, 4, 6>> columns(J[0]);
  Lanes4d u = v[0] * columns.col(0);
  for (int j = 1; j < 6; ++j) u += v[j] * columns.col(j);
  return u;
}

// to += a J^T, of three rows each.
inline void addProduct(const double (&a)[3][6], const double (&J)[6][4], double* to) {
  for (int r = 0; r < 3; ++r) {
    const Lanes4d row = velocity(J, a[r]);
    for (int s = 0; s < 3; ++s) to[3 * r + s] += row[s];
  }
}

}  // namespace

void JointMatrix::assemble() {
  m_is_assembled = true;  // but for nodes that are idle now
  std::fill(m_matrix.begin(), m_matrix.end(), 0.);
  const auto at = [&](size_t place) { return m_matrix.data() + place; };
  for (size_t b = 0; b < m_ends.size(); ++b) {
    if (!m_stays[b]) continue;
    const InverseInertia& body = m_bodies[b];
    double* const linear = at(m_factor.place(nodeOfBody(int(b)), nodeOfBody(int(b))));
    double* const angular = at(m_factor.place(nodeOfBody(int(b)) + 1, nodeOfBody(int(b)) + 1));
    for (int i = 0; i < 3; ++i) {
      linear[4 * i] = -1;
      for (int j = 0; j < 3; ++j)
        angular[3 * i + j] = -body.angular(i, j) * body.scale[1] * body.scale[1];
      if (!(body.angular(i, i) > 0)) angular[4 * i] = -1;
    }
  }
  for (int k = 0; k < m_factor.blocks(); ++k) m_is_in_matrix[size_t(k)] = !isIdle(k);
  size_t next = 0;
  forEachBlock(
      [&](size_t, int i, int side_i, int k, int side_k) {
        double* const to = at(m_places[next++]);
        if (m_is_in_matrix[size_t(i)] && m_is_in_matrix[size_t(k)])
          addProduct(rows(i, side_i).answer, rows(k, side_k).J, to);
      },
      [&](int b, int i, int side) {
        const Rows& of = rows(i, side);
        for (int half = 0; half < 2; ++half) {
          double* const to = at(m_places[next++]);
          if (!m_is_in_matrix[size_t(i)]) continue;
          const bool is_row = nodeOfBody(b) > i;
          for (int r = 0; r < block; ++r)
            for (int k = 0; k < 3; ++k)
              to[is_row ? block * k + r : block * r + k] +=
                  of.answer[r][3 * half + k] * m_bodies[size_t(b)].scale[half];
        }
      });
}

// Rows that do not act are coupled to nothing, and have 1 on the diagonal.
bool JointMatrix::factorise(double least_pivot) {
  for (int k = 0; m_is_assembled && k < m_factor.blocks(); ++k)
    m_is_assembled = m_is_in_matrix[size_t(k)] || isIdle(k);
  if (!m_is_assembled) assemble();
  m_factor.set(m_matrix);
  for (const Coupling& of : m_couplings) {
    if (isWhole(of.row) && isWhole(of.column)) continue;
    const double *const row = m_acts.data() + block * of.row, *const column =
                                                                  m_acts.data() + block * of.column;
    double* const to = m_factor.at(of.place);
    for (int r = 0; r < block; ++r)
      for (int s = 0; s < block; ++s)
        if (row[r] == 0 || column[s] == 0) to[block * r + s] = 0;
  }
  for (int k = 0; k < m_factor.blocks(); ++k) {
    if (isIdle(k)) m_factor.setIdle(k);
    double* const to = m_factor.at(m_factor.place(k, k));
    for (int i = 0; i < block; ++i) to[(block + 1) * i] += m_softness[size_t(block * k + i)];
  }
  return m_factor.factorise(least_pivot);
}

// A^-1 - A^-1 J^T K^-1 J A^-1, of which a body's own joints have their part. Of one that stays, its velocity is an unknown.
void JointMatrix::findAnswers(const std::vector<char>& asked, std::vector<Matrix6d>& answers) {
  m_factor.invertWhereFactored(m_inverse);
  answers.resize(m_ends.size());
  for (size_t b = 0; b < m_ends.size(); ++b) {
    if (m_stays[b] || !asked[b]) continue;
    answers[b].setZero();
    answers[b].diagonal().head<3>() = m_bodies[b].linear;
    answers[b].bottomRightCorner<3, 3>() = m_bodies[b].angular;
  }
  using Answers = Eigen::Map<const Eigen::Matrix<double, 6, 3>>;
  using Square = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
  size_t next = 0;
  const auto subtract = [&](size_t b, int i, int side_i, int k, int side_k) {
    const double* const of = m_inverse.data() + m_places[next++];
    if (!asked[b] || isIdle(i) || isIdle(k)) return;
    const Answers a(rows(i, side_i).answer[0]), c(rows(k, side_k).answer[0]);
    Eigen::Matrix<double, 3, 3> acting = Square(of);
    for (int r = 0; i == k && r < block; ++r)
      if (m_acts[size_t(block * i + r)] == 0) acting(r, r) = 0;
    const Eigen::Matrix<double, 6, 3> by = a.lazyProduct(acting);
    Matrix6d part = by.lazyProduct(c.transpose());
    if (i != k) part += part.transpose().eval();
    answers[b] -= part;
  };
  forEachBlock(subtract, [&](int, int, int) { next += 2; });
  for (size_t b = 0; b < m_ends.size(); ++b) {
    if (!m_stays[b] || !asked[b]) continue;
    const int node = nodeOfBody(int(b));
    Matrix6d W, by = Matrix6d::Zero();
    for (int p = 0; p < 2; ++p)
      for (int q = 0; q <= p; ++q) {
        const double* const of = m_inverse.data() + m_factor.place(node + p, node + q);
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j)
            W(3 * p + i, 3 * q + j) = W(3 * q + j, 3 * p + i) = -of[3 * i + j];
      }
    by.diagonal().head<3>() = m_bodies[b].scale[0] * m_bodies[b].linear;
    by.bottomRightCorner<3, 3>() = m_bodies[b].scale[1] * m_bodies[b].angular;
    answers[b] = by * W * by;
  }
}

void JointMatrix::addResponse(const double* x, Vector6d* v) const {
  for (size_t c = 0; c < m_joints.size(); ++c)
    for (int i = 0; i < nodesOf(int(c)); ++i) {
      const int node = m_node[c] + i;
      const double* const by = x + block * node;
      if (by[0] == 0 && by[1] == 0 && by[2] == 0) continue;
      for (int side = 0; side < 2; ++side) {
        const int body = m_joints[c][size_t(side)];
        if (body < 0) continue;
        const Eigen::Map<const Eigen::Matrix<double, 6, 3>> answer(
            m_rows[size_t(2 * node + side)].answer[0]);
        v[body] += by[0] * answer.col(0) + by[1] * answer.col(1) + by[2] * answer.col(2);
      }
    }
}

void JointMatrix::subtractVelocities(const Vector6d* v, double* x) const {
  for (size_t c = 0; c < m_joints.size(); ++c)
    for (int node = m_node[c]; node < m_node[c] + nodesOf(int(c)); ++node) {
      if (isIdle(node)) continue;
      Lanes4d u = Lanes4d::Zero();
      for (int side = 0; side < 2; ++side)
        if (const int body = m_joints[c][size_t(side)]; body >= 0)
          u += velocity(m_rows[size_t(2 * node + side)].J, v[body].data());
      const double* const acts = m_acts.data() + block * node;
      for (int r = 0; r < block; ++r) x[block * node + r] -= acts[r] * u[r];
    }
}

size_t JointMatrix::bytes() const {
  size_t sum = m_factor.bytes();
  for (const auto& ends : m_ends) sum += bytesOf(ends);
  for (const auto& column : m_columns) sum += bytesOf(column.coupled);
  return sum + bytesOf(m_joints, m_ends, m_stays, m_columns, m_size, m_node, m_places, m_rows,
                       m_couplings, m_root_K, m_softness, m_acts, m_is_in_matrix, m_matrix, m_bodies, m_inverse);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
