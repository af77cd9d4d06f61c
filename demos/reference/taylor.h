// Taylor polynomials of second order in one variable: a value and its first two derivatives.

#pragma once

#include <Eigen/Core>

namespace reference {

struct Taylor {
  double value = 0, first = 0, second = 0;  // f, f', f''
  Taylor() = default;
  Taylor(double constant) : value(constant) {}
  Taylor(double f, double f1, double f2) : value(f), first(f1), second(f2) {}
};

inline Taylor operator+(const Taylor& a, const Taylor& b) {
  return {a.value + b.value, a.first + b.first, a.second + b.second};
}
inline Taylor operator-(const Taylor& a, const Taylor& b) {
  return {a.value - b.value, a.first - b.first, a.second - b.second};
}
inline Taylor operator*(const Taylor& a, const Taylor& b) {
  return {a.value * b.value, a.first * b.value + a.value * b.first,
          a.second * b.value + 2 * a.first * b.first + a.value * b.second};
}
inline Taylor& operator+=(Taylor& a, const Taylor& b) { return a = a + b; }

}  // namespace reference

namespace Eigen {
template <>
struct NumTraits<reference::Taylor> : GenericNumTraits<double> {
  using Real = reference::Taylor;
  using NonInteger = reference::Taylor;
  using Nested = reference::Taylor;
  using Literal = double;
};
}  // namespace Eigen
