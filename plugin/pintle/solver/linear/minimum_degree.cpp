#include <pintle/solver/linear/minimum_degree.h>

#include <algorithm>
#include <functional>
#include <queue>
#include <tuple>

namespace pintle {
inline namespace PINTLE_PRECISION {

void MinimumDegree::addClique(std::vector<int> members) {
  for (const int i : members) {
    m_cliques_of[size_t(i)].push_back(int(m_cliques.size()));
    m_degree[size_t(i)] += int(members.size()) - 1;
  }
  m_cliques.push_back(std::move(members));
}

std::vector<int> MinimumDegree::reach(int node) {
  std::vector<int> found;
  ++m_search;  // a node may be asked for more than once
  m_mark[size_t(node)] = m_search;
  for (const int clique : m_cliques_of[size_t(node)])
    for (const int i : m_cliques[size_t(clique)]) {
      if (m_gone[size_t(i)] || m_mark[size_t(i)] == m_search) continue;
      m_mark[size_t(i)] = m_search;
      found.push_back(i);
    }
  return found;
}

// m_outside, of cliques of these nodes. One that is all within them says nothing more.
void MinimumDegree::findOutside(const std::vector<int>& coupled) {
  m_outside.resize(m_cliques.size());
  for (const int i : coupled)
    for (const int clique : m_cliques_of[size_t(i)])
      m_outside[size_t(clique)] = int(m_cliques[size_t(clique)].size());
  for (const int i : coupled)
    for (const int clique : m_cliques_of[size_t(i)]) --m_outside[size_t(clique)];
  for (const int i : coupled)
    for (const int clique : m_cliques_of[size_t(i)])
      if (m_outside[size_t(clique)] <= 0) m_cliques[size_t(clique)].clear();
}

std::vector<MinimumDegree::Column> MinimumDegree::order(const std::vector<int>& nodes) {
  std::vector<Column> columns;
  // Degree, since when, and node: paths in the elimination tree stay short.
  using Entry = std::tuple<int, int, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
  for (const int i : nodes) queue.push({m_degree[size_t(i)], 0, i});
  while (!queue.empty()) {
    const auto [degree, since, node] = queue.top();
    queue.pop();
    if (m_gone[size_t(node)] || m_waits[size_t(node)] || degree != m_degree[size_t(node)]) continue;
    std::vector<int> coupled = reach(node);
    if (int(coupled.size()) < degree) {  // m_degree is an upper bound
      m_degree[size_t(node)] = int(coupled.size());
      queue.push({m_degree[size_t(node)], since, node});
      continue;
    }
    columns.push_back({node, coupled});
    m_gone[size_t(node)] = true;
    for (const int clique : m_cliques_of[size_t(node)]) m_cliques[size_t(clique)].clear();
    findOutside(coupled);
    for (const int i : coupled) {
      if (m_frees[size_t(node)]) m_waits[size_t(i)] = false;
      auto& mine = m_cliques_of[size_t(i)];
      mine.erase(std::remove_if(mine.begin(), mine.end(),
                                [&](int clique) { return m_cliques[size_t(clique)].empty(); }),
                 mine.end());
      mine.push_back(int(m_cliques.size()));
      int bound = 0;
      for (size_t c = 0; c + 1 < mine.size(); ++c) bound += m_outside[size_t(mine[c])];
      m_degree[size_t(i)] = bound + int(coupled.size()) - 1;
      queue.push({m_degree[size_t(i)], int(columns.size()), i});
    }
    m_cliques.push_back(std::move(coupled));
  }
  return columns;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
