#include <pintle/solver/block_factor.h>

#include <algorithm>
#include <type_traits>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Calls f with the number as a constant, which the compiler then unrolls loops by.
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

// What is below the diagonal of a column.
constexpr double below[block_rows][block_rows] = {{0, 1, 1, 1, 1, 1}, {0, 0, 1, 1, 1, 1},
                                                  {0, 0, 0, 1, 1, 1}, {0, 0, 0, 0, 1, 1},
                                                  {0, 0, 0, 0, 0, 1}, {0, 0, 0, 0, 0, 0}};

// to -= A B^T, of so many rows of A and columns of both, and `width` rows of B: of two rows at a time that vectors
// hold no more than there are.
template <int height, int columns>
inline void subtractProduct(double* to, const double* A, const double* B, int width) {
  using Part = Eigen::Matrix<double, height, 1>;
  for (int q = 0; q < width; ++q) {
    Eigen::Map<Part> column(to + q * block_rows);
    Part sum = column;
    for (int p = 0; p < columns; ++p)
      sum -= B[p * block_rows + q] * Eigen::Map<const Part>(A + p * block_rows);
    column = sum;
  }
}

}  // namespace

void BlockFactor::resize(const Elimination& elimination, const std::vector<int>& rows) {
  m_elimination = &elimination;
  m_rows = rows;
  int most = 0;
  for (int c = 0; c < elimination.columns(); ++c)
    most = std::max(most, elimination.first(c + 1) - elimination.first(c));
  m_blocks.resize(size_t(elimination.blocks()) * size);
  m_inverse.resize(size_t(elimination.columns()) * block_rows);
  m_scratch.resize(size_t(most) * size);
}

// Unit lower triangular, its diagonal and what is above it zero.
void BlockFactor::factoriseDiagonal(int c, double tolerance) {
  double* A = block(c);
  double* inverse = &m_inverse[size_t(c) * block_rows];
  withConstant(m_rows[size_t(c)], [&](auto n) {
    const BlockColumn diagonal = column(inverse);
    for (int p = 0; p < n; ++p) {
      const double pivot = A[p * block_rows + p];
      if (pivot > tolerance * diagonal[p]) {
        inverse[p] = 1 / pivot;
      } else {
        inverse[p] = 0;
        ++m_dependent;
      }
      const BlockColumn L = inverse[p] * column(A, p);
      for (int q = p + 1; q < n; ++q) column(A, q) -= A[p * block_rows + q] * L;
      column(A, p) = L.cwiseProduct(column(below[p]));
    }
  });
}

void BlockFactor::factorise(double tolerance) {
  const Elimination& e = *m_elimination;
  const int columns = e.columns();
  m_dependent = 0;
  // The diagonal of K, before anything is taken from it.
  for (int c = 0; c < columns; ++c)
    for (int p = 0; p < m_rows[size_t(c)]; ++p)
      m_inverse[size_t(c) * block_rows + size_t(p)] = block(c)[p * block_rows + p];

  for (int c = 0; c < columns; ++c) {
    factoriseDiagonal(c, tolerance);
    const double* L = block(c);
    const double* inverse = &m_inverse[size_t(c) * block_rows];
    const int n = m_rows[size_t(c)], begin = e.first(c), end = e.first(c + 1);
    const int* target = e.targets(c);
    withConstant(n, [&](auto N) {
      for (int i = begin; i < end; ++i) {
        double* A = block(i);
        double* LD = &m_scratch[size_t(i - begin) * size];
        for (int p = 0; p < N; ++p) {
          BlockColumn sum = column(A, p);
          for (int q = 0; q < p; ++q) sum -= L[q * block_rows + p] * column(LD, q);
          column(LD, p) = sum;
          column(A, p) = inverse[p] * sum;
        }
      }
      for (int i = begin; i < end; ++i) {
        const double* LD = &m_scratch[size_t(i - begin) * size];
        const int width = m_rows[size_t(e.row(i))];
        for (int j = i; j < end; ++j) {
          double* to = block(*target++);
          if (m_rows[size_t(e.row(j))] <= 4)
            subtractProduct<4, N>(to, block(j), LD, width);
          else
            subtractProduct<block_rows, N>(to, block(j), LD, width);
        }
      }
    });
  }
}

void BlockFactor::eliminate(int c, double* x) const {
  const Elimination& e = *m_elimination;
  withConstant(m_rows[size_t(c)], [&](auto n) {
    BlockColumn y = column(x, c);
    const double* L = &m_blocks[size_t(c) * size];
    for (int p = 0; p + 1 < n; ++p) y -= y[p] * column(L, p);
    column(x, c) = y;
    for (int i = e.first(c); i < e.first(c + 1); ++i) {
      const double* A = &m_blocks[size_t(i) * size];
      BlockColumn sum = column(x, e.row(i));
      for (int p = 0; p < n; ++p) sum -= y[p] * column(A, p);
      column(x, e.row(i)) = sum;
    }
  });
}

void BlockFactor::substitute(int c, double* x) const {
  const Elimination& e = *m_elimination;
  withConstant(m_rows[size_t(c)], [&](auto n) {
    BlockColumn y = column(x, c).cwiseProduct(column(m_inverse.data(), c));
    for (int i = e.first(c); i < e.first(c + 1); ++i) {
      const double* A = &m_blocks[size_t(i) * size];
      const BlockColumn z = column(x, e.row(i));
      for (int p = 0; p < n; ++p) y[p] -= column(A, p).dot(z);
    }
    const double* L = &m_blocks[size_t(c) * size];
    for (int p = n - 2; p >= 0; --p)
      for (int q = p + 1; q < n; ++q) y[p] -= L[p * block_rows + q] * y[q];
    column(x, c) = y;
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
