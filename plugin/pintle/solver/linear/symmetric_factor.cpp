#include <pintle/solver/linear/symmetric_factor.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

constexpr int block_size = SymmetricFactor::size, block_stride = SymmetricFactor::stride,
              block_area = block_size * block_stride;

// A block: a lane for each row.
struct Columns {
  FourLanes of[block_size];

  PINTLE_INLINE Columns() = default;
  PINTLE_INLINE explicit Columns(const double* from) {
    for (int k = 0; k < block_size; ++k) of[k].load(from + block_stride * k);
  }
  PINTLE_INLINE void store(double* to) const {
    for (int k = 0; k < block_size; ++k) of[k].store(to + block_stride * k);
  }
  // -= a b
  PINTLE_INLINE void subtractProduct(const Columns& a, const double* b) {
    for (int s = 0; s < block_size; ++s)
      for (int k = 0; k < block_size; ++k) of[s].subtract(a.of[k], b[block_stride * s + k]);
  }
  // -= a b^T
  PINTLE_INLINE void subtractProductTransposed(const Columns& a, const double* b) {
    for (int s = 0; s < block_size; ++s)
      for (int k = 0; k < block_size; ++k) of[s].subtract(a.of[k], b[block_stride * k + s]);
  }
};

PINTLE_INLINE Columns transposed(const double* a) {
  double t[block_area] = {};
  for (int i = 0; i < block_size; ++i)
    for (int j = 0; j < block_size; ++j) t[block_stride * i + j] = a[block_stride * j + i];
  return Columns(t);
}

// Of a block L D L^T: 1 / d_0; l_10, 1 / d_1; l_20, l_21, 1 / d_2, in its lower half. It is kept so, and not as its inverse: where
// rows repeat each other, that has large numbers, whose rounding would be more than what is left of the others.
PINTLE_INLINE bool factoriseBlock(double* a, double least_pivot) {
  const auto in = SymmetricFactor::in;
  const auto pivot = [&](double d) {
    return std::abs(d) < least_pivot ? std::copysign(least_pivot, d) : d;
  };
  const double a_10 = a[in(1, 0)], a_20 = a[in(2, 0)];
  const double d_0 = pivot(a[0]), i_0 = 1 / d_0, l_1 = a_10 * i_0, l_2 = a_20 * i_0;
  const double d_1 = pivot(a[in(1, 1)] - l_1 * a_10), i_1 = 1 / d_1,
               below = a[in(2, 1)] - l_2 * a_10, m = below * i_1;
  const double d_2 = pivot(a[in(2, 2)] - l_2 * a_20 - m * below);
  if (d_0 == 0 || d_1 == 0 || d_2 == 0 || !std::isfinite(d_0 + d_1 + d_2)) return false;
  a[0] = i_0;
  a[in(1, 0)] = l_1;
  a[in(1, 1)] = i_1;
  a[in(2, 0)] = l_2;
  a[in(2, 1)] = m;
  a[in(2, 2)] = 1 / d_2;
  return true;
}

// x = D^-1 x
PINTLE_INLINE void solveBlock(const double* f, double* x) {
  const auto in = SymmetricFactor::in;
  x[1] -= f[in(1, 0)] * x[0];
  x[2] -= f[in(2, 0)] * x[0] + f[in(2, 1)] * x[1];
  x[2] *= f[in(2, 2)];
  x[1] = f[in(1, 1)] * x[1] - f[in(2, 1)] * x[2];
  x[0] = f[0] * x[0] - f[in(1, 0)] * x[1] - f[in(2, 0)] * x[2];
}

