// Purpose: geometric stiffness: a joint's force turns with its lever (Tournier et al. 2015, Andrews et al. 2017).
// A light body between heavy ones swings many times in a step under its load, and an explicit step makes
// any motion of that. With the stiffness in the inertia, the load's torque is that of the whole step.
#pragma once

#include <pintle/vectors.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

using Vector3d = Eigen::Matrix<double, 3, 1>;
using Matrix3d = Eigen::Matrix<double, 3, 3>;

/// The symmetric part of -[p]x [r]x, N m s a radian: how much the torque r x p of an impulse p (N s) falls as its lever
/// r (m) turns with the body.
inline Matrix3d leverStiffness(const Vector3d& p, const Vector3d& r) {
  const Matrix3d rp = r * p.transpose();
  return r.dot(p) * Matrix3d::Identity() - (rp + rp.transpose()) / 2;
}

/// A stiffness h^2 P relative to the inertia I = (S S^T)^-1 of its body: h^2 S^T P S by its principal axes, without the
/// negative ones.
struct Stiffening {
  Matrix3d axes = Matrix3d::Identity();
  Vector3d mu = Vector3d::Zero();  ///< (omega h)^2 of the swing about each axis

  Stiffening() = default;
  explicit Stiffening(const Matrix3d& stiffness);

  double max() const { return mu.maxCoeff(); }
  bool any() const { return max() > 0; }
  /// The matrix with these axes and the eigenvalues f(mu). Most mu are 0.
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
