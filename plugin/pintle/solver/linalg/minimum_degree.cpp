#include <pintle/solver/linalg/minimum_degree.h>

#include <pintle/solver/constants.h>

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
  std::vector<int> stack;  // roots, and then what is below them
  for (size_t k = 0; k < columns.size(); ++k) {
    int parent = int(columns.size());
    for (const int i : columns[k].coupled) parent = std::min(parent, place[size_t(i)]);
    (parent < int(columns.size()) ? children[size_t(parent)] : stack).push_back(int(k));
  }
  // A parent before its children, all backwards.
  std::vector<MinimumDegree::Column> ordered;
  while (!stack.empty()) {
    const auto k = size_t(stack.back());
    stack.pop_back();
    ordered.push_back(std::move(columns[k]));
    stack.insert(stack.end(), children[k].begin(), children[k].end());
  }
  std::reverse(ordered.begin(), ordered.end());
  return ordered;
}

}  // namespace

// Of those that are coupled to `root`, directly or by others: by how many steps (George and Liu 1981). Returns them, the nearest first.
std::vector<int> MinimumDegree::findLevels(int root, std::vector<int>& level) {
  std::vector<int> found = {root};
  level[size_t(root)] = 0;
  for (size_t next = 0; next < found.size(); ++next)
    for (const int i : reach(found[next])) {
      if (level[size_t(i)] >= 0) continue;
      level[size_t(i)] = level[size_t(found[next])] + 1;
      found.push_back(i);
    }
  return found;
}

// By their levels from a peripheral node, and then from one that is far from it and from its opposite. So neighbours stay together,
// however nodes are numbered.
std::vector<int> MinimumDegree::orderByLevels(const std::vector<int>& nodes) {
  const std::vector<int> unknown(m_degree.size(), -1);
  std::vector<int> from_any = unknown, first = unknown, opposite = unknown, second = unknown, all;
  for (const int node : nodes) {
    if (first[size_t(node)] >= 0) continue;
    const int peripheral = findLevels(node, from_any).back();
    std::vector<int> part = findLevels(peripheral, first);
    findLevels(part.back(), opposite);
    const auto leastLevel = [&](int i) { return std::min(first[size_t(i)], opposite[size_t(i)]); };
    const int aside = *std::max_element(
        part.begin(), part.end(), [&](int a, int b) { return leastLevel(a) < leastLevel(b); });
    findLevels(aside, second);
    std::stable_sort(part.begin(), part.end(), [&](int a, int b) {
      return std::pair(first[size_t(a)], second[size_t(a)]) <
             std::pair(first[size_t(b)], second[size_t(b)]);
    });
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

std::vector<MinimumDegree::Column> MinimumDegree::order(const std::vector<int>& nodes) {
  std::vector<Column> columns;
  const std::vector<int> ordered = orderByLevels(nodes);
  std::vector<int> rank(m_degree.size());
  for (size_t k = 0; k < ordered.size(); ++k) rank[size_t(ordered[k])] = int(k);
  // Degree, since when, and rank. Of the same degree, those come first that were coupled anew last: so what is eliminated is in one
  // piece. Not so where it makes no difference to what is filled: of trees, chains and rings those come last, so that paths to the
  // root are short.
  using Entry = std::tuple<int, int, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
  std::vector<int> since(m_degree.size(), 0), height(m_degree.size(), 0);
  const auto degreeOf = [&](int i) {
    const int degree = m_degree[size_t(i)];
    return height[size_t(i)] < elimination_chain ? degree : std::max(degree, 2);
  };
  const auto push = [&](int i) { queue.push({degreeOf(i), since[size_t(i)], rank[size_t(i)]}); };
  for (const int i : nodes) push(i);
  while (!queue.empty()) {
    const auto [degree, when, place] = queue.top();
    const int node = ordered[size_t(place)];
    queue.pop();
    if (m_gone[size_t(node)] || m_waits[size_t(node)] || degree != degreeOf(node) ||
        when != since[size_t(node)])
      continue;
    std::vector<int> coupled = reach(node);
    if (int(coupled.size()) < m_degree[size_t(node)]) {  // it is an upper bound
      m_degree[size_t(node)] = int(coupled.size());
      push(node);
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
      height[size_t(i)] = std::max(height[size_t(i)], height[size_t(node)] + 1);
      const int now = int(columns.size());
      since[size_t(i)] = m_degree[size_t(i)] <= 2 ? now : -now;
      push(i);
    }
    m_cliques.push_back(std::move(coupled));
  }
  return inPostorder(std::move(columns));
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
