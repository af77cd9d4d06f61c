// Purpose: elements that stay where they are while more are added, in memory that is kept from step to step.
#pragma once

#include <pintle/solver/bytes.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

template <class T>
class Pool {
 public:
  /// As its last owner left it.
  T& take() {
    if (m_taken == chunk * m_chunks.size()) m_chunks.push_back(std::unique_ptr<T[]>(new T[chunk]));
    T& next = m_chunks[m_taken / chunk][m_taken % chunk];
    ++m_taken;
    return next;
  }
  /// All may be taken again.
  void clear() { m_taken = 0; }
  std::size_t bytes() const { return chunk * sizeof(T) * m_chunks.size() + bytesOf(m_chunks); }

 private:
  static constexpr std::size_t chunk = 64;
  std::vector<std::unique_ptr<T[]>> m_chunks;
  std::size_t m_taken = 0;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
