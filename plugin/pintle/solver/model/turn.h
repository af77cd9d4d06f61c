// Purpose: how Bullet turns a body in a step from its angular velocity w. Up to Bullet's ANGULAR_MOTION_THRESHOLD of pi/4 by
// phi = dt w. Beyond it by less: there tan(|phi| / 2) is proportional to |w|. The rotation is that of Rodrigues,
//   R = 1 + sin|phi| / |phi| [phi]x + (1 - cos|phi|) / |phi|^2 [phi]x^2
#pragma once

#include <pintle/solver/constants.h>
#include <pintle/vectors.h>

#include <Eigen/Geometry>

namespace pintle {
inline namespace PINTLE_PRECISION {

using Vector3d = Eigen::Matrix<double, 3, 1>;
using Matrix3d = Eigen::Matrix<double, 3, 3>;

/// The rotation vector of a rotation, rad.
inline Vector3d rotationVector(const Matrix3d& R) {
  const Vector3d twice_sin(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  const double sin2 = twice_sin.squaredNorm() / 4;
  // asin, to rounding.
  if (sin2 < sin2_of_series && R.trace() > 1)
    return (0.5 + sin2 / 12 + sin2 * sin2 * 3 / 80) * twice_sin;
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

struct RotationOfStep {
  Vector3d phi;        ///< rad: the rotation vector of the step
  double once, twice;  ///< R = 1 + once [phi]x + twice [phi]x^2

  /// Of `part` of the way about the same axis.
  RotationOfStep(const Vector3d& w, double dt, double part = 1);
  /// By a rotation vector.
  explicit RotationOfStep(const Vector3d& phi);
  /// phi alone.
  static Vector3d vector(const Vector3d& w, double dt);
  /// Whether a body turns by dt w.
  static bool follows(const Vector3d& w, double dt);
  /// Where an arm r of the body points in the end.
  Vector3d turned(const Vector3d& r) const {
    const Vector3d first = cross(phi, r);
    return r + once * first + twice * cross(phi, first);
  }
  Matrix3d matrix() const {
    const Vector3d a = once * phi, b = twice * phi;  // [phi]x^2 = phi phi^T - |phi|^2
    const double xy = b.x() * phi.y(), xz = b.x() * phi.z(), yz = b.y() * phi.z(),
                 xx = b.x() * phi.x(), yy = b.y() * phi.y(), zz = b.z() * phi.z();
    Matrix3d R;
    R << 1 - yy - zz, xy - a.z(), xz + a.y(), xy + a.z(), 1 - xx - zz, yz - a.x(), xz - a.y(),
        yz + a.x(), 1 - xx - yy;
    return R;
  }
};

/// The rotation of a rotation vector, rad.
inline Matrix3d turnBy(const Vector3d& phi) { return RotationOfStep(phi).matrix(); }

}  // namespace PINTLE_PRECISION
}  // namespace pintle
