// Purpose: the stiffness that a joint's force has because its lever turns with the body (Tournier et al.
// 2015, Andrews et al. 2017). A light body between heavy ones swings under its load many times within a
// step, and an explicit step turns that into any motion at all. Taken into the inertia the torque of
// the load is that of the whole step.
#pragma once

#include <pintle/vectors.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

using Vector3d = Eigen::Matrix<double, 3, 1>;
using Matrix3d = Eigen::Matrix<double, 3, 3>;

/// -[p]x [r]x, symmetric: by how much the torque r x p of an impulse p (N s) falls as its lever r (m)
/// turns with the body, N m s a radian.
inline Matrix3d leverStiffness(const Vector3d& p, const Vector3d& r) {
  const Matrix3d rp = r * p.transpose();
  return r.dot(p) * Matrix3d::Identity() - (rp + rp.transpose()) / 2;
}

/// A stiffness h^2 P against the inertia of its body, I = (S S^T)^-1: h^2 S^T P S, of which what is
/// negative is left out, by its principal axes.
struct Stiffening {
  Matrix3d axes = Matrix3d::Identity();
  Vector3d mu = Vector3d::Zero();  ///< (omega h)^2 of the swing about each axis

  Stiffening() = default;
  explicit Stiffening(const Matrix3d& stiffness);

  double max() const { return mu.maxCoeff(); }
  bool any() const { return max() > 0; }
  /// Of f(mu). Most axes have no stiffness.
  template <class Function>
  Matrix3d matrix(const Function& f) const {
    const double f_0 = f(0.);
    Matrix3d sum = f_0 * Matrix3d::Identity();
    for (int k = 0; k < 3; ++k)
      if (mu[k] != 0) sum += (f(mu[k]) - f_0) * axes.col(k) * axes.col(k).transpose();
    return sum;
  }
  /// S root() is the root of the inverse of I + h^2 P.
  Matrix3d root() const {
    return matrix([](double x) { return 1 / std::sqrt(1 + x); });
  }
  Matrix3d inverseRoot() const {
    return matrix([](double x) { return std::sqrt(1 + x); });
  }
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
