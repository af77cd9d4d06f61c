#include <pintle/solver/linear/fronts.h>

#include <pintle/solver/linear/minimum_degree.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using MatrixView = Eigen::Map<RowMajor, 0, Eigen::OuterStride<>>;

double dot(const double* a, const double* b, int n) {
  using Vector = Eigen::Map<const Eigen::VectorXd>;
  return Vector(a, n).dot(Vector(b, n));
}

// From this number of own unknowns on a front is eliminated in panels, which Eigen multiplies.
constexpr int panel = 32;

}  // namespace

void Fronts::addFront(const std::vector<int>& own, const std::vector<int>& boundary) {
  Front front = {};
  front.own_nodes = int(own.size());
  front.nodes = int(own.size() + boundary.size());
  front.first_node = int(m_nodes.size());
  front.is_of_loop = own[0] >= bodies();
  for (const int node : own)
    (node < bodies() ? m_body_front[size_t(node)] : m_joint_front[size_t(node - bodies())]) =
        int(m_fronts.size());
  m_nodes.insert(m_nodes.end(), own.begin(), own.end());
  m_nodes.insert(m_nodes.end(), boundary.begin(), boundary.end());
  m_fronts.push_back(front);
}

// A body that is left with one joint goes, with that joint.
void Fronts::peelTrees(const std::vector<Joint>& joints, std::vector<std::vector<int>>& incident,
                       std::vector<char>& done) {
  std::vector<int> left(incident.size()), ends;
  for (size_t i = 0; i < incident.size(); ++i) {
    left[i] = int(incident[i].size());
    if (left[i] <= 1) ends.push_back(int(i));
  }
  std::vector<char> joint_done(joints.size(), false);
  // In rounds, so that a chain is taken from both ends.
  for (size_t next = 0; next < ends.size(); ++next) {
    const int body = ends[next];
    if (done[size_t(body)]) continue;
    done[size_t(body)] = true;
    const auto& own = incident[size_t(body)];
    const auto joint =
        std::find_if(own.begin(), own.end(), [&](int c) { return !joint_done[size_t(c)]; });
    if (joint == own.end()) {
      addFront({body}, {});
      continue;
    }
    joint_done[size_t(*joint)] = true;
    const Joint& of = joints[size_t(*joint)];
    const int other = of[0] == body ? of[1] : of[0];
    if (other < 0) {
      addFront({body, bodies() + *joint}, {});
      continue;
    }
    addFront({body, bodies() + *joint}, {other});
    if (--left[size_t(other)] <= 1) ends.push_back(other);
  }
  for (auto& list : incident)
    list.erase(
        std::remove_if(list.begin(), list.end(), [&](int c) { return joint_done[size_t(c)]; }),
        list.end());
}

void Fronts::orderLoops(const std::vector<Joint>& joints,
                        const std::vector<std::vector<int>>& incident,
                        const std::vector<char>& done) {
  MinimumDegree order(joints.size());
  std::vector<int> left, boundary;
  std::vector<char> seen(joints.size(), false);
  for (size_t i = 0; i < incident.size(); ++i) {
    if (done[i]) continue;
    boundary.clear();
    for (const int c : incident[i]) {
      boundary.push_back(bodies() + c);
      if (!seen[size_t(c)]) left.push_back(c);
      seen[size_t(c)] = true;
    }
    addFront({int(i)}, boundary);
    order.addClique(incident[i]);
  }

  // Columns of which the next one has the same ones below it are one front.
  std::vector<MinimumDegree::Column> columns = order.order(left);
  std::vector<std::vector<int>> fronts(columns.size());  // the columns that each one ends
  std::vector<int> column_of(joints.size(), -1);
  for (size_t k = 0; k < columns.size(); ++k) column_of[size_t(columns[k].node)] = int(k);
  for (size_t k = 0; k < columns.size(); ++k) {
    std::vector<int>& coupled = columns[k].coupled;
    std::sort(coupled.begin(), coupled.end(),
              [&](int a, int b) { return column_of[size_t(a)] < column_of[size_t(b)]; });
    fronts[k].push_back(columns[k].node);
    if (!coupled.empty()) {
      const auto next = size_t(column_of[size_t(coupled.front())]);
      // (Its `coupled` is complete, though not sorted.)
      if (fronts[next].empty() && columns[next].coupled.size() + 1 == coupled.size()) {
        fronts[next] = std::move(fronts[k]);
        fronts[k].clear();
        continue;
      }
    }
    std::vector<int> own;
    for (const int c : fronts[k]) own.push_back(bodies() + c);
    boundary.clear();
    for (const int c : coupled) boundary.push_back(bodies() + c);
    addFront(own, boundary);
    fronts[k] = {columns[k].node};  // not empty: it takes no more
  }
}

