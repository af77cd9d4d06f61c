// Purpose: to ask early for memory that is needed soon, so that the work does not wait for it. Large worlds are not in the cache, and
// Bullet's objects lie anywhere in memory.
#pragma once

#include <pintle/precision.h>

#include <cstddef>
#include <cstdint>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// So many bytes from there. Nothing is read: what lies behind the end of the object does not matter.
template <std::size_t bytes>
void prefetch(const void* object) {
#if defined(__GNUC__)
  constexpr std::size_t line = 64;
  __builtin_prefetch(object);
  if constexpr (bytes > line)
    prefetch<bytes - line>(
        reinterpret_cast<const void*>(reinterpret_cast<std::uintptr_t>(object) + line));
#else
  static_cast<void>(object);
#endif
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
