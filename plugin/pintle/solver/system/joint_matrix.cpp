#include <pintle/solver/system/joint_matrix.h>

#include <pintle/solver/linalg/memory.h>

#include <algorithm>
#include <numeric>

namespace pintle {
inline namespace PINTLE_PRECISION {

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
  const size_t vector_size = size_t(stride) * size_t(nodes);
  m_root_K.assign(vector_size, 1.);
  m_softness.assign(vector_size, 1.);
  m_acts.assign(vector_size, 0.);
  m_bodies_of.assign(size_t(nodes), {-1, -1});
  m_rows_of.assign(size_t(nodes), block);
  m_is_whole.assign(size_t(nodes), false);
  for (size_t c = 0; c < m_joints.size(); ++c) {
    const int count = nodesOf(int(c));
    std::fill_n(m_bodies_of.begin() + m_node[c], count, m_joints[c]);
    if (count > 0) m_rows_of[size_t(m_node[c] + count - 1)] = char(m_size[c] - block * (count - 1));
  }
  for (size_t b = 0; b < m_stays.size(); ++b)
    for (int half = 0; m_stays[b] && half < 2; ++half)
      for (int i = 0; i < block; ++i) {
        const auto at = size_t(stride * (nodeOfBody(int(b)) + half) + i);
        m_softness[at] = 0;
        m_acts[at] = 1;
      }
  m_path.assign(vector_size, 0.);
  m_longest_path = 0;
  for (size_t b = 0; b < m_ends.size(); ++b)
    m_longest_path = std::max(m_longest_path, pathLength(int(b)));
  m_is_in_matrix.assign(size_t(nodes), false);
  m_is_assembled = m_is_factorised = false;
  m_inertia_of.assign(m_stays.size(), Matrix3d::Zero());
  m_products.clear();
  m_staying.clear();
  m_couplings.clear();
  std::vector<bool> is_taken(m_factor.numbers());
  forEachBlock(
      [&](size_t b, int i, int side_i, int k, int side_k) {
        const size_t place = m_factor.place(i, k);
        m_products.push_back(
            {place, int(b), i, 2 * i + side_i, k, 2 * k + side_k, !is_taken[place]});
        is_taken[place] = true;
        m_couplings.push_back({i, k, place});
      },
      [&](int b, int i, int side) {
        for (int half = 0; half < 2; ++half) {
          const int node = nodeOfBody(b) + half, row = std::max(i, node),
                    column = std::min(i, node);
          m_staying.push_back({m_factor.place(row, column), b, i, 2 * i + side, half, row == node});
          m_couplings.push_back({row, column, m_staying.back().place});
        }
      });
  std::sort(m_couplings.begin(), m_couplings.end(),
            [](const Coupling& a, const Coupling& b) { return a.place < b.place; });
  m_couplings.erase(
      std::unique(m_couplings.begin(), m_couplings.end(),
                  [](const Coupling& a, const Coupling& b) { return a.place == b.place; }),
      m_couplings.end());
  placeInMatrix();
}

// The factor has more blocks than K. What these are set to is kept close together.
void JointMatrix::placeInMatrix() {
  const size_t diagonal = size_t(block_area) * size_t(m_factor.blocks());
  size_t numbers = diagonal;
  m_runs.assign(1, {0, diagonal});
  std::vector<size_t> places(m_factor.numbers());
  std::iota(places.begin(), places.begin() + std::ptrdiff_t(diagonal), size_t(0));
  for (const Coupling& of : m_couplings) {
    if (of.place < diagonal) continue;
    places[of.place] = numbers;
    numbers += block_area;
    SymmetricFactor::Run& last = m_runs.back();
    if (last.place + last.numbers == of.place)
      last.numbers += block_area;
    else
      m_runs.push_back({of.place, block_area});
  }
  for (Product& of : m_products) of.place = places[of.place];
  for (Staying& of : m_staying) of.place = places[of.place];
  m_matrix.assign(numbers, 0.);
}

PINTLE_TARGET_CLONES void JointMatrix::addProducts() {
  for (const Product& of : m_products) {
    if (!m_is_in_matrix[size_t(of.i)] || !m_is_in_matrix[size_t(of.k)]) continue;
    const Rows &i = m_rows[size_t(of.rows_i)], &k = m_rows[size_t(of.rows_k)];
    double* const to = m_matrix.data() + of.place;
    for (int s = 0; s < block; ++s) {
      FourLanes column;
      if (!of.is_first) column = FourLanes(to + stride * s);
      addVelocity(i.J, k.answer[s], column);
      column.store(to + stride * s);
    }
  }
}

void JointMatrix::assemble() {
  m_is_assembled = true;
  const auto in = inBlock;
  for (size_t b = 0; b < m_ends.size(); ++b) {
    if (!m_stays[b]) continue;
    const InverseInertia& body = m_bodies[b];
    const int node = nodeOfBody(int(b));
    double* const linear = m_matrix.data() + m_factor.place(node, node);
    double* const angular = m_matrix.data() + m_factor.place(node + 1, node + 1);
    for (int i = 0; i < 3; ++i) {
      linear[in(i, i)] = -1;
      for (int j = 0; j < 3; ++j)
        angular[in(i, j)] = -body.angular(i, j) * body.scale[1] * body.scale[1];
      if (!(body.angular(i, i) > 0)) angular[in(i, i)] = -1;
    }
  }
  for (int k = 0; k < m_factor.blocks(); ++k) m_is_in_matrix[size_t(k)] = !isIdle(k);
  addProducts();
  for (const Staying& of : m_staying) {
    if (!m_is_in_matrix[size_t(of.node)]) continue;
    const Rows& rows = m_rows[size_t(of.rows)];
    double* const to = m_matrix.data() + of.place;
    for (int r = 0; r < block; ++r)
      for (int k = 0; k < 3; ++k)
        to[of.is_row ? in(k, r) : in(r, k)] =
            rows.answer[r][3 * of.half + k] * m_bodies[size_t(of.body)].scale[of.half];
  }
}

// Returns whether all rows of all nodes act.
bool JointMatrix::findWhole() {
  bool all = true;
  for (size_t node = 0; node < m_rows_of.size(); ++node) {
    const double* const acts = m_acts.data() + stride * node;
    bool whole = true;
    for (int i = 0; i < m_rows_of[node]; ++i) whole = whole && acts[i] != 0;
    m_is_whole[node] = whole;
    all = all && whole;
  }
  return all;
}

PINTLE_TARGET_CLONES void JointMatrix::leaveOutWhatDoesNotAct() {
  for (const Coupling& of : m_couplings) {
    if (m_is_whole[size_t(of.row)] && m_is_whole[size_t(of.column)]) continue;
    const FourLanes rows(m_acts.data() + stride * of.row);
    const double* const columns = m_acts.data() + stride * of.column;
    double* const to = m_factor.at(of.place);
    for (int s = 0; s < block; ++s) {
      FourLanes column(to + stride * s);
      column.multiply(rows);
      column.scale(columns[s]);
      column.store(to + stride * s);
    }
  }
}

// Rows that do not act are coupled to nothing, and have 1 on the diagonal.
bool JointMatrix::factorise(double least_pivot) {
  for (size_t b = 0; b < m_stays.size(); ++b) {
    if (!m_stays[b]) continue;
    const Matrix3d inertia = m_bodies[b].scale[1] * m_bodies[b].angular;
    if (isSame(m_inertia_of[b], inertia)) continue;
    m_inertia_of[b] = inertia;
    m_is_assembled = m_is_factorised = false;
  }
  if (m_is_factorised && m_least_pivot == least_pivot) return true;
  m_least_pivot = least_pivot;
  for (int k = 0; m_is_assembled && k < m_factor.blocks(); ++k)
    m_is_assembled = m_is_in_matrix[size_t(k)] || isIdle(k);
  if (!m_is_assembled) assemble();
  m_factor.set(m_matrix, m_runs);
  if (!findWhole()) leaveOutWhatDoesNotAct();
  const auto in = inBlock;
  for (int k = 0; k < m_factor.blocks(); ++k) {
    if (isIdle(k)) m_factor.setIdle(k);
    double* const to = m_factor.at(m_factor.place(k, k));
    for (int i = 0; i < block; ++i) to[in(i, i)] += m_softness[size_t(stride * k + i)];
  }
  ++m_factorisations;
  m_is_factorised = m_factor.factorise(least_pivot);
  if (!m_is_factorised) {  // what is no number must not stay where nodes are idle later
    m_is_assembled = false;
    std::fill(m_matrix.begin(), m_matrix.end(), 0.);
  }
  return m_is_factorised;
}

size_t JointMatrix::bytes() const {
  size_t sum = m_factor.bytes();
  for (const auto& ends : m_ends) sum += bytesOf(ends);
  for (const auto& column : m_columns) sum += bytesOf(column.coupled);
  return sum + bytesOf(m_joints, m_ends, m_stays, m_columns, m_size, m_node, m_bodies_of,
                       m_products, m_staying, m_rows, m_rows_of, m_is_whole, m_couplings, m_root_K,
                       m_softness, m_acts, m_is_in_matrix, m_matrix, m_runs, m_bodies, m_inertia_of,
                       m_path);
}

// Joints answer to impulses on their bodies by the paths of these through the factor.

// x += R of an impulse that gives this to the body. Returns the first node that has a part of it: all others are on its path. Of a body
// that stays, its velocity is an unknown.
PINTLE_TARGET_CLONES int JointMatrix::addVelocities(int body, const Vector6d& answer,
                                                    double* x) const {
  if (m_stays[size_t(body)]) {
    const int node = nodeOfBody(body);
    for (int half = 0; half < 2; ++half)
      for (int i = 0; i < 3; ++i)
        x[stride * (node + half) + i] += m_bodies[size_t(body)].scale[half] * answer[3 * half + i];
    return node;
  }
  int from = m_factor.blocks();
  for (const End& end : m_ends[size_t(body)]) {
    const int first = m_node[size_t(end.joint)], last = first + nodesOf(end.joint);
    for (int node = first; node < last; ++node) {
      from = std::min(from, node);
      if (isIdle(node)) continue;
      const Rows& rows = m_rows[size_t(2 * node + end.side)];
      FourLanes u, to(x + stride * node);
      for (int j = 0; j < 6; ++j) u.add(FourLanes(rows.J[j]), answer[j]);
      to.add(u, FourLanes(&m_acts[size_t(stride * node)]));
      to.store(x + stride * node);
    }
  }
  return from;
}

void JointMatrix::findPath(const Joint& bodies, const RowJacobian& J, PathBlocks& to) {
  int from[2] = {m_factor.blocks(), m_factor.blocks()};
  for (int side = 0; side < 2; ++side) {
    const int body = bodies[size_t(side)];
    if (body < 0) continue;
    from[side] =
        addVelocities(body, m_bodies[size_t(body)].answer(J.L(side), J.A(side)), m_path.data());
  }
  m_factor.followPaths(from[0], from[1], m_path.data(), to);
}

int JointMatrix::pathLength(int body) const {
  if (m_stays[size_t(body)]) return m_factor.pathLength(nodeOfBody(body));
  int from = m_factor.blocks();
  for (const End& end : m_ends[size_t(body)])
    if (nodesOf(end.joint) > 0) from = std::min(from, m_node[size_t(end.joint)]);
  return m_factor.pathLength(from);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
