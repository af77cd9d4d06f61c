// Purpose: K = L D L^T of an island's joints, block by block: what an exact solution of all of them
// takes. In double, whatever Bullet's precision: a heavy load on light links leaves a millionth of K.
#pragma once

#include <pintle/solver/block.h>
#include <pintle/solver/elimination.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {

class BlockFactor {
 public:
  /// `rows` of each column's block, in the order of elimination. Allocates if it has not been as large.
  void resize(const Elimination& elimination, const std::vector<int>& rows);

  /// To be filled with K, in columns of the rows' height. Of diagonal blocks the lower triangle is used.
  double* block(int i) { return m_blocks.data() + m_start[size_t(i)]; }
  const double* block(int i) const { return m_blocks.data() + m_start[size_t(i)]; }
  void clear(int i) { std::fill(block(i), block(i + 1), 0.); }

  /// What blocks are where, for other matrices of the same pattern.
  const Elimination& elimination() const { return *m_elimination; }
  int rows(int column) const { return m_rows[size_t(column)]; }
  size_t place(int block) const { return m_start[size_t(block)]; }
  size_t numbers() const { return m_blocks.size(); }

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
    return sizeof(double) * (m_blocks.capacity() + m_inverse.capacity() + m_scratch.capacity()) +
           sizeof(size_t) * m_start.capacity() + sizeof(int) * m_rows.capacity();
  }

 private:
  void factoriseDiagonal(int column, double tolerance);

  const Elimination* m_elimination = nullptr;
  std::vector<int> m_rows;
  std::vector<size_t> m_start;    ///< of each block
  std::vector<double> m_blocks;   ///< K, then L
  std::vector<double> m_inverse;  ///< of D
  std::vector<double> m_scratch;  ///< L D of one column
  int m_dependent = 0;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
