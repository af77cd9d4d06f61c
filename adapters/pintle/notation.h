// Purpose: the document's symbols (1.1, 1.2) as Eigen types, for any scalar T (float, double, or an
// automatic differentiation scalar). No Bullet here: the equations are written in these types only.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace pintle {

// DontAlign: these are stored in objects that Bullet's allocator and plain `new` place, neither of
// which promises the alignment that vectorised Eigen types ask for.
template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1, Eigen::DontAlign>;
template <class T>
using Matrix3 = Eigen::Matrix<T, 3, 3, Eigen::DontAlign>;

/// A quaternion as the document writes it: real part w and imaginary vector v.
template <class T>
struct Quaternion {
  T w;
  Vector3<T> v;
};

/// a x b, for any two Eigen 3-vector expressions. (Eigen's own cross() would pull in its
/// decompositions, which are most of its compile time.)
template <class A, class B>
Vector3<typename A::Scalar> cross(const Eigen::MatrixBase<A>& a_, const Eigen::MatrixBase<B>& b_) {
  const auto& a = a_.eval();
  const auto& b = b_.eval();
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(),
          a.x() * b.y() - a.y() * b.x()};
}

/// a x e_i, with e_i the i-th unit vector: row i of [a]x, transposed. Nothing to multiply.
template <int i, class T>
Vector3<T> cross_unit(const Vector3<T>& a) {
  if constexpr (i == 0) return {T(0), a.z(), -a.y()};
  if constexpr (i == 1) return {-a.z(), T(0), a.x()};
  if constexpr (i == 2) return {a.y(), -a.x(), T(0)};
}

/// A unit vector normal to the unit vector `a`, the same one for the same `a`. (One for zero, too.)
template <class T>
Vector3<T> any_tangent(const Vector3<T>& a) {
  using std::abs;
  using std::sqrt;
  if (abs(a.z()) > T(0.7)) {
    const T k = T(1) / sqrt(a.y() * a.y() + a.z() * a.z());
    return {T(0), -a.z() * k, a.y() * k};
  }
  const T length2 = a.x() * a.x() + a.y() * a.y();
  if (!(length2 > T(0))) return Vector3<T>::Unit(0);
  const T k = T(1) / sqrt(length2);
  return {-a.y() * k, a.x() * k, T(0)};
}

constexpr double pi = 3.14159265358979323846;

}  // namespace pintle
