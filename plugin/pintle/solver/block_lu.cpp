#include <pintle/solver/block_lu.h>

#include <Eigen/LU>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// A pivot below this part of its block's largest is rounding.
constexpr double dependent_part = 1e-12;

}  // namespace

void BlockLU::reserve(const BlockFactor& pattern) {
  m_lower.reserve(pattern.numbers());
  m_upper.reserve(pattern.numbers());
}

void BlockLU::begin(const BlockFactor& pattern) {
  m_pattern = &pattern;
  m_lower.assign(pattern.numbers(), 0.);
  m_upper.assign(pattern.numbers(), 0.);
}

void BlockLU::invertDiagonal(int c) {
  const int rows = m_pattern->rows(c);
  if (rows == 0) return;  // All of its rows are at their bounds.
  using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, block_rows, block_rows>;
  Eigen::Map<Block, 0, Eigen::OuterStride<>> A(lower(c), rows, rows,
                                               Eigen::OuterStride<>(column_height(rows)));
  Eigen::FullPivLU<Block> lu;
  lu.setThreshold(dependent_part);
  lu.compute(A);
  A = lu.solve(Block::Identity(rows, rows));
}

void BlockLU::factorise() {
  const Elimination& e = m_pattern->elimination();
  for (int c = 0; c < e.columns(); ++c) {
    invertDiagonal(c);
    const double* inverse = lower(c);
    const int begin = e.first(c), end = e.first(c + 1);
    const int* target = e.targets(c);
    withConstant(m_pattern->rows(c), [&](auto n) {
      for (int i = begin; i < end; ++i) {
        withHeight(m_pattern->rows(e.row(i)), [&](auto height) {
          Eigen::Map<Eigen::Matrix<double, height, n>> L(lower(i));
          const Eigen::Map<const Eigen::Matrix<double, n, n>, 0,
                           Eigen::OuterStride<column_height(n)>>
              of(inverse);
          L = (L * of).eval();
        });
      }
      for (int i = begin; i < end; ++i) {
        const int width = m_pattern->rows(e.row(i)), height_of_i = column_height(width);
        for (int j = i; j < end; ++j) {
          const int to = *target++;
          withHeight(m_pattern->rows(e.row(j)), [&](auto height) {
            subtractProduct<height, n>(lower(to), lower(j), upper(i), width, height_of_i);
            if (j > i)
              subtractProduct<height, n>(upper(to), upper(j), lower(i), width, height_of_i);
          });
        }
      }
    });
  }
}

void BlockLU::eliminate(int c, double* x) const {
  const Elimination& e = m_pattern->elimination();
  const double* y = x + c * block_rows;
  for (int i = e.first(c); i < e.first(c + 1); ++i) {
    withHeight(m_pattern->rows(e.row(i)), [&](auto height) {
      Column<height> sum = column<height>(x + e.row(i) * block_rows);
      for (int p = 0; p < m_pattern->rows(c); ++p) sum -= y[p] * column<height>(lower(i), p);
      column<height>(x + e.row(i) * block_rows) = sum;
    });
  }
}

void BlockLU::substitute(int c, double* x) const {
  const Elimination& e = m_pattern->elimination();
  const int rows = m_pattern->rows(c);
  BlockColumn y = column(x, c), solved = BlockColumn::Zero();
  for (int i = e.first(c); i < e.first(c + 1); ++i) {
    withHeight(m_pattern->rows(e.row(i)), [&](auto height) {
      const Column<height> z = column<height>(x + e.row(i) * block_rows);
      for (int p = 0; p < rows; ++p) y[p] -= column<height>(upper(i), p).dot(z);
    });
  }
  withHeight(rows, [&](auto height) {
    for (int p = 0; p < rows; ++p)
      solved.template head<height>() += y[p] * column<height>(lower(c), p);
  });
  column(x, c) = solved;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
