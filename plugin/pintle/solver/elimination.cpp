#include <pintle/solver/elimination.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <tuple>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

using Nodes = std::vector<int>;  // sorted, each once

std::vector<Nodes> neighbours(int nodes, const std::vector<Elimination::Edge>& edges) {
  std::vector<Nodes> adjacent(static_cast<size_t>(nodes));
  for (const auto& edge : edges) {
    adjacent[size_t(edge.first)].push_back(edge.second);
    adjacent[size_t(edge.second)].push_back(edge.first);
  }
  for (Nodes& list : adjacent) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return adjacent;
}

}  // namespace

void Elimination::analyse(int nodes, const std::vector<Edge>& edges) {
  std::vector<Nodes> adjacent = neighbours(nodes, edges);
  std::set<std::tuple<size_t, int, int>> by_degree;  // since which column, node
  std::vector<int> since(size_t(nodes), 0);
  for (int i = 0; i < nodes; ++i) by_degree.emplace(adjacent[size_t(i)].size(), 0, i);

  m_node.clear();
  m_column.assign(size_t(nodes), 0);
  Nodes merged;
  while (!by_degree.empty()) {
    const int node = std::get<2>(*by_degree.begin());
    by_degree.erase(by_degree.begin());
    m_column[size_t(node)] = int(m_node.size());
    m_node.push_back(node);
    // Its neighbours become a clique.
    const Nodes& clique = adjacent[size_t(node)];
    for (const int other : clique) {
      Nodes& list = adjacent[size_t(other)];
      by_degree.erase({list.size(), since[size_t(other)], other});
      merged.clear();
      std::set_union(list.begin(), list.end(), clique.begin(), clique.end(),
                     std::back_inserter(merged));
      const auto gone = [&](int i) { return i == node || i == other; };
      list.assign(merged.begin(), std::remove_if(merged.begin(), merged.end(), gone));
      since[size_t(other)] = int(m_node.size());
      by_degree.emplace(list.size(), since[size_t(other)], other);
    }
  }

  m_first.assign(1, 0);
  m_row.clear();
  for (const int node : m_node) {
    const size_t begin = m_row.size();
    for (const int other : adjacent[size_t(node)]) m_row.push_back(m_column[size_t(other)]);
    std::sort(m_row.begin() + std::ptrdiff_t(begin), m_row.end());
    m_first.push_back(int(m_row.size()));
  }

  m_target.clear();
  m_first_target.assign(1, 0);
  for (int c = 0; c < nodes; ++c) {
    for (int i = first(c); i < first(c + 1); ++i)
      for (int j = i; j < first(c + 1); ++j) m_target.push_back(block(row(j), row(i)));
    m_first_target.push_back(m_target.size());
  }
  m_target.push_back(0);  // an address for a last column, which has none
}

int Elimination::block(int row, int column) const {
  if (row == column) return row;
  if (row < column) std::swap(row, column);
  const auto begin = m_row.begin() + m_first[size_t(column)];
  const auto end = m_row.begin() + m_first[size_t(column) + 1];
  return columns() + int(std::lower_bound(begin, end, row) - m_row.begin());
}

void Elimination::close(std::vector<char>& marked, std::vector<int>& list) const {
  list.clear();
  for (int c = 0; c < columns(); ++c) {
    if (!marked[size_t(c)]) continue;
    list.push_back(c);
    for (int i = first(c); i < first(c + 1); ++i) marked[size_t(row(i))] = true;
  }
}

// The parent of a column is the first row below its diagonal.
void Elimination::climb(int column, std::vector<char>& marked, std::vector<int>& list) const {
  while (!marked[size_t(column)]) {
    marked[size_t(column)] = true;
    list.push_back(column);
    if (first(column) < first(column + 1)) column = row(first(column));
  }
}

size_t Elimination::bytes() const {
  return sizeof(int) * (m_node.capacity() + m_column.capacity() + m_first.capacity() +
                        m_row.capacity() + m_target.capacity()) +
         sizeof(size_t) * m_first_target.capacity();
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
