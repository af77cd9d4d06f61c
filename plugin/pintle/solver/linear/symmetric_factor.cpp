#include <pintle/solver/linear/symmetric_factor.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// to -= a b^T, all 3 x 3.
inline void subtractProduct(const double* a, const double* b, double* to) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      to[3 * i + j] -=
          a[3 * i] * b[3 * j] + a[3 * i + 1] * b[3 * j + 1] + a[3 * i + 2] * b[3 * j + 2];
}

// x -= a y
inline void subtract(const double* a, const double* y, double* x) {
  for (int i = 0; i < 3; ++i) x[i] -= a[3 * i] * y[0] + a[3 * i + 1] * y[1] + a[3 * i + 2] * y[2];
}

// x -= a^T y
inline void subtractTransposed(const double* a, const double* y, double* x) {
  for (int i = 0; i < 3; ++i) x[i] -= a[i] * y[0] + a[3 + i] * y[1] + a[6 + i] * y[2];
}

// Of a 3 x 3 block L D L^T, by rows: 1 / d_0; l_10, 1 / d_1; l_20, l_21, 1 / d_2. It is kept so, and not as its inverse: where rows
// repeat each other, that has large numbers, whose rounding would be more than what is left of the others.
bool factoriseBlock(double* a, double least_pivot) {
  const auto pivot = [&](double d) {
    return std::abs(d) < least_pivot ? std::copysign(least_pivot, d) : d;
  };
  const double d_0 = pivot(a[0]), i_0 = 1 / d_0, l_1 = a[3] * i_0, l_2 = a[6] * i_0;
  const double d_1 = pivot(a[4] - l_1 * a[3]), i_1 = 1 / d_1, below = a[7] - l_2 * a[3],
               m = below * i_1;
  const double d_2 = pivot(a[8] - l_2 * a[6] - m * below);
  if (d_0 == 0 || d_1 == 0 || d_2 == 0 || !std::isfinite(d_0 + d_1 + d_2)) return false;
  a[0] = i_0;
  a[3] = l_1;
  a[4] = i_1;
  a[6] = l_2;
  a[7] = m;
  a[8] = 1 / d_2;
  return true;
}

// to = the solution of the block for x.
inline void solveBlock(const double* f, const double* x, double* to) {
  const double z_1 = x[1] - f[3] * x[0], z_2 = x[2] - f[6] * x[0] - f[7] * z_1;
  const double y_2 = f[8] * z_2, y_1 = f[4] * z_1 - f[7] * y_2;
  to[0] = f[0] * x[0] - f[3] * y_1 - f[6] * y_2;
  to[1] = y_1;
  to[2] = y_2;
}

// to -= a b; and of the transposed a.
inline void subtractPlainProduct(const double* a, const double* b, double* to) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      to[3 * i + j] -= a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
}
inline void subtractTransposedProduct(const double* a, const double* b, double* to) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      to[3 * i + j] -= a[i] * b[j] + a[3 + i] * b[3 + j] + a[6 + i] * b[6 + j];
}

}  // namespace

// The rows of a column are its own, and those of the columns of which it is the first one below.
void SymmetricFactor::analyse(std::vector<std::vector<int>> coupled) {
  const size_t n = coupled.size();
  m_row.clear();
  m_first.assign(1, 0);
  std::vector<std::vector<int>> children(n);
  std::vector<int> mark(n, -1);
  for (size_t k = 0; k < n; ++k) {
    std::vector<int>& rows = coupled[k];
    mark[k] = int(k);
    size_t kept = 0;
    for (const int i : rows) {
      if (mark[size_t(i)] == int(k)) continue;
      mark[size_t(i)] = int(k);
      rows[kept++] = i;
    }
    rows.resize(kept);
    for (const int child : children[k])
      for (int p = m_first[size_t(child)]; p < m_first[size_t(child) + 1]; ++p) {
        const int i = m_row[size_t(p)];
        if (mark[size_t(i)] == int(k)) continue;
        mark[size_t(i)] = int(k);
        rows.push_back(i);
      }
    std::sort(rows.begin(), rows.end());
    if (!rows.empty()) children[size_t(rows[0])].push_back(int(k));
    m_row.insert(m_row.end(), rows.begin(), rows.end());
    m_first.push_back(int(m_row.size()));
  }
  m_numbers.resize(area * (n + m_row.size()));
  m_idle.assign(n, false);
}

size_t SymmetricFactor::place(int i, int k) const {
  if (i == k) return area * size_t(k);
  const auto first = m_row.begin() + m_first[size_t(k)],
             last = m_row.begin() + m_first[size_t(k) + 1];
  return area * size_t(blocks() + (std::lower_bound(first, last, i) - m_row.begin()));
}

