// Purpose: in which order to eliminate the joints of an island, and which of their blocks the factor
// of K = J M^-1 J^T then has. It depends on the topology alone, and stands as long as that does.
#pragma once

#include <pintle/precision.h>

#include <utility>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Symbolic factorisation of a symmetric matrix of blocks. Nodes are eliminated by least degree, of
/// equals the one whose degree has stood longest: trees from all their ends, without fill-in, and loops
/// with little; what a node's solution depends on stays short. Columns and rows are counted in the order
/// of elimination. Blocks are numbered: the diagonal ones as their column, then those
/// below the diagonal, column by column.
class Elimination {
 public:
  using Edge = std::pair<int, int>;  ///< two different nodes that share a body

  /// Edges may be repeated. Allocates.
  void analyse(int nodes, const std::vector<Edge>& edges);

  int columns() const { return int(m_node.size()); }
  int blocks() const { return columns() + int(m_row.size()); }
  int node(int column) const { return m_node[size_t(column)]; }
  int column(int node) const { return m_column[size_t(node)]; }
  /// The blocks below the diagonal of a column, from `first(column)` up to `first(column + 1)`.
  int first(int column) const { return columns() + m_first[size_t(column)]; }
  int row(int block) const { return m_row[size_t(block - columns())]; }
  /// The block in which two columns meet; it exists if they share an edge.
  int block(int row, int column) const;
  /// Marks with each marked column the rows of its blocks, and lists what is marked, in order.
  void close(std::vector<char>& marked, std::vector<int>& columns) const;
  /// Marks a column and all that it is eliminated into, one after the other, and appends to the list what was not
  /// marked before.
  void climb(int column, std::vector<char>& marked, std::vector<int>& columns) const;
  /// What the elimination of a column changes: for each pair of its blocks, the first one's row not
  /// after the second's, the block in their rows. In the order of first, then second.
  const int* targets(int column) const { return &m_target[m_first_target[size_t(column)]]; }

  size_t bytes() const;

 private:
  std::vector<int> m_node, m_column;
  std::vector<int> m_first, m_row;
  std::vector<size_t> m_first_target;
  std::vector<int> m_target;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
