// Purpose: A = L D L^T of a sparse symmetric matrix of 3 x 3 blocks. It need not be definite, but quasi-definite: one part positive,
// the other one negative (Vanderbei 1995). Such a matrix has this factor in any order, without a search for pivots.
#pragma once

#include <pintle/precision.h>
#include <pintle/solver/linalg/block_columns.h>
#include <pintle/solver/linalg/four_lanes.h>
#include <pintle/solver/linalg/memory.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

// Vectors of few blocks among many: those on a path through a factor.

/// What is read from a block of a vector, and what is added to it.
struct PathBlock {
  static constexpr std::size_t numbers = 2 * FourLanes::count + 1;
  std::size_t at;  ///< of the block, among the vector's numbers
  double reads[FourLanes::count], adds[FourLanes::count];
};

/// Many of them, side by side. They are not set to zero before they are written.
class PathBlocks {
 public:
  void clear() { m_size = 0; }
  PathBlock& add() {
    if (m_size == m_capacity) grow();
    return m_of[m_size++];
  }
  std::size_t size() const { return m_size; }
  PathBlock* begin() const { return m_of.get(); }
  PathBlock* end() const { return begin() + m_size; }
  std::size_t bytes() const { return m_capacity * sizeof(PathBlock); }

 private:
  void grow() {
    const std::size_t next = std::max<std::size_t>(64, 2 * m_capacity);
    std::unique_ptr<PathBlock[]> of(new PathBlock[next]);
    std::copy(begin(), end(), of.get());
    m_of = std::move(of);
    m_capacity = next;
  }

  std::unique_ptr<PathBlock[]> m_of;
  std::size_t m_size = 0, m_capacity = 0;
};

class SymmetricFactor {
 public:
  /// Symbolic. `coupled[k]`: the blocks after k, in the order of elimination, that A couples to it. Allocates.
  void analyse(std::vector<std::vector<int>> coupled);

  int blocks() const { return int(m_first.size()) - 1; }
  /// Where the block of row `i` and column `k` <= i is, which A or its factor must have.
  size_t place(int i, int k) const;
  /// The numbers of a block (block_columns.h).
  double* at(size_t place) { return m_numbers.data() + place; }
  /// All of them, in the order of their places.
  size_t numbers() const { return m_numbers.size(); }
  /// Blocks of A one behind the other, which lie so in the factor, too.
  struct Run {
    size_t place, numbers;
  };
  /// Sets the matrix to these, run by run, and to 0 where the factor alone has blocks. Then change its blocks, and factorise.
  void set(const std::vector<double>& numbers, const std::vector<Run>& runs);
  /// Block k is coupled to nothing, and has 1 on its diagonal: nothing is done with it. (Until the next `set`.)
  void setIdle(int k) { m_idle[size_t(k)] = true; }
  /// A smaller pivot than `least_pivot` becomes that, with its sign. Returns false if one is zero or not finite.
  bool factorise(double least_pivot);
  /// x = A^-1 x.
  void solve(double* x) const;
  /// Of y = L^-1 x, where x has numbers only at two blocks, and at some of those to which their paths lead: from each block on to the
  /// first one that its column is coupled to, up to the root (Liu 1990). Each block on both reads -D^-1 y, and adds y. x becomes 0.
  void followPaths(int from, int and_from, double* x, PathBlocks& to) const;
  /// The blocks of the path from a block on, itself included.
  int pathLength(int from) const { return m_path_length[size_t(from)]; }

  size_t bytes() const {
    return bytesOf(m_row, m_first, m_parent, m_path_length, m_last, m_idle, m_numbers, m_panel,
                   m_places);
  }

 private:
  void follow(int k, double* x, PathBlock& to) const;

  std::vector<int> m_row;    ///< of the blocks below the diagonal, column by column
  std::vector<int> m_first;  ///< of each column in m_row
  std::vector<int>
      m_parent;  ///< of each column: the first one that it is coupled to; none: blocks()
  std::vector<int> m_path_length;
  std::vector<int> m_last;  ///< of each column: the last one of those with the same rows below them
  std::vector<char> m_idle;
  /// Of the diagonal, then of those below: A, and then D, each block by its own factor, and L.
  std::vector<double> m_numbers;
  std::vector<double> m_panel;  ///< memory of the factorisation
  std::vector<int> m_places;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