// a = a D^-1: the same, of all rows of a.
PINTLE_INLINE void solveRows(const double* f, Columns& a) {
  const auto in = SymmetricFactor::in;
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

// Of the blocks below the diagonal: the columns, and their rows.
struct Pattern {
  int blocks;
  const int *first, *row, *last;
  const char* idle;
};

// Columns that have the same rows below them, a supernode, leave what they do to later columns until all of them are done: then each
// block there is changed once.
PINTLE_TARGET_CLONES bool factoriseAll(const Pattern& of, double* diagonal, double* below,
                                       double least_pivot, double* panel) {
  for (int from = 0, last = 0; from < of.blocks; from = last + 1) {
    last = of.last[from];
    const int width = last + 1 - from, rows = of.first[last + 1] - of.first[last];
    for (int k = from; k <= last; ++k) {
      // Column j of what is left loses A_ik D_k^-1 A_jk^T, for each i from j on.
      double* const own = diagonal + block_area * k;
      if (!of.idle[k] && !factoriseBlock(own, least_pivot)) return false;
      const int inside = of.first[k] + last - k, end = inside + rows;
      for (int q = of.first[k]; q < inside && !of.idle[k]; ++q) {
        const int j = of.row[q];
        if (of.idle[j]) continue;
        double* const a_j = below + block_area * q;
        Columns l_j(a_j), to_j(diagonal + block_area * j);
        solveRows(own, l_j);
        to_j.subtractProductTransposed(l_j, a_j);
        to_j.store(diagonal + block_area * j);
        l_j.store(a_j);
        double* to = below + block_area * of.first[j];
        for (int p = q + 1; p < end; ++p, to += block_area) {
          if (of.idle[of.row[p]]) continue;
          Columns left(to);
          left.subtractProductTransposed(Columns(below + block_area * p), a_j);
          left.store(to);
        }
      }
      for (int p = inside; p < end; ++p) {
        Columns a(below + block_area * p);
        a.store(panel + block_area * ((p - inside) * width + k - from));
        if (of.idle[k]) continue;
        solveRows(own, a);
        a.store(below + block_area * p);
      }
    }
    const auto subtract = [&](double* to, int p, int q) PINTLE_ALWAYS_INLINE {
      Columns left(to);
      for (int k = from; k <= last; ++k)
        left.subtractProductTransposed(Columns(panel + block_area * (p * width + k - from)),
                                       below + block_area * (of.first[k] + last - k + q));
      left.store(to);
    };
    for (int q = 0; q < rows; ++q) {
      const int* const row = of.row + of.first[last];
      const int j = row[q];
      if (of.idle[j]) continue;
      subtract(diagonal + block_area * j, q, q);
      int to = of.first[j];
      const bool same = of.first[j + 1] - to == rows - q - 1;
      for (int p = q + 1; p < rows; ++p, ++to) {
        while (!same && of.row[to] != row[p]) ++to;
        if (!of.idle[row[p]]) subtract(below + block_area * to, p, q);
      }
    }
  }
  return true;
}

PINTLE_TARGET_CLONES void solveAll(const Pattern& of, const double* diagonal, const double* below,
                                   double* x) {
  for (int k = 0; k < of.blocks; ++k) {
    if (of.idle[k]) continue;
    const double y_0 = x[block_stride * k], y_1 = x[block_stride * k + 1],
                 y_2 = x[block_stride * k + 2];
    for (int p = of.first[k]; p < of.first[k + 1]; ++p) {
      const double* const l = below + block_area * p;
      double* const x_i = x + block_stride * of.row[p];
      FourLanes left(x_i);
      left.subtract(FourLanes(l), y_0);
      left.subtract(FourLanes(l + block_stride), y_1);
      left.subtract(FourLanes(l + 2 * block_stride), y_2);
      left.store(x_i);
    }
  }
  for (int k = of.blocks - 1; k >= 0; --k) {
    if (of.idle[k]) continue;
    double* const own = x + block_stride * k;
    solveBlock(diagonal + block_area * k, own);
    FourLanes sum[block_size];
    for (int p = of.first[k]; p < of.first[k + 1]; ++p) {
      const FourLanes x_i(x + block_stride * of.row[p]);
      for (int i = 0; i < block_size; ++i)
        sum[i].add(FourLanes(below + block_area * p + block_stride * i), x_i);
    }
    for (int i = 0; i < block_size; ++i) own[i] -= sum[i][0] + sum[i][1] + sum[i][2];
  }
}

// Z_ik = -sum of Z_ij L_jk over the rows j of column k; Z_kk = D_k^-1 - sum of L_jk^T Z_jk. From the last column on.
PINTLE_TARGET_CLONES void invertAll(const Pattern& of, const double* D, const double* L,
                                    double* diagonal, double* Z) {
  for (int k = of.blocks - 1; k >= 0; --k) {
    if (of.idle[k]) continue;
    const int first = of.first[k], last = of.first[k + 1];
    for (int q = first; q < last; ++q) {
      const int j = of.row[q];
      if (of.idle[j]) continue;
      const double* const L_j = L + block_area * q;
      Columns Z_j(Z + block_area * q);
      Z_j.subtractProduct(Columns(diagonal + block_area * j), L_j);
      int at = of.first[j];
      const bool same = of.first[j + 1] - at == last - q - 1;
      for (int p = q + 1; p < last; ++p, ++at) {
        const int i = of.row[p];
        while (!same && of.row[at] != i) ++at;
        if (of.idle[i]) continue;
        const double* const Z_ij = Z + block_area * at;
        Columns Z_i(Z + block_area * p);
        Z_i.subtractProduct(Columns(Z_ij), L_j);
        Z_i.store(Z + block_area * p);
        Z_j.subtractProduct(transposed(Z_ij), L + block_area * p);
      }
      Z_j.store(Z + block_area * q);
    }
    double* const own = diagonal + block_area * k;
    for (int i = 0; i < block_size; ++i) {
      own[block_stride * i + i] = 1;
      solveBlock(D + block_area * k, own + block_stride * i);
    }
    Columns sum(own);
    for (int q = first; q < last; ++q)
      sum.subtractProduct(transposed(L + block_area * q), Z + block_area * q);
    sum.store(own);
  }
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
  m_last.resize(n);
  size_t most = 0;  // blocks of a panel
  for (int k = int(n); k-- > 0;) {
    const int rows = m_first[size_t(k) + 1] - m_first[size_t(k)];
    // The next column has the same rows, but itself.
    const bool joins = rows > 0 && m_row[size_t(m_first[size_t(k)])] == k + 1 &&
                       m_first[size_t(k) + 2] - m_first[size_t(k) + 1] == rows - 1;
    m_last[size_t(k)] = joins ? m_last[size_t(k) + 1] : k;
    const int last = m_last[size_t(k)];
    most = std::max(
        most, size_t(last + 1 - k) * size_t(m_first[size_t(last) + 1] - m_first[size_t(last)]));
  }
  m_panel.resize(area * most);
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
  const Pattern pattern{blocks(), m_first.data(), m_row.data(), m_last.data(), m_idle.data()};
  double* const diagonal = m_numbers.data();
  return factoriseAll(pattern, diagonal, diagonal + area * size_t(blocks()), least_pivot,
                      m_panel.data());
}

void SymmetricFactor::solve(double* x) const {
  const Pattern pattern{blocks(), m_first.data(), m_row.data(), m_last.data(), m_idle.data()};
  const double* const diagonal = m_numbers.data();
  solveAll(pattern, diagonal, diagonal + area * size_t(blocks()), x);
}

void SymmetricFactor::invertWhereFactored(std::vector<double>& to) const {
  const Pattern pattern{blocks(), m_first.data(), m_row.data(), m_last.data(), m_idle.data()};
  to.assign(m_numbers.size(), 0.);
  const double* const D = m_numbers.data();
  double* const diagonal = to.data();
  const size_t below = area * size_t(blocks());
  invertAll(pattern, D, D + below, diagonal, diagonal + below);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
