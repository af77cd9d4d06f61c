// Purpose: what a factor does with 3 x 3 blocks, a lane for each row: L D L^T of one of the diagonal, x = D^-1 x, and a -= b c^T.
#pragma once

#include <pintle/finite.h>
#include <pintle/solver/linalg/four_lanes.h>

#include <cmath>
#include <cstddef>

namespace pintle {
inline namespace PINTLE_PRECISION {

// How the 3 x 3 blocks of a matrix and of a vector lie in memory: column by column, a lane for each row and one of zeros.

constexpr int block_size = 3;
/// From one block of a vector to the next, and from one column of a block to the next: what is left between is 0.
constexpr int block_stride = FourLanes::count;
static_assert(block_stride == block_size + 1, "row");
constexpr int block_area = block_size * block_stride;  ///< of a block: numbers

/// Of row `row` and column `column` of a block: where it is among its numbers. Blocks of the diagonal have both halves.
constexpr std::size_t inBlock(int row, int column) {
  return std::size_t(block_stride * column + row);
}

/// A block.
struct MatrixBlock {
  FourLanes of[block_size];

  PINTLE_INLINE MatrixBlock() = default;
  PINTLE_INLINE explicit MatrixBlock(const double* from, int length = block_stride) {
    for (int k = 0; k < block_size; ++k) of[k].load(from + length * k);
  }
  PINTLE_INLINE void store(double* to, int length = block_stride) const {
    for (int k = 0; k < block_size; ++k) of[k].store(to + length * k);
  }
  /// -= a b^T
  PINTLE_INLINE void subtractProductTransposed(const MatrixBlock& a, const double* b) {
    for (int s = 0; s < block_size; ++s)
      for (int k = 0; k < block_size; ++k) of[s].subtract(a.of[k], b[block_stride * k + s]);
  }
};

PINTLE_INLINE MatrixBlock transposed(const double* a) {
  double t[block_area] = {};
  for (int i = 0; i < block_size; ++i)
    for (int j = 0; j < block_size; ++j) t[block_stride * i + j] = a[block_stride * j + i];
  return MatrixBlock(t);
}

/// Of a block L D L^T: 1 / d_0; l_10, 1 / d_1; l_20, l_21, 1 / d_2, in its lower half. It is kept so, and not as its inverse: where
/// rows repeat each other, that has large numbers, whose rounding would be more than what is left of the others.
PINTLE_INLINE bool factoriseBlock(double* a, double least_pivot) {
  const auto in = inBlock;
  const auto pivot = [&](double d) {
    return std::abs(d) < least_pivot ? std::copysign(least_pivot, d) : d;
  };
  const double a_10 = a[in(1, 0)], a_20 = a[in(2, 0)];
  const double d_0 = pivot(a[0]), i_0 = 1 / d_0, l_1 = a_10 * i_0, l_2 = a_20 * i_0;
  const double d_1 = pivot(a[in(1, 1)] - l_1 * a_10), i_1 = 1 / d_1,
               below = a[in(2, 1)] - l_2 * a_10, m = below * i_1;
  const double d_2 = pivot(a[in(2, 2)] - l_2 * a_20 - m * below);
  if (d_0 == 0 || d_1 == 0 || d_2 == 0 || !isFinite(d_0 + d_1 + d_2)) return false;
  a[0] = i_0;
  a[in(1, 0)] = l_1;
  a[in(1, 1)] = i_1;
  a[in(2, 0)] = l_2;
  a[in(2, 1)] = m;
  a[in(2, 2)] = 1 / d_2;
  return true;
}

/// x = D^-1 x
PINTLE_INLINE void solveBlock(const double* f, double* x) {
  const auto in = inBlock;
  x[1] -= f[in(1, 0)] * x[0];
  x[2] -= f[in(2, 0)] * x[0] + f[in(2, 1)] * x[1];
  x[2] *= f[in(2, 2)];
  x[1] = f[in(1, 1)] * x[1] - f[in(2, 1)] * x[2];
  x[0] = f[0] * x[0] - f[in(1, 0)] * x[1] - f[in(2, 0)] * x[2];
}

/// a = a D^-1: the same, of all rows of a.
PINTLE_INLINE void solveRows(const double* f, MatrixBlock& a) {
  const auto in = inBlock;
  FourLanes* const x = a.of;
  x[1].subtract(x[0], f[in(1, 0)]);
  x[2].subtract(x[0], f[in(2, 0)]);
  x[2].subtract(x[1], f[in(2, 1)]);
  x[2].scale(f[in(2, 2)]);
  x[1].scale(f[in(1, 1)]);
  x[1].subtract(x[2], f[in(2, 1)]);
  x[0].scale(f[0]);
  x[0].subtract(x[1], f[in(1, 0)]);
  x[0].subtract(x[2], f[in(2, 0)]);
}

/// Of so many blocks of rows, in the three columns at each of `to`: -= sum of a_c l_c over `columns` c. Of each c, `a` has these
/// rows, and l three numbers.
template <int blocks>
PINTLE_INLINE void subtractColumns(double* const* to, int to_length, const double* a, int length,
                                   int columns, const double* l) {
  MatrixBlock left[blocks];
  for (int i = 0; i < blocks; ++i) left[i] = MatrixBlock(to[i], to_length);
  for (int c = 0; c < columns; ++c, a += length, l += block_stride)
    for (int i = 0; i < blocks; ++i) {
      const FourLanes a_i(a + block_stride * i);
      for (int s = 0; s < block_size; ++s) left[i].of[s].subtract(a_i, l[s]);
    }
  for (int i = 0; i < blocks; ++i) left[i].store(to[i], to_length);
}

/// So many, because the processor has registers for them.
constexpr int blocks_at_once = 3;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
