// Purpose: how Bullet turns a body in a step from its angular velocity w, with the derivatives that a solver needs.
// Up to Bullet's ANGULAR_MOTION_THRESHOLD of pi/4 by phi = dt w. Beyond it by less: there tan(|phi| / 2) is proportional to |w|.
#pragma once

#include <pintle/vectors.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

using Vector3d = Eigen::Matrix<double, 3, 1>;
using Matrix3d = Eigen::Matrix<double, 3, 3>;

inline Matrix3d crossMatrix(const Vector3d& a) {
  Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

/// V(phi): the mean of what r is while its body turns by phi at a constant rate is V r. V = 1 + (1 - cos t) / t^2 [phi]x +
/// (t - sin t) / t^3 [phi]x^2, t = |phi|, is the left Jacobian of SO(3).
Matrix3d meanOfTurn(const Vector3d& phi);

/// The turn alone.
struct RotationOfStep {
  Vector3d phi;        ///< rad: the rotation vector of the step
  double once, twice;  ///< R = 1 + once [phi]x + twice [phi]x^2

  RotationOfStep(const Vector3d& w, double dt);
  Vector3d turned(const Vector3d& r) const {
    const Vector3d first = cross(phi, r);
    return r + once * first + twice * cross(phi, first);
  }
  Matrix3d matrix() const {
    const Matrix3d X = crossMatrix(phi);
    return Matrix3d::Identity() + once * X + twice * X * X;
  }
};

struct Turn {
  Vector3d phi = Vector3d::Zero();         ///< rad: the rotation vector of the step
  double part = 1;                         ///< phi = part dt w
  Vector3d part_slope = Vector3d::Zero();  ///< d part / d(dt w)
  Matrix3d mean = Matrix3d::Identity();    ///< V(phi): the mean of what r is in the step is V r
  /// Where the body turns at the end of the step, as w changes: d(end) = slope dt dw. It is V(phi) dphi / d(dt w).
  Matrix3d slope = Matrix3d::Identity();

  Turn() = default;
  Turn(const Vector3d& w, double dt);

  /// Where an arm r of the body points in the end.
  Vector3d turned(const Vector3d& r) const { return r + cross(phi, Vector3d(mean * r)); }
  Matrix3d rotation() const { return Matrix3d::Identity() + crossMatrix(phi) * mean; }
  /// d(part V(phi) r) / d(dt w)
  Matrix3d meanSlope(const Vector3d& r) const;

 private:
  Matrix3d phiSlope() const;  ///< d phi / d(dt w)
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
