// Purpose: the order in which the joints of an island are eliminated, and the pattern of the factor of
// K = J M^-1 J^T in that order. Both depend on the topology alone, and last as long as it does.
#pragma once

#include <pintle/precision.h>

#include <utility>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Symbolic factorisation of a symmetric matrix of blocks, by minimum degree. Ties go to the node whose degree has
/// stood longest: trees are then eliminated from all their ends at once, so that paths in the elimination tree stay
/// short. Trees have no fill-in, loops little. Columns and rows are counted in the order of elimination. Blocks are
/// numbered: the diagonal ones as their column, then those below the diagonal, column by column.
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
  /// Marks also the rows of each marked column's blocks, and lists all marked columns in order.
  void close(std::vector<char>& marked, std::vector<int>& columns) const;
  /// Marks a column and its ancestors in the elimination tree, and appends to the list those not marked before.
  void climb(int column, std::vector<char>& marked, std::vector<int>& columns) const;
  /// The blocks that the elimination of a column changes: for each pair of its blocks, the first no lower than the
  /// second, the block where their rows meet. In the order of first, then second.
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
