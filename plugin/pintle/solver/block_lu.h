// Purpose: the factor L U of an unsymmetric matrix with the pattern of K: J_end M^-1 J^T, the effect of impulses along
// the rows of the start on the rows of the end of the step.
#pragma once

#include <pintle/solver/block_factor.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

class BlockLU {
 public:
  /// Memory for a matrix of this pattern. Allocates only to grow.
  void reserve(const BlockFactor& pattern);
  /// Sets all blocks to zero. Keep the pattern as long as this.
  void begin(const BlockFactor& pattern);

  /// lower: the blocks on the diagonal and below, in columns of column_height. upper: the transposed blocks above it,
  /// by the number of the block below that they mirror.
  double* lower(int block) { return m_lower.data() + m_pattern->place(block); }
  double* upper(int block) { return m_upper.data() + m_pattern->place(block); }

  void factorise();
  /// x = A^-1 x, as in BlockFactor. Dependent rows of a block get no impulse.
  void eliminate(int column, double* x) const;
  void substitute(int column, double* x) const;

  size_t bytes() const { return sizeof(double) * (m_lower.capacity() + m_upper.capacity()); }

 private:
  const double* lower(int block) const { return m_lower.data() + m_pattern->place(block); }
  const double* upper(int block) const { return m_upper.data() + m_pattern->place(block); }
  void invertDiagonal(int column);

  const BlockFactor* m_pattern = nullptr;
  std::vector<double> m_lower;  ///< A, then L; on the diagonal the inverse of U's
  std::vector<double> m_upper;  ///< of U^T what is below the diagonal
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
