// Purpose: elements side by side, in memory of someone else.
#pragma once

#include <pintle/precision.h>

#include <cstddef>

namespace pintle {
inline namespace PINTLE_PRECISION {

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

}  // namespace PINTLE_PRECISION
}  // namespace pintle
