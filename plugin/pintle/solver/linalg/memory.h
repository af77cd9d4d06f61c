// Purpose: how much memory vectors take, that they take it at once, and that they begin with zeros.
#pragma once

#include <pintle/precision.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
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

// Elements that stay where they are while more are added, in memory that is kept from step to step.

template <class T>
class Pool {
 public:
  /// As its last owner left it.
  T& take() {
    if (m_taken == chunk * m_chunks.size()) m_chunks.push_back(std::unique_ptr<T[]>(new T[chunk]));
    T& next = m_chunks[m_taken / chunk][m_taken % chunk];
    ++m_taken;
    return next;
  }
  /// All may be taken again.
  void clear() { m_taken = 0; }
  std::size_t bytes() const { return chunk * sizeof(T) * m_chunks.size() + bytesOf(m_chunks); }

 private:
  static constexpr std::size_t chunk = 64;
  std::vector<std::unique_ptr<T[]>> m_chunks;
  std::size_t m_taken = 0;
};

// Elements side by side, in memory of someone else.

template <class T>
class Span {
 public:
  Span() = default;
  Span(T* first, std::size_t count) : m_first(first), m_count(count) {}
  template <class Elements>
  Span(Elements& of)
      : m_first(of.begin() == of.end() ? nullptr : &*of.begin()), m_count(of.size()) {}

  T* begin() const { return m_first; }
  T* end() const { return m_first + m_count; }
  std::size_t size() const { return m_count; }
  bool empty() const { return m_count == 0; }
  T& operator[](std::size_t i) const { return m_first[i]; }

 private:
  T* m_first = nullptr;
  std::size_t m_count = 0;
};

// To ask early for memory that is needed soon, so that the work does not wait for it. Large worlds are not in the cache, and
// Bullet's objects lie anywhere in memory.

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

/// Moves the elements that `are` to the end of `to`, and keeps the order of both. (The standard's stable_partition takes memory.)
template <class T, class Are>
void takeIf(const Are& are, std::vector<T>& from, std::vector<T>& to) {
  size_t kept = 0;
  for (size_t i = 0; i < from.size(); ++i) {
    if (are(from[i]))
      to.push_back(from[i]);
    else
      from[kept++] = from[i];
  }
  from.erase(from.begin() + std::ptrdiff_t(kept), from.end());
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
