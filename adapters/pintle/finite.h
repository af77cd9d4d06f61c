// Purpose: whether a number is one. By its bits, which say so whatever the compiler assumes of numbers: with -ffast-math it takes
// comparisons, std::isfinite among them, as answered.
#pragma once

#include <cstdint>
#include <cstring>

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

/// Whether the bits are the same: two NaN may be.
template <class T>
bool isSame(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

}  // namespace pintle
