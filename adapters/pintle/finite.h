// Purpose: whether a number is one. By its bits, which say so whatever the compiler assumes of numbers: with -ffast-math it takes
// comparisons, std::isfinite among them, as answered.
#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>

namespace pintle {

/// Not NaN: finite or infinite.
inline bool isNumber(double x) {
  std::uint64_t bits;
  std::memcpy(&bits, &x, sizeof x);
  return (bits << 1) <= std::uint64_t(0x7ff) << 53;
}
/// The same in single precision.
inline bool isNumber(float x) {
  std::uint32_t bits;
  std::memcpy(&bits, &x, sizeof x);
  return (bits << 1) <= std::uint32_t(0xff) << 24;
}

/// Neither NaN nor infinite.
inline bool isFinite(double x) {
  std::uint64_t bits;
  std::memcpy(&bits, &x, sizeof x);
  return (bits << 1) < std::uint64_t(0x7ff) << 53;
}
/// The same in single precision.
inline bool isFinite(float x) {
  std::uint32_t bits;
  std::memcpy(&bits, &x, sizeof x);
  return (bits << 1) < std::uint32_t(0xff) << 24;
}

/// True of the same bits: two NaN may be. (Without a branch: what is asked in each step is the same.)
template <class T>
bool isSame(const T& a, const T& b) {
  using Word =
      std::conditional_t<sizeof(T) % sizeof(std::uint64_t) == 0, std::uint64_t, std::uint32_t>;
  constexpr int count = sizeof(T) / sizeof(Word);
  static_assert(count * sizeof(Word) == sizeof(T));
  Word differs = 0;
  for (int i = 0; i < count; ++i) {
    Word x, y;
    std::memcpy(&x, reinterpret_cast<const char*>(&a) + i * int(sizeof(Word)), sizeof(Word));
    std::memcpy(&y, reinterpret_cast<const char*>(&b) + i * int(sizeof(Word)), sizeof(Word));
    differs |= x ^ y;
  }
  return differs == 0;
}

}  // namespace pintle
