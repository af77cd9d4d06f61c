#include <pintle/solver/topology.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// A world solves its islands in turn: one that was not met while all others were, several times
// over, is gone.
constexpr unsigned long long rounds_kept = 8;

// Joints that connect what is connected already.
bool hasLoops(const std::vector<Topology::Joint>& joints) {
  int bodies = 0;
  for (const auto& joint : joints) bodies = std::max({bodies, joint.body[0] + 1, joint.body[1] + 1});
  std::vector<int> leader(static_cast<size_t>(bodies) + 1);  // the last one is the ground
  for (size_t i = 0; i < leader.size(); ++i) leader[i] = int(i);
  const auto find = [&](int body) {
    int i = body < 0 ? bodies : body;
    while (leader[size_t(i)] != i) i = leader[size_t(i)] = leader[size_t(leader[size_t(i)])];
    return i;
  };
  for (const auto& joint : joints) {
    const int a = find(joint.body[0]), b = find(joint.body[1]);
    if (a == b) return true;
    leader[size_t(a)] = b;
  }
  return false;
}

void analyse(Topology& topology) {
  std::vector<std::pair<int, int>> at;  // body, joint
  const auto& joints = topology.joints;
  for (size_t i = 0; i < joints.size(); ++i)
    for (const int body : joints[i].body)
      if (body >= 0) at.emplace_back(body, int(i));
  std::sort(at.begin(), at.end());
  std::vector<Elimination::Edge> edges;
  for (size_t i = 0; i < at.size(); ++i)
    for (size_t k = i + 1; k < at.size() && at[k].first == at[i].first; ++k)
      if (at[k].second != at[i].second) edges.emplace_back(at[i].second, at[k].second);
  topology.elimination.analyse(int(joints.size()), edges);
  topology.loops = hasLoops(joints);
  topology.rows.clear();
  for (int c = 0; c < topology.elimination.columns(); ++c)
    topology.rows.push_back(joints[size_t(topology.elimination.node(c))].rows);
}

}  // namespace

const Topology& Topologies::get(const std::vector<Topology::Joint>& joints) {
  ++m_uses;
  for (const auto& known : m_known) {
    if (known->joints == joints) {
      known->last_use = m_uses;
      return *known;
    }
  }
  const auto gone = [this](const std::unique_ptr<Topology>& known) {
    return known->last_use + rounds_kept * (m_known.size() + 1) < m_uses;
  };
  auto place = std::find_if(m_known.begin(), m_known.end(), gone);
  if (place == m_known.end()) place = m_known.insert(place, std::make_unique<Topology>());
  (*place)->joints = joints;
  (*place)->last_use = m_uses;
  analyse(**place);
  return **place;
}

size_t Topologies::bytes() const {
  size_t sum = 0;
  for (const auto& known : m_known)
    sum += sizeof(Topology) + known->elimination.bytes() +
           known->joints.capacity() * sizeof(Topology::Joint) +
           known->rows.capacity() * sizeof(int);
  return sum;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