void SymmetricFactor::set(const std::vector<double>& numbers) {
  m_numbers = numbers;
  std::fill(m_idle.begin(), m_idle.end(), false);
}

bool SymmetricFactor::factorise(double least_pivot) {
  const int n = blocks();
  double* const diagonal = m_numbers.data();
  double* const below = diagonal + area * size_t(n);
  for (int k = 0; k < n; ++k) {
    if (m_idle[size_t(k)]) continue;
    double* const own = diagonal + area * size_t(k);
    if (!factoriseBlock(own, least_pivot)) return false;
    const int first = m_first[size_t(k)], last = m_first[size_t(k) + 1];
    for (int q = first; q < last; ++q) {
      // Column j of what is left loses A_ik D_k^-1 A_jk^T, for each i from j on.
      const int j = m_row[size_t(q)];
      if (m_idle[size_t(j)]) continue;
      double* const a_j = below + area * size_t(q);
      double l_j[area];
      for (int i = 0; i < size; ++i) solveBlock(own, a_j + size * i, l_j + size * i);
      subtractProduct(l_j, a_j, diagonal + area * size_t(j));
      int to = m_first[size_t(j)];
      const bool same = m_first[size_t(j) + 1] - to == last - q - 1;
      for (int p = q + 1; p < last; ++p, ++to) {
        const int i = m_row[size_t(p)];
        while (!same && m_row[size_t(to)] != i) ++to;
        if (m_idle[size_t(i)]) continue;
        subtractProduct(below + area * size_t(p), l_j, below + area * size_t(to));
      }
      std::copy(l_j, l_j + area, a_j);
    }
  }
  return true;
}

void SymmetricFactor::solve(double* x) const {
  const int n = blocks();
  const double* const diagonal = m_numbers.data();
  const double* const below = diagonal + area * size_t(n);
  for (int k = 0; k < n; ++k) {
    if (m_idle[size_t(k)]) continue;
    for (int p = m_first[size_t(k)]; p < m_first[size_t(k) + 1]; ++p)
      subtract(below + area * size_t(p), x + size * k, x + size * m_row[size_t(p)]);
  }
  for (int k = n - 1; k >= 0; --k) {
    if (m_idle[size_t(k)]) continue;
    double* const own = x + size * k;
    const double y[size] = {own[0], own[1], own[2]};
    solveBlock(diagonal + area * size_t(k), y, own);
    for (int p = m_first[size_t(k)]; p < m_first[size_t(k) + 1]; ++p)
      subtractTransposed(below + area * size_t(p), x + size * m_row[size_t(p)], own);
  }
}

// Z_ik = -sum of Z_ij L_jk over the rows j of column k; Z_kk = D_k^-1 - sum of L_jk^T Z_jk. From the last column on.
void SymmetricFactor::invertWhereFactored(std::vector<double>& to) const {
  const int n = blocks();
  to.assign(m_numbers.size(), 0.);
  const double* const factor = m_numbers.data();
  const double* const L = factor + area * size_t(n);
  double* const diagonal = to.data();
  double* const Z = diagonal + area * size_t(n);
  for (int k = n - 1; k >= 0; --k) {
    if (m_idle[size_t(k)]) continue;
    const int first = m_first[size_t(k)], last = m_first[size_t(k) + 1];
    for (int q = first; q < last; ++q) {
      const int j = m_row[size_t(q)];
      if (m_idle[size_t(j)]) continue;
      const double* const L_j = L + area * size_t(q);
      double* const Z_j = Z + area * size_t(q);
      subtractPlainProduct(diagonal + area * size_t(j), L_j, Z_j);
      int at = m_first[size_t(j)];
      const bool same = m_first[size_t(j) + 1] - at == last - q - 1;
      for (int p = q + 1; p < last; ++p, ++at) {
        const int i = m_row[size_t(p)];
        while (!same && m_row[size_t(at)] != i) ++at;
        if (m_idle[size_t(i)]) continue;
        const double* const Z_ij = Z + area * size_t(at);
        subtractPlainProduct(Z_ij, L_j, Z + area * size_t(p));
        subtractTransposedProduct(Z_ij, L + area * size_t(p), Z_j);
      }
    }
    double* const own = diagonal + area * size_t(k);
    for (int i = 0; i < size; ++i) {
      const double one[size] = {double(i == 0), double(i == 1), double(i == 2)};
      solveBlock(factor + area * size_t(k), one, own + size * i);
    }
    for (int q = first; q < last; ++q)
      subtractTransposedProduct(L + area * size_t(q), Z + area * size_t(q), own);
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
