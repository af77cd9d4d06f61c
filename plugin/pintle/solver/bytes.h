// Purpose: how much memory vectors take, and that they take it at once.
#pragma once

#include <pintle/precision.h>

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

}  // namespace PINTLE_PRECISION
}  // namespace pintle