void Fronts::analyse(int body_count, const std::vector<Joint>& joints) {
  m_joints = joints;
  m_fronts.clear();
  m_nodes.clear();
  m_body_front.assign(size_t(body_count), -1);
  m_joint_front.assign(joints.size(), -1);
  std::vector<std::vector<int>> incident(static_cast<size_t>(body_count));
  for (size_t c = 0; c < joints.size(); ++c)
    for (const int body : joints[c])
      if (body >= 0) incident[size_t(body)].push_back(int(c));
  std::vector<char> done(size_t(body_count), false);
  peelTrees(joints, incident, done);
  orderLoops(joints, incident, done);
  linkFronts();
}

// The parent of a front is the one that eliminates the first of its boundary.
void Fronts::linkFronts() {
  for (Front& front : m_fronts) {
    int parent = int(m_fronts.size());
    for (int i = front.own_nodes; i < front.nodes; ++i) {
      const int node = m_nodes[size_t(front.first_node + i)];
      parent = std::min(parent, node < bodies() ? m_body_front[size_t(node)]
                                                : m_joint_front[size_t(node - bodies())]);
    }
    front.parent = parent < int(m_fronts.size()) ? parent : -1;
  }
}

void Fronts::setSizes(const std::vector<int>& joint_sizes) {
  const size_t nodes = size_t(bodies()) + joint_sizes.size();
  m_size.assign(nodes, body_size);
  std::copy(joint_sizes.begin(), joint_sizes.end(), m_size.begin() + bodies());
  m_first.assign(nodes, 0);
  m_body_at.assign(size_t(bodies()), 0);
  m_joint_at.assign(joint_sizes.size(), 0);
  m_unknown.clear();
  m_in_parent.clear();
  m_unknowns = 0;
  for (const Front& front : m_fronts)
    for (int i = 0; i < front.own_nodes; ++i) {
      const int node = m_nodes[size_t(front.first_node + i)];
      m_first[size_t(node)] = m_unknowns;
      m_unknowns += nodeSize(node);
    }
  size_t numbers = 0;
  double factor = 0, solve = 0;  // multiplications
  int pivots = 0, largest = 0;
  for (Front& front : m_fronts) {
    front.own = front.all = 0;
    front.first_unknown = m_unknown.size();
    for (int i = 0; i < front.nodes; ++i) {
      const int node = m_nodes[size_t(front.first_node + i)], n = nodeSize(node);
      if (i < front.own_nodes) {
        (node < bodies() ? m_body_at[size_t(node)] : m_joint_at[size_t(node - bodies())]) =
            front.all;
        front.own += n;
      }
      front.all += n;
      for (int k = 0; k < n; ++k) m_unknown.push_back(m_first[size_t(node)] + k);
    }
    front.pivots = pivots;
    pivots += front.own;
    front.matrix = numbers;
    numbers += size_t(front.all) * size_t(front.all);
    largest = std::max(largest, front.all);
    for (int k = 0; k < front.own; ++k) {
      const double rest = front.all - k - 1;
      factor += rest * (rest + 1);
      solve += 2 * rest + 1;
    }
  }
  m_solves_of_factor = factor / std::max(solve, 1.);
  m_pivot.resize(size_t(pivots));
  m_numbers.resize(numbers);
  m_work.resize(size_t(largest));

  std::vector<int> at(size_t(m_unknowns), -1);
  for (const Front& front : m_fronts) {
    if (front.parent < 0) continue;
    const Front& parent = m_fronts[size_t(front.parent)];
    for (int i = 0; i < parent.all; ++i)
      at[size_t(m_unknown[parent.first_unknown + size_t(i)])] = i;
    const_cast<Front&>(front).first_in_parent = m_in_parent.size();
    for (int i = front.own; i < front.all; ++i)
      m_in_parent.push_back(at[size_t(m_unknown[front.first_unknown + size_t(i)])]);
  }

  m_places.resize(m_joints.size());
  m_pairs.resize(m_joints.size());
  for (size_t c = 0; c < m_joints.size(); ++c) {
    const Joint& bodies_of = m_joints[c];
    for (int side = 0; side < 2; ++side)
      if (bodies_of[size_t(side)] >= 0)
        m_places[c][size_t(side)] =
            find(std::min(m_body_front[size_t(bodies_of[size_t(side)])], m_joint_front[c]),
                 bodies_of[size_t(side)], int(c));
    m_pairs[c] = {-1, 0, 0};
    if (bodies_of[0] < 0 || bodies_of[1] < 0) continue;
    const int front =
        std::min(m_body_front[size_t(bodies_of[0])], m_body_front[size_t(bodies_of[1])]);
    const Place first = find(front, bodies_of[0], int(c)),
                second = find(front, bodies_of[1], int(c));
    if (first.body >= 0 && second.body >= 0) m_pairs[c] = {front, first.body, second.body};
  }
}

