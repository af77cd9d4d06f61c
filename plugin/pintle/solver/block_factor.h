// Purpose: K = L D L^T of an island's joints, block by block: what an exact solution of all of them
// takes. In double, whatever Bullet's precision: a heavy load on light links leaves a millionth of K.
#pragma once

#include <pintle/solver/elimination.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A block has up to this many rows and columns; what it has fewer is zero.
constexpr int block_rows = 6;
using BlockColumn = Eigen::Matrix<double, block_rows, 1>;
using BlockColumnView = Eigen::Map<BlockColumn, Eigen::Unaligned>;
using ConstBlockColumnView = Eigen::Map<const BlockColumn, Eigen::Unaligned>;
inline BlockColumnView column(double* block, int i = 0) {
  return BlockColumnView(block + i * block_rows);
}
inline ConstBlockColumnView column(const double* block, int i = 0) {
  return ConstBlockColumnView(block + i * block_rows);
}

class BlockFactor {
 public:
  /// `rows` of each column's block, in the order of elimination. Allocates if it has not been as large.
  void resize(const Elimination& elimination, const std::vector<int>& rows);

  /// To be filled with K: column-major, block_rows numbers a column. Of diagonal blocks the lower
  /// triangle is used.
  double* block(int i) { return &m_blocks[size_t(i) * size]; }

  /// K becomes its factor. A pivot of less than `tolerance` of its diagonal element is what rounding
  /// left of a row that says what others say already: it gets no impulse.
  void factorise(double tolerance);
  /// How many rows had no pivot.
  int dependent() const { return m_dependent; }

  /// x = K^-1 x; block_rows numbers a column of K. From the first column to the last each one is taken out of
  /// what is below it; then, from the last to the first, what is below it is put into each one.
  void eliminate(int column, double* x) const;
  void substitute(int column, double* x) const;
  /// Both, for all columns, or for some of them, where x and what is asked of it are. These are sorted
  /// and closed: with a column are all rows of its blocks (Elimination::close).
  void solve(double* x) const;
  void solve(double* x, const std::vector<int>& columns) const;
  /// x^T K^-1 x, with all of x in these columns; of x nothing is left.
  double product(double* x, const std::vector<int>& columns) const;

  size_t bytes() const {
    return sizeof(double) * (m_blocks.capacity() + m_inverse.capacity() + m_scratch.capacity());
  }

 private:
  static constexpr size_t size = block_rows * block_rows;

  void factoriseDiagonal(int column, double tolerance);

  const Elimination* m_elimination = nullptr;
  std::vector<int> m_rows;
  std::vector<double> m_blocks;   ///< K, then L
  std::vector<double> m_inverse;  ///< of D
  std::vector<double> m_scratch;  ///< L D of one column
  int m_dependent = 0;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
