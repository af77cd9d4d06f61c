// Purpose: how much memory vectors take, that they take it at once, and that they begin with zeros.
#pragma once

#include <pintle/precision.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Without what their elements take elsewhere.
template <class... T>
size_t bytesOf(const std::vector<T>&... of) {
  return (size_t(0) + ... + (sizeof(T) * of.capacity()));
}

/// Room for so many elements of each.
template <class... T>
void reserve(size_t count, std::vector<T>&... of) {
  (of.reserve(count), ...);
}

/// So many zeros. (std::vector::assign takes longer for few.)
inline void setZero(size_t count, std::vector<double>& of) {
  of.resize(count);
  std::fill(of.begin(), of.end(), 0.);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
