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

namespace {

// The same elimination, a subtree of its tree after the other: what a column changes is near it in memory, and columns with the same
// rows follow each other (Liu 1990).
std::vector<MinimumDegree::Column> inPostorder(std::vector<MinimumDegree::Column> columns) {
  std::vector<int> place;  // of each node
  for (size_t k = 0; k < columns.size(); ++k) {
    place.resize(std::max(place.size(), size_t(columns[k].node) + 1));
    place[size_t(columns[k].node)] = int(k);
  }
  std::vector<std::vector<int>> children(columns.size());
  std::vector<int> waiting;  // roots, and then what is below them
  for (size_t k = 0; k < columns.size(); ++k) {
    int parent = int(columns.size());
    for (const int i : columns[k].coupled) parent = std::min(parent, place[size_t(i)]);
    (parent < int(columns.size()) ? children[size_t(parent)] : waiting).push_back(int(k));
  }
  // A parent before its children, all backwards.
  std::vector<MinimumDegree::Column> ordered;
  while (!waiting.empty()) {
    const auto k = size_t(waiting.back());
    waiting.pop_back();
    ordered.push_back(std::move(columns[k]));
    waiting.insert(waiting.end(), children[k].begin(), children[k].end());
  }
  std::reverse(ordered.begin(), ordered.end());
  return ordered;
}

}  // namespace

// All that are coupled to the first one, by how far they are from it; then the others.
std::vector<int> MinimumDegree::breadthFirst(const std::vector<int>& nodes) {
  std::vector<int> found;
  std::vector<char> is_found(m_degree.size(), false);
  const auto find = [&](int i) {
    if (is_found[size_t(i)]) return;
    is_found[size_t(i)] = true;
    found.push_back(i);
  };
  size_t next = 0;
  for (const int i : nodes) {
    find(i);
    for (; next < found.size(); ++next)
      for (const int k : reach(found[next])) find(k);
  }
  return found;
}

std::vector<MinimumDegree::Column> MinimumDegree::order(const std::vector<int>& nodes) {
  std::vector<Column> columns;
  // Ties go by how far a node is from one at the rim, and not by how nodes are numbered.
  std::vector<int> near = breadthFirst(nodes);
  std::reverse(near.begin(), near.end());
  near = breadthFirst(near);
  std::vector<int> rank(m_degree.size());
  for (size_t k = 0; k < near.size(); ++k) rank[size_t(near[k])] = int(k);
  // Degree, since when, and rank. Of the same degree, those come first that were coupled anew last: so what is eliminated is in one piece.
  using Entry = std::tuple<int, int, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
  for (const int i : nodes) queue.push({m_degree[size_t(i)], 0, rank[size_t(i)]});
  while (!queue.empty()) {
    const auto [degree, since, place] = queue.top();
    const int node = near[size_t(place)];
    queue.pop();
    if (m_gone[size_t(node)] || m_waits[size_t(node)] || degree != m_degree[size_t(node)]) continue;
    std::vector<int> coupled = reach(node);
    if (int(coupled.size()) < degree) {  // m_degree is an upper bound
      m_degree[size_t(node)] = int(coupled.size());
      queue.push({m_degree[size_t(node)], since, place});
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
      queue.push({m_degree[size_t(i)], -int(columns.size()), rank[size_t(i)]});
    }
    m_cliques.push_back(std::move(coupled));
  }
  return inPostorder(std::move(columns));
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
