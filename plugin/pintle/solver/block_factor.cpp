#include <pintle/solver/block_factor.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// What is below the diagonal of a column.
constexpr double below[block_rows][block_rows] = {{0, 1, 1, 1, 1, 1}, {0, 0, 1, 1, 1, 1},
                                                  {0, 0, 0, 1, 1, 1}, {0, 0, 0, 0, 1, 1},
                                                  {0, 0, 0, 0, 0, 1}, {0, 0, 0, 0, 0, 0}};

}  // namespace

void BlockFactor::resize(const Elimination& elimination, const std::vector<int>& rows) {
  m_elimination = &elimination;
  m_rows = rows;
  const int columns = elimination.columns();
  m_start.resize(size_t(elimination.blocks()) + 1);
  size_t end = 0, max_column = 0;
  const auto add = [&](int block, int row, int column) {
    m_start[size_t(block)] = end;
    end += size_t(rows[size_t(column)] * column_height(rows[size_t(row)]));
  };
  for (int c = 0; c < columns; ++c) add(c, c, c);
  for (int c = 0; c < columns; ++c) {
    const size_t begin = end;
    for (int i = elimination.first(c); i < elimination.first(c + 1); ++i)
      add(i, elimination.row(i), c);
    max_column = std::max(max_column, end - begin);
  }
  m_start.back() = end;
  m_blocks.resize(end);
  m_inverse.resize(size_t(columns) * block_rows);
  m_scratch.resize(max_column);
}

// Unit lower triangular, its diagonal and what is above it zero.
void BlockFactor::factoriseDiagonal(int c, double tolerance) {
  double* A = block(c);
  double* inverse = &m_inverse[size_t(c) * block_rows];
  withConstant(m_rows[size_t(c)], [&](auto n) {
    constexpr int height = column_height(n);
    const Column<height> diagonal = column<height>(inverse);
    for (int p = 0; p < n; ++p) {
      const double pivot = A[p * height + p];
      inverse[p] = pivot > tolerance * diagonal[p] ? 1 / pivot : 0;
      const Column<height> L = inverse[p] * column<height>(A, p);
      for (int q = p + 1; q < n; ++q) column<height>(A, q) -= A[p * height + q] * L;
      column<height>(A, p) = L.cwiseProduct(column<height>(below[p]));
    }
  });
}

void BlockFactor::factorise(double tolerance) {
  const Elimination& e = *m_elimination;
  const int columns = e.columns();
  // The diagonal of K, before anything is taken from it.
  for (int c = 0; c < columns; ++c) {
    const int rows = m_rows[size_t(c)];
    for (int p = 0; p < rows; ++p)
      m_inverse[size_t(c * block_rows + p)] = block(c)[p * (column_height(rows) + 1)];
  }

  for (int c = 0; c < columns; ++c) {
    factoriseDiagonal(c, tolerance);
    const double* L = block(c);
    const double* inverse = &m_inverse[size_t(c) * block_rows];
    const int begin = e.first(c), end = e.first(c + 1);
    const int* target = e.targets(c);
    withConstant(m_rows[size_t(c)], [&](auto n) {
      // L D, each block as far from the first as of K
      const auto scratch = [&](int i) { return m_scratch.data() + (block(i) - block(begin)); };
      for (int i = begin; i < end; ++i) {
        withHeight(m_rows[size_t(e.row(i))], [&](auto height) {
          double* A = block(i);
          double* LD = scratch(i);
          for (int p = 0; p < n; ++p) {
            Column<height> sum = column<height>(A, p);
            for (int q = 0; q < p; ++q) sum -= L[q * column_height(n) + p] * column<height>(LD, q);
            column<height>(LD, p) = sum;
            column<height>(A, p) = inverse[p] * sum;
          }
        });
      }
      for (int i = begin; i < end; ++i) {
        const int width = m_rows[size_t(e.row(i))];
        for (int j = i; j < end; ++j) {
          double* to = block(*target++);
          withHeight(m_rows[size_t(e.row(j))], [&](auto height) {
            subtractProduct<height, n>(to, block(j), scratch(i), width, column_height(width));
          });
        }
      }
    });
  }
}

void BlockFactor::eliminate(int c, double* x) const {
  const Elimination& e = *m_elimination;
  withConstant(m_rows[size_t(c)], [&](auto n) {
    constexpr int height = column_height(n);
    double* at = x + c * block_rows;
    Column<height> y = column<height>(at);
    const double* L = block(c);
    for (int p = 0; p + 1 < n; ++p) y -= y[p] * column<height>(L, p);
    column<height>(at) = y;
    for (int i = e.first(c); i < e.first(c + 1); ++i) {
      withHeight(m_rows[size_t(e.row(i))], [&](auto rows) {
        double* to = x + e.row(i) * block_rows;
        Column<rows> sum = column<rows>(to);
        for (int p = 0; p < n; ++p) sum -= y[p] * column<rows>(block(i), p);
        column<rows>(to) = sum;
      });
    }
  });
}

void BlockFactor::substitute(int c, double* x) const {
  const Elimination& e = *m_elimination;
  withConstant(m_rows[size_t(c)], [&](auto n) {
    constexpr int height = column_height(n);
    double* at = x + c * block_rows;
    Column<height> y =
        column<height>(at).cwiseProduct(column<height>(&m_inverse[size_t(c * block_rows)]));
    for (int i = e.first(c); i < e.first(c + 1); ++i) {
      withHeight(m_rows[size_t(e.row(i))], [&](auto rows) {
        const Column<rows> z = column<rows>(x + e.row(i) * block_rows);
        for (int p = 0; p < n; ++p) y[p] -= column<rows>(block(i), p).dot(z);
      });
    }
    const double* L = block(c);
    for (int p = n - 2; p >= 0; --p)
      for (int q = p + 1; q < n; ++q) y[p] -= L[p * height + q] * y[q];
    column<height>(at) = y;
  });
}

double BlockFactor::product(double* x, const std::vector<int>& columns) const {
  double sum = 0;
  for (const int c : columns) {
    eliminate(c, x);
    const BlockColumn y = column(x, c);
    sum += y.cwiseProduct(y).dot(column(m_inverse.data(), c));
  }
  return sum;
}

void BlockFactor::solve(double* x) const {
  const int columns = m_elimination->columns();
  for (int c = 0; c < columns; ++c) eliminate(c, x);
  for (int c = columns - 1; c >= 0; --c) substitute(c, x);
}

void BlockFactor::solve(double* x, const std::vector<int>& columns) const {
  for (auto c = columns.begin(); c != columns.end(); ++c) eliminate(*c, x);
  for (auto c = columns.rbegin(); c != columns.rend(); ++c) substitute(*c, x);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