Fronts::Place Fronts::find(int index, int body, int joint) const {
  const Front& front = m_fronts[size_t(index)];
  Place place = {index, -1, -1};
  int at = 0;
  for (int i = 0; i < front.nodes; ++i) {
    const int node = m_nodes[size_t(front.first_node + i)];
    if (node == body) place.body = at;
    if (node == bodies() + joint) place.joint = at;
    at += nodeSize(node);
  }
  return place;
}

void Fronts::clear() { std::memset(m_numbers.data(), 0, m_numbers.size() * sizeof(double)); }

Fronts::Block Fronts::bodyBlock(int i) {
  const Front& front = m_fronts[size_t(m_body_front[size_t(i)])];
  return {matrix(front) + m_body_at[size_t(i)] * (front.all + 1), front.all};
}
Fronts::Block Fronts::jointBlock(int c) {
  const Front& front = m_fronts[size_t(m_joint_front[size_t(c)])];
  return {matrix(front) + m_joint_at[size_t(c)] * (front.all + 1), front.all};
}
Fronts::Block Fronts::jointBodyBlock(int c, int side) {
  const Place& place = m_places[size_t(c)][size_t(side)];
  const Front& front = m_fronts[size_t(place.front)];
  return {matrix(front) + place.joint * front.all + place.body, front.all};
}
Fronts::Block Fronts::bodyJointBlock(int c, int side) {
  const Place& place = m_places[size_t(c)][size_t(side)];
  const Front& front = m_fronts[size_t(place.front)];
  return {matrix(front) + place.body * front.all + place.joint, front.all};
}
bool Fronts::couplesBodies(int c) const { return m_pairs[size_t(c)][0] >= 0; }
Fronts::Block Fronts::bodyBodyBlock(int c, int side) {
  const auto& pair = m_pairs[size_t(c)];
  const Front& front = m_fronts[size_t(pair[0])];
  return {matrix(front) + pair[size_t(1 + side)] * front.all + pair[size_t(2 - side)], front.all};
}

