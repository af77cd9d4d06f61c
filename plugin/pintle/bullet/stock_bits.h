// Purpose: the bits of an object of Bullet's, by which it shows that a client has written to it.
#pragma once

#include <cstddef>
#include <cstring>
#include <vector>

namespace pintle {

/// A copy of some pieces of memory, the same ones each time: after the first time it allocates nothing.
class StockBits {
 public:
  /// Takes the next piece over.
  void look(const void* at, std::size_t size) {
    if (m_at + size > m_bits.size()) m_bits.resize(m_at + size);
    unsigned char* const last = m_bits.data() + m_at;
    m_at += size;
    if (std::memcmp(last, at, size) == 0) return;
    std::memcpy(last, at, size);
    m_is_another = true;
  }
  /// The same of members that lie one after another, from the first to before `end`.
  template <class First, class End>
  void lookBetween(const First& first, const End& end) {
    look(&first,
         std::size_t(reinterpret_cast<const char*>(&end) - reinterpret_cast<const char*>(&first)));
  }
  /// After the last piece: whether a bit has changed.
  bool end() {
    const bool is_another = m_is_another;
    m_is_another = false;
    m_at = 0;
    return is_another;
  }

 private:
  std::vector<unsigned char> m_bits;
  std::size_t m_at = 0;
  bool m_is_another = true;  ///< the first time it is
};

}  // namespace pintle
