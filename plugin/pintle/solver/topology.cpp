#include <pintle/solver/topology.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// A world solves its islands in turn: one that was not met while all others were, several times
// over, is gone.
constexpr unsigned long long rounds_kept = 8;

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
