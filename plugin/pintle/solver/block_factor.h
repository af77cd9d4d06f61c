// Purpose: the factor K = L D L^T of an island's joints, block by block. It is in double, whatever Bullet's
// precision: a heavy load on light links leaves a millionth of K.
#pragma once

#include <pintle/solver/block.h>
#include <pintle/solver/elimination.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {

class BlockFactor {
 public:
  /// `rows`: of each joint, in the order of elimination. Allocates only to grow.
  void resize(const Elimination& elimination, const std::vector<int>& rows);

  /// Block i, to be filled with K in columns of column_height. Only the lower triangle of diagonal blocks is used.
  double* block(int i) { return m_blocks.data() + m_start[size_t(i)]; }
  const double* block(int i) const { return m_blocks.data() + m_start[size_t(i)]; }
  void clear(int i) { std::fill(block(i), block(i + 1), 0.); }

  /// The pattern, for other matrices with the same one.
  const Elimination& elimination() const { return *m_elimination; }
  int rows(int column) const { return m_rows[size_t(column)]; }
  size_t place(int block) const { return m_start[size_t(block)]; }
  size_t numbers() const { return m_blocks.size(); }

  /// Factorises K in place. A pivot below `tolerance` times its diagonal element is rounding: the row depends on
  /// others, and gets no impulse.
  void factorise(double tolerance);

  /// x = K^-1 x, with block_rows numbers a joint: eliminate() from the first column to the last (forward
  /// substitution), then substitute() from the last to the first.
  void eliminate(int column, double* x) const;
  void substitute(int column, double* x) const;
  /// Both, for all columns, or for those of a sparse x. These must be sorted, and closed under Elimination::close.
  void solve(double* x) const;
  void solve(double* x, const std::vector<int>& columns) const;
  /// x^T K^-1 x, for x within these columns. Destroys x.
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
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
