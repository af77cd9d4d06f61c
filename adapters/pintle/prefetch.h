// Purpose: prefetch memory where a step goes through thousands of scattered objects.
#pragma once

#include <cstddef>

#if defined(_MSC_VER) && !defined(__clang__)
#include <intrin.h>
#endif

namespace pintle {

inline void prefetch(const void* line) {
#if defined(__GNUC__) || defined(__clang__)
  __builtin_prefetch(line);
#elif defined(_M_X64) || defined(_M_IX86)
  _mm_prefetch(static_cast<const char*>(line), _MM_HINT_T0);
#else
  (void)line;
#endif
}

/// The first `bytes` of an object.
inline void prefetch(const void* object, std::size_t bytes) {
  constexpr std::size_t line = 64;
  for (std::size_t i = 0; i < bytes; i += line) prefetch(static_cast<const char*>(object) + i);
}

}  // namespace pintle
