// Purpose: the order of elimination of a sparse symmetric matrix: approximate minimum degree on a quotient graph (Amestoy, Davis and
// Duff 1996).
#pragma once

#include <pintle/precision.h>

#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A clique is a set of nodes that are all coupled: given, or left by a node that has been eliminated. Who shares a clique is
/// coupled.
class MinimumDegree {
 public:
  explicit MinimumDegree(size_t nodes)
      : m_cliques_of(nodes),
        m_degree(nodes, 0),
        m_gone(nodes, false),
        m_waits(nodes, false),
        m_frees(nodes, false),
        m_mark(nodes, -1) {}

  void addClique(std::vector<int> members);
  /// The node is not eliminated before one that frees it, and to which it is coupled.
  void wait(int node) { m_waits[size_t(node)] = true; }
  void frees(int node) { m_frees[size_t(node)] = true; }
  struct Column {
    int node;
    std::vector<int> coupled;  ///< to nodes that are eliminated later
  };
  /// The order in which these are eliminated.
  std::vector<Column> order(const std::vector<int>& nodes);

 private:
  std::vector<int> reach(int node);
  std::vector<int> findLevels(int root, std::vector<int>& level);
  std::vector<int> orderByLevels(const std::vector<int>& nodes);
  void findOutside(const std::vector<int>& coupled);

  std::vector<std::vector<int>> m_cliques, m_cliques_of;
  std::vector<int> m_degree;
  std::vector<char> m_gone, m_waits, m_frees;
  std::vector<int> m_mark;  ///< the last search that has found each
  int m_search = -1;
  std::vector<int>
      m_outside;  ///< of each clique that members of the new one have: its members that are not
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
