// Purpose: to ask early for memory that is needed soon, so that the work does not wait for it. Large worlds are not in the cache, and
// Bullet's objects lie anywhere in memory.
#pragma once

#include <pintle/precision.h>

#include <cstddef>
#include <cstdint>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// So many bytes from there. Nothing is read: what lies behind the end of the object does not matter.
inline void prefetch(const void* object, std::size_t bytes) {
#if defined(__GNUC__)
  constexpr std::size_t line = 64;
  const auto first = reinterpret_cast<std::uintptr_t>(object);
  for (std::size_t at = 0; at < bytes; at += line)
    __builtin_prefetch(reinterpret_cast<const void*>(first + at));
#else
  static_cast<void>(object);
  static_cast<void>(bytes);
#endif
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
