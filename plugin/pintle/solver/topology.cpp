#include <pintle/solver/topology.h>

#include <algorithm>
#include <numeric>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// A world solves its islands in turn. An island that was not solved while all others were, so many times, is gone.
constexpr unsigned long long rounds_kept = 8;

// Disjoint sets of bodies.
class Sets {
 public:
  explicit Sets(int size) : m_leader(static_cast<size_t>(size)) {
    std::iota(m_leader.begin(), m_leader.end(), 0);
  }
  int find(int i) {
    while (m_leader[size_t(i)] != i)
      i = m_leader[size_t(i)] = m_leader[size_t(m_leader[size_t(i)])];
    return i;
  }
  /// False if they are in one set already.
  bool join(int a, int b) {
    a = find(a);
    b = find(b);
    m_leader[size_t(a)] = b;
    return a != b;
  }

 private:
  std::vector<int> m_leader;
};

void findComponents(Topology& topology) {
  const auto& joints = topology.joints;
  int bodies = 0;
  for (const auto& joint : joints)
    bodies = std::max({bodies, joint.body[0] + 1, joint.body[1] + 1});
  Sets with_ground(bodies + 1), without(bodies);
  topology.loops = false;
  for (const auto& joint : joints) {
    const int a = joint.body[0], b = joint.body[1];
    if (!with_ground.join(a < 0 ? bodies : a, b < 0 ? bodies : b)) topology.loops = true;
    if (a >= 0 && b >= 0) without.join(a, b);
  }
  std::vector<int> number(size_t(bodies), -1);
  topology.body_component.assign(size_t(bodies), -1);
  topology.component.clear();
  topology.components = 0;
  topology.grounded.clear();
  for (int c = 0; c < topology.elimination.columns(); ++c) {
    const auto& joint = joints[size_t(topology.elimination.node(c))];
    const int any = joint.body[0] >= 0 ? joint.body[0] : joint.body[1];
    int& component = number[size_t(without.find(any))];
    if (component < 0) {
      component = topology.components++;
      topology.grounded.push_back(false);
    }
    topology.component.push_back(component);
    for (const int body : joint.body) {
      if (body >= 0)
        topology.body_component[size_t(body)] = component;
      else
        topology.grounded[size_t(component)] = true;
    }
  }
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
  findComponents(topology);
}

}  // namespace

Topology& Topologies::get(const std::vector<Topology::Joint>& joints, const void* first) {
  ++m_uses;
  for (const auto& known : m_known) {
    if (known->first == first && known->joints == joints) {
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
  (*place)->first = first;
  (*place)->impulses.clear();
  (*place)->gained.clear();
  (*place)->chord_energy.clear();
  (*place)->compensation_left = 0;
  (*place)->iterated.clear();
  (*place)->at_bound.assign(Topology::joint_rows * joints.size(), Topology::inside);
  (*place)->last_use = m_uses;
  analyse(**place);
  return **place;
}

size_t Topologies::bytes() const {
  size_t sum = 0;
  for (const auto& known : m_known)
    sum += sizeof(Topology) + known->elimination.bytes() +
           known->joints.capacity() * sizeof(Topology::Joint) +
           (known->component.capacity() + known->body_component.capacity()) * sizeof(int) +
           known->grounded.capacity() +
           (known->impulses.capacity() + known->gained.capacity()) * sizeof(double) +
           known->chord_energy.capacity() * sizeof(Topology::ChordEnergy) +
           known->at_bound.capacity() * sizeof(Scalar) +
           known->iterated.capacity() * sizeof(Topology::Iterated);
  return sum;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
