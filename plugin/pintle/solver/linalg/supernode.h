// Purpose: columns of a factor with the same rows below them, a supernode (Ng and Peyton 1993). They leave what they do to later columns
// until all of them are done, and do it as one dense panel.
#pragma once

#include <pintle/solver/linalg/block_columns.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Of the blocks below the diagonal: the columns, and their rows.
struct FactorPattern {
  int blocks;
  const int *first, *row;
  const int* last;  ///< of each column: that of its supernode
  const char* idle;
};

class Supernode {
 public:
  /// The least that are worth a panel, and the most, so that it stays in the cache. (Of 2 to 6, and 8 to 48, these take least time for
  /// nets of 100 to 20 000 joints, by up to a tenth.)
  static constexpr int least_columns = 3, most_columns = 16;
  /// What the panel of a supernode of so many columns and rows takes, and a row of L.
  static size_t panelSize(size_t columns, size_t rows) {
    return block_size * columns * block_stride * (rows + 1);
  }

  /// The columns from `from` on, and their rows, without those that are idle. `places`: memory for as many as rows.
  PINTLE_INLINE Supernode(const FactorPattern& pattern, int from, int* places)
      : m_of(pattern),
        m_from(from),
        m_width(pattern.last[from] + 1 - from),
        m_below(pattern.first[from + m_width - 1]),
        m_places(places) {
    for (int k = 0; k < m_width; ++k)
      if (!m_of.idle[from + k]) m_places[m_rows++] = k;
    m_columns = m_rows;
    for (int p = m_below; p < pattern.first[from + m_width]; ++p)
      if (!m_of.idle[m_of.row[p]]) m_places[m_rows++] = m_width + p - m_below;
    m_length = block_stride * m_rows;
  }

  /// L of its columns, and D, from A. Returns false if a pivot is zero or not finite.
  PINTLE_INLINE bool factorise(double* diagonal, double* below, double least_pivot, double* panel) {
    for (int k = 0; k < m_columns; ++k) takeColumn(k, diagonal, below, panel);
    for (int k = 0; k < m_columns; ++k) {
      double* const own = panel + m_length * block_size * k;
      takeRow(k, k, below, panel);
      for (int p = k; p < m_rows; p += blocks_at_once) {
        double* to[blocks_at_once];
        for (int i = 0; i < blocks_at_once; ++i) to[i] = own + block_stride * (p + i);
        subtractRows(to, m_length, p, k, panel);
      }
      double* const pivot = diagonal + block_area * index(k);
      MatrixBlock(own + block_stride * k, m_length).store(pivot);
      if (!factoriseBlock(pivot, least_pivot)) return false;
      for (int p = k + 1; p < m_rows; ++p) {
        MatrixBlock l(own + block_stride * p, m_length);
        solveRows(pivot, l);
        l.store(below + block_area * place(p, k));
      }
    }
    return true;
  }

  /// Of later columns j: A_ij -= A_ik D_k^-1 A_jk^T, for each i from j on.
  PINTLE_INLINE void subtractFromLater(double* diagonal, double* below, double* panel) const {
    if (m_columns == 0) return;
    for (int q = m_columns; q < m_rows; ++q) {
      takeRow(q, m_columns, below, panel);
      const int j = index(q);
      int at = m_of.first[j];
      for (int p = q; p < m_rows; p += blocks_at_once) {
        double* to[blocks_at_once];
        for (int i = 0; i < blocks_at_once && p + i < m_rows; ++i) {
          const int row = index(p + i);
          to[i] = diagonal + block_area * j;
          if (row == j) continue;
          while (m_of.row[at] != row) ++at;
          to[i] = below + block_area * at;
        }
        subtractRows(to, block_stride, p, m_columns, panel);
      }
    }
  }

 private:
  // Of the whole matrix.
  PINTLE_INLINE int index(int p) const {
    return p < m_columns ? m_from + m_places[p] : m_of.row[m_below + m_places[p] - m_width];
  }
  // Where row p of column k < p is among the blocks below the diagonal.
  PINTLE_INLINE int place(int p, int k) const {
    return m_of.first[m_from + m_places[k]] + m_places[p] - m_places[k] - 1;
  }
  PINTLE_INLINE double* rowOf(double* panel) const {
    return panel + m_length * block_size * m_columns;
  }
  PINTLE_INLINE void takeColumn(int k, const double* diagonal, const double* below,
                                double* panel) const {
    double* const own = panel + m_length * block_size * k;
    MatrixBlock(diagonal + block_area * index(k)).store(own + block_stride * k, m_length);
    for (int p = k + 1; p < m_rows; ++p)
      MatrixBlock(below + block_area * place(p, k)).store(own + block_stride * p, m_length);
  }
  // Row p of L, of so many columns: as columns of its blocks.
  PINTLE_INLINE void takeRow(int p, int columns, const double* below, double* panel) const {
    for (int k = 0; k < columns; ++k)
      MatrixBlock(below + block_area * place(p, k)).store(rowOf(panel) + block_area * k);
  }
  // Of rows from p on, by so many columns, with the row of L at hand.
  PINTLE_INLINE void subtractRows(double* const* to, int to_length, int p, int columns,
                                  double* panel) const {
    const double* const a = panel + block_stride * p;
    const int left = m_rows - p;
    if (left >= 3)
      subtractColumns<3>(to, to_length, a, m_length, block_size * columns, rowOf(panel));
    else if (left == 2)
      subtractColumns<2>(to, to_length, a, m_length, block_size * columns, rowOf(panel));
    else
      subtractColumns<1>(to, to_length, a, m_length, block_size * columns, rowOf(panel));
  }

  const FactorPattern& m_of;
  const int m_from, m_width, m_below;
  int* const m_places;  // of its rows: among all of them, idle ones too
  int m_columns = 0, m_rows = 0;
  int m_length = 0;  // from one column of the panel to the next
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
