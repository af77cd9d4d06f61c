// Purpose: the blocks of K, one joint's rows by another's, and what the factors do with them.
#pragma once

#include <pintle/vectors.h>

#include <type_traits>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A block has up to this many rows and columns.
constexpr int block_rows = 6;
/// The storage height of a column of `rows` rows. Numbers beyond the rows are zero.
constexpr int column_height(int rows) { return rows <= 4 ? 4 : block_rows; }
template <int height>
using Column = Eigen::Matrix<double, height, 1>;
/// The i-th column from here on.
template <int height = block_rows>
Eigen::Map<Column<height>> column(double* block, int i = 0) {
  return Eigen::Map<Column<height>>(block + i * height);
}
template <int height = block_rows>
Eigen::Map<const Column<height>> column(const double* block, int i = 0) {
  return Eigen::Map<const Column<height>>(block + i * height);
}
using BlockColumn = Column<block_rows>;

/// Calls f with column_height(rows) as a constant.
template <class Function>
auto withHeight(int rows, const Function& f) {
  return column_height(rows) == 4 ? f(std::integral_constant<int, 4>())
                                  : f(std::integral_constant<int, block_rows>());
}
/// Calls f with the number of rows as a constant, so that the compiler unrolls its loops.
template <class Function>
inline void withConstant(int rows, const Function& f) {
  switch (rows) {
    case 0: return;
    case 1: return f(std::integral_constant<int, 1>());
    case 2: return f(std::integral_constant<int, 2>());
    case 3: return f(std::integral_constant<int, 3>());
    case 4: return f(std::integral_constant<int, 4>());
    case 5: return f(std::integral_constant<int, 5>());
    default: return f(std::integral_constant<int, 6>());
  }
}

/// to -= A B^T. A has `height` rows, B `width` rows in columns of `height_of_B`; both have `columns` columns.
template <int height, int columns>
inline void subtractProduct(double* to, const double* A, const double* B, int width,
                            int height_of_B) {
  const Eigen::Matrix<double, height, columns> a =
      Eigen::Map<const Eigen::Matrix<double, height, columns>>(A);
  for (int q = 0; q < width; ++q) {
    Column<height> sum = column<height>(to, q);
    for (int p = 0; p < columns; ++p) sum -= B[p * height_of_B + q] * a.col(p);
    column<height>(to, q) = sum;
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
