// Purpose: L U of a matrix of the same blocks as K that is not symmetric: J_end M^-1 J^T, by which impulses along the
// rows of a step's start change what the rows of its end say.
#pragma once

#include <pintle/solver/block_factor.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

class BlockLU {
 public:
  /// Room for a matrix with these blocks. Allocates if it has not been as large.
  void reserve(const BlockFactor& pattern);
  /// All of it zero. Columns are eliminated in the order of the pattern's, which is to stand.
  void begin(const BlockFactor& pattern);

  /// Of the blocks on the diagonal and below, in columns of the rows' height; and of those above it, transposed: as
  /// those below that they are opposite to.
  double* lower(int block) { return m_lower.data() + m_pattern->place(block); }
  double* upper(int block) { return m_upper.data() + m_pattern->place(block); }

  void factorise();
  /// x = A^-1 x, as BlockFactor's. What the rows of a block say twice gets no impulse for it.
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