// Own unknowns, all of them at once or panel by panel; the pivot of each is the largest of its column among the rows that are
// eliminated here.
bool Fronts::eliminate(const Front& front, double least_pivot) {
  const int n = front.all;
  double* const a = matrix(front);
  int* const pivot = m_pivot.data() + front.pivots;
  for (int first = 0; first < front.own; first += panel) {
    const int last = std::min(first + panel, front.own);
    // Beyond the panel only at its end, where there is enough to multiply.
    const bool wide = front.own > panel;
    const int width = wide ? last : n;
    for (int k = first; k < last; ++k) {
      int best = k;
      for (int i = k + 1; i < front.own; ++i)
        if (std::abs(a[i * n + k]) > std::abs(a[best * n + k])) best = i;
      pivot[k] = best;
      if (best != k) std::swap_ranges(a + k * n, a + (k + 1) * n, a + best * n);
      double& diagonal = a[k * n + k];
      if (std::abs(diagonal) < least_pivot) diagonal = std::copysign(least_pivot, diagonal);
      if (!(std::abs(diagonal) > 0) || !std::isfinite(diagonal)) return false;
      const double inverse = 1 / diagonal;
      const double* const row = a + k * n;
      for (int i = k + 1; i < n; ++i) {
        double* const to = a + i * n;
        if (to[k] == 0) continue;
        const double factor = to[k] *= inverse;
        for (int j = k + 1; j < width; ++j) to[j] -= factor * row[j];
      }
    }
    if (!wide || last == n) continue;
    MatrixView A(a, n, n, Eigen::OuterStride<>(n));
    const int rows = last - first, rest = n - last;
    A.block(first, first, rows, rows)
        .triangularView<Eigen::UnitLower>()
        .solveInPlace(A.block(first, last, rows, rest));
    A.block(last, last, rest, rest).noalias() -=
        A.block(last, first, rest, rows) * A.block(first, last, rows, rest);
  }
  return true;
}

void Fronts::addToParent(const Front& front) {
  const Front& parent = m_fronts[size_t(front.parent)];
  const int* const in_parent = m_in_parent.data() + front.first_in_parent;
  const int boundary = front.all - front.own;
  double* const to = matrix(parent);
  for (int i = 0; i < boundary; ++i) {
    const double* const from = matrix(front) + (front.own + i) * front.all + front.own;
    double* const row = to + in_parent[i] * parent.all;
    for (int j = 0; j < boundary; ++j) row[in_parent[j]] += from[j];
  }
}

bool Fronts::factorise(double least_pivot) {
  for (const Front& front : m_fronts) {
    if (!eliminate(front, least_pivot)) return false;
    if (front.parent >= 0) addToParent(front);
  }
  return true;
}

void Fronts::solve(double* x) const {
  double* const y = m_work.data();
  for (const Front& front : m_fronts) {
    const int n = front.all;
    const double* const a = matrix(front);
    const int* const unknown = m_unknown.data() + front.first_unknown;
    double* const own = x + unknown[0];  // its own are side by side
    for (int k = 0; k < front.own; ++k) {
      const int with = m_pivot[size_t(front.pivots + k)];
      if (with != k) std::swap(own[k], own[with]);
    }
    for (int i = 1; i < front.own; ++i) own[i] -= dot(a + i * n, own, i);
    for (int i = front.own; i < n; ++i) x[unknown[i]] -= dot(a + i * n, own, front.own);
  }
  for (size_t f = m_fronts.size(); f-- > 0;) {
    const Front& front = m_fronts[f];
    const int n = front.all;
    const double* const a = matrix(front);
    const int* const unknown = m_unknown.data() + front.first_unknown;
    double* const own = x + unknown[0];
    const int boundary = n - front.own;
    for (int i = 0; i < boundary; ++i) y[i] = x[unknown[front.own + i]];
    for (int i = front.own - 1; i >= 0; --i) {
      const double* const row = a + i * n;
      own[i] = (own[i] - dot(row + i + 1, own + i + 1, front.own - i - 1) -
                dot(row + front.own, y, boundary)) /
               row[i];
    }
  }
}

size_t Fronts::bytes() const {
  return sizeof(double) * (m_numbers.capacity() + m_work.capacity()) +
         sizeof(Front) * m_fronts.capacity() +
         sizeof(int) * (m_nodes.capacity() + m_unknown.capacity() + m_in_parent.capacity() +
                        m_pivot.capacity());
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
