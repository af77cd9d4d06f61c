// Purpose: four numbers at once, in the registers of the processor where the compiler knows how.
#pragma once

#include <pintle/precision.h>

/// Before a function that is made of them. It is compiled for processors with and without registers of four doubles, and the one that
/// fits is taken when the program is loaded. Neither has fused multiply-add: both round alike, and so do all processors. (Clang links
/// such functions by another name in each file; musl and thread sanitizers do not load them.)
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__GLIBC__) && \
    !defined(__SANITIZE_THREAD__) && !defined(__AVX__)
#define PINTLE_TARGET_CLONES __attribute__((target_clones("avx", "default")))
#else
#define PINTLE_TARGET_CLONES
#endif

#if defined(__GNUC__)
#define PINTLE_ALWAYS_INLINE __attribute__((always_inline))
#else
#define PINTLE_ALWAYS_INLINE
#endif
#define PINTLE_INLINE inline PINTLE_ALWAYS_INLINE

namespace pintle {
inline namespace PINTLE_PRECISION {

class FourLanes {
 public:
  static constexpr int count = 4;

  PINTLE_INLINE FourLanes() : m_of{} {}
  /// Of numbers side by side.
  PINTLE_INLINE explicit FourLanes(const double* from) : m_of{} { load(from); }
  PINTLE_INLINE double operator[](int i) const { return m_of[i]; }

#if defined(__GNUC__)
  PINTLE_INLINE void load(const double* from) { m_of = *reinterpret_cast<const Anywhere*>(from); }
  PINTLE_INLINE void store(double* to) const { *reinterpret_cast<Anywhere*>(to) = m_of; }
  PINTLE_INLINE void scale(double by) { m_of *= Four{by, by, by, by}; }
  PINTLE_INLINE void add(const FourLanes& a, double y) { m_of += a.m_of * Four{y, y, y, y}; }
  PINTLE_INLINE void subtract(const FourLanes& a, double y) { m_of -= a.m_of * Four{y, y, y, y}; }
  PINTLE_INLINE void add(const FourLanes& a, const FourLanes& b) { m_of += a.m_of * b.m_of; }
  PINTLE_INLINE void subtract(const FourLanes& a, const FourLanes& b) { m_of -= a.m_of * b.m_of; }
  PINTLE_INLINE void multiply(const FourLanes& by) { m_of *= by.m_of; }
  /// The larger one of each and |a|. What is not a number stays.
  PINTLE_INLINE void maxAbs(const FourLanes& a) {
    const Four size = a.m_of < 0 ? -a.m_of : a.m_of;
    m_of = ((size > m_of) | (size != size)) ? size : m_of;
  }

 private:
  using Four = double __attribute__((vector_size(32)));
  // At any double. (Clang takes an alignment at the name alone.)
  using Anywhere __attribute__((aligned(alignof(double)), may_alias)) =
      double __attribute__((vector_size(32)));
  static_assert(alignof(Anywhere) == alignof(double), "loads are not aligned");
  Four m_of;
#else
  void load(const double* from) {
    for (int i = 0; i < count; ++i) m_of[i] = from[i];
  }
  void store(double* to) const {
    for (int i = 0; i < count; ++i) to[i] = m_of[i];
  }
  void scale(double by) {
    for (double& of : m_of) of *= by;
  }
  void add(const FourLanes& a, double y) {
    for (int i = 0; i < count; ++i) m_of[i] += a.m_of[i] * y;
  }
  void subtract(const FourLanes& a, double y) {
    for (int i = 0; i < count; ++i) m_of[i] -= a.m_of[i] * y;
  }
  void add(const FourLanes& a, const FourLanes& b) {
    for (int i = 0; i < count; ++i) m_of[i] += a.m_of[i] * b.m_of[i];
  }
  void subtract(const FourLanes& a, const FourLanes& b) {
    for (int i = 0; i < count; ++i) m_of[i] -= a.m_of[i] * b.m_of[i];
  }
  void multiply(const FourLanes& by) {
    for (int i = 0; i < count; ++i) m_of[i] *= by.m_of[i];
  }
  void maxAbs(const FourLanes& a) {
    for (int i = 0; i < count; ++i) {
      const double size = a.m_of[i] < 0 ? -a.m_of[i] : a.m_of[i];
      if (size > m_of[i] || size != size) m_of[i] = size;
    }
  }

 private:
  double m_of[count];
#endif
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
