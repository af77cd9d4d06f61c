// Purpose: vectors of few blocks among many: those on a path through a factor.
#pragma once

#include <pintle/solver/linear/four_lanes.h>

#include <algorithm>
#include <cstddef>
#include <memory>

namespace pintle {
inline namespace PINTLE_PRECISION {

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

}  // namespace PINTLE_PRECISION
}  // namespace pintle
