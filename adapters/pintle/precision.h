// Purpose: Bullet's precision as an inline namespace, so that a program compiled for one precision
// does not link with a library compiled for the other.
#pragma once

#include <LinearMath/btScalar.h>

#ifdef BT_USE_DOUBLE_PRECISION
#define PINTLE_PRECISION f64
#else
#define PINTLE_PRECISION f32
#endif

// FLATTEN inlines all calls of a function: for what every joint does in every step. NOINLINE keeps rare work out of it.
#if defined(__GNUC__)
#define PINTLE_FLATTEN __attribute__((flatten))
#define PINTLE_NOINLINE __attribute__((noinline))
#else
#define PINTLE_FLATTEN
#define PINTLE_NOINLINE
#endif

namespace pintle {
inline namespace PINTLE_PRECISION {

using Scalar = btScalar;

/// No bound. Bullet's own SIMD_INFINITY is a finite number, and its solver expects that one.
constexpr Scalar infinity = SIMD_INFINITY;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
