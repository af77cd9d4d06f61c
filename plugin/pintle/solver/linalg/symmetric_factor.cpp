#include <pintle/solver/linalg/symmetric_factor.h>

#include <pintle/solver/linalg/supernode.h>

#include <algorithm>
#include <cstring>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

constexpr auto area = size_t(block_area);

// Where columns are alone, or nearly, what they do to later ones is done at once: to copy them to a panel would take longer.
PINTLE_INLINE bool factoriseColumn(const FactorPattern& of, int k, double* diagonal, double* below,
                                   double least_pivot) {
  if (of.idle[k]) return true;
  double* const own = diagonal + block_area * k;
  if (!factoriseBlock(own, least_pivot)) return false;
  const int end = of.first[k + 1];
  for (int q = of.first[k]; q < end; ++q) {
    const int j = of.row[q];
    if (of.idle[j]) continue;
    double* const a_j = below + block_area * q;
    MatrixBlock l_j(a_j), to_j(diagonal + block_area * j);
    solveRows(own, l_j);
    to_j.subtractProductTransposed(l_j, a_j);
    to_j.store(diagonal + block_area * j);
    l_j.store(a_j);
    int to = of.first[j];
    const bool same = of.first[j + 1] - to == end - q - 1;
    for (int p = q + 1; p < end; ++p, ++to) {
      while (!same && of.row[to] != of.row[p]) ++to;
      if (of.idle[of.row[p]]) continue;
      MatrixBlock left(below + block_area * to);
      left.subtractProductTransposed(MatrixBlock(below + block_area * p), a_j);
      left.store(below + block_area * to);
    }
  }
  return true;
}

PINTLE_TARGET_CLONES bool factoriseAll(const FactorPattern& of, double* diagonal, double* below,
                                       double least_pivot, double* panel, int* places) {
  for (int k = 0; k < of.blocks; ++k) {
    if (of.last[k] + 1 - k < Supernode::least_columns) {
      if (!factoriseColumn(of, k, diagonal, below, least_pivot)) return false;
      continue;
    }
    Supernode node(of, k, places);
    if (!node.factorise(diagonal, below, least_pivot, panel)) return false;
    node.subtractFromLater(diagonal, below, panel);
    k = of.last[k];
  }
  return true;
}

PINTLE_TARGET_CLONES void solveAll(const FactorPattern& of, const double* diagonal,
                                   const double* below, double* x) {
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
  size_t most = 0, most_rows = 0;
  for (int k = int(n); k-- > 0;) {
    const int rows = m_first[size_t(k) + 1] - m_first[size_t(k)];
    // The next column has the same rows, but itself.
    const bool joins = rows > 0 && m_row[size_t(m_first[size_t(k)])] == k + 1 &&
                       m_first[size_t(k) + 2] - m_first[size_t(k) + 1] == rows - 1;
    const int last = joins ? m_last[size_t(k) + 1] : k;
    m_last[size_t(k)] = last - k < Supernode::most_columns ? last : k;
    const auto columns = size_t(m_last[size_t(k)] + 1 - k);
    most_rows = std::max(most_rows, size_t(rows) + 1);
    if (columns >= size_t(Supernode::least_columns))
      most = std::max(most, Supernode::panelSize(columns, size_t(rows) + 1));
  }
  m_parent.clear();
  for (size_t k = 0; k < n; ++k)
    m_parent.push_back(m_first[k] < m_first[k + 1] ? m_row[size_t(m_first[k])] : int(n));
  m_path_length.assign(n + 1, 0);  // the last one is of no column
  for (size_t k = n; k-- > 0;) m_path_length[k] = m_path_length[size_t(m_parent[k])] + 1;
  m_panel.resize(most);
  m_places.resize(most_rows);
}

size_t SymmetricFactor::place(int i, int k) const {
  if (i == k) return area * size_t(k);
  const auto first = m_row.begin() + m_first[size_t(k)],
             last = m_row.begin() + m_first[size_t(k) + 1];
  return area * size_t(blocks() + (std::lower_bound(first, last, i) - m_row.begin()));
}

void SymmetricFactor::set(const std::vector<double>& numbers, const std::vector<Run>& runs) {
  // (std::fill sets two at a time.)
  const auto clear = [this](size_t from, size_t to) {
    if (from < to) std::memset(m_numbers.data() + from, 0, (to - from) * sizeof(double));
  };
  const double* from = numbers.data();
  size_t done = 0;
  for (const Run& run : runs) {
    clear(done, run.place);
    std::copy_n(from, run.numbers, m_numbers.data() + run.place);
    from += run.numbers;
    done = run.place + run.numbers;
  }
  clear(done, m_numbers.size());
  std::fill(m_idle.begin(), m_idle.end(), false);
}

bool SymmetricFactor::factorise(double least_pivot) {
  const FactorPattern pattern{blocks(), m_first.data(), m_row.data(), m_last.data(), m_idle.data()};
  double* const diagonal = m_numbers.data();
  return factoriseAll(pattern, diagonal, diagonal + area * size_t(blocks()), least_pivot,
                      m_panel.data(), m_places.data());
}

void SymmetricFactor::solve(double* x) const {
  const FactorPattern pattern{blocks(), m_first.data(), m_row.data(), m_last.data(), m_idle.data()};
  const double* const diagonal = m_numbers.data();
  solveAll(pattern, diagonal, diagonal + area * size_t(blocks()), x);
}

void SymmetricFactor::followPaths(int from, int and_from, double* x, PathBlocks& to) const {
  for (int k = std::min(from, and_from); k < blocks(); k = std::min(from, and_from)) {
    const int next = m_parent[size_t(k)];
    if (m_idle[size_t(k)])
      std::fill_n(x + block_stride * k, block_stride, 0.);
    else
      follow(k, x, to.add());
    if (from == k) from = next;
    if (and_from == k) and_from = next;
  }
}

PINTLE_TARGET_CLONES void SymmetricFactor::follow(int k, double* x, PathBlock& to) const {
  to.at = size_t(block_stride) * size_t(k);
  double* const own = x + to.at;
  const FourLanes y(own);
  y.store(to.adds);
  FourLanes().store(own);
  const double* l = m_numbers.data() + area * size_t(blocks() + m_first[size_t(k)]);
  for (int p = m_first[size_t(k)]; p < m_first[size_t(k) + 1]; ++p, l += area) {
    double* const x_i = x + block_stride * m_row[size_t(p)];
    FourLanes left(x_i);
    for (int c = 0; c < block_size; ++c) left.subtract(FourLanes(l + block_stride * c), y[c]);
    left.store(x_i);
  }
  for (int c = 0; c < block_stride; ++c) to.reads[c] = -y[c];
  solveBlock(m_numbers.data() + area * size_t(k), to.reads);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
