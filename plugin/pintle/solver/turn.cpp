#include <pintle/solver/turn.h>

#include <LinearMath/btTransformUtil.h>

#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// V = 1 + once [phi]x + twice [phi]x^2, and the derivatives of both by t = |phi|, divided by t.
struct MeanFactors {
  double once, twice, once_slope, twice_slope;

  explicit MeanFactors(double t2) {
    if (t2 < 1e-6) {
      once = 0.5 - t2 / 24;
      twice = 1. / 6 - t2 / 120;
      once_slope = -1. / 12 + t2 / 180;
      twice_slope = -1. / 60 + t2 / 1260;
      return;
    }
    const double t = std::sqrt(t2), half = std::sin(t / 2), sine = std::sin(t);
    once = 2 * half * half / t2;
    twice = (t - sine) / (t2 * t);
    once_slope = t2 < 1e-2 ? -1. / 12 + t2 / 180 - t2 * t2 / 6720 : (sine / t - 2 * once) / t2;
    twice_slope = t2 < 1e-2 ? -1. / 60 + t2 / 1260 - t2 * t2 / 60480 : (once - 3 * twice) / t2;
  }
};

constexpr double max_turn = double(ANGULAR_MOTION_THRESHOLD);
const double slope_of_tangent = std::tan(max_turn / 2) / max_turn;

double angleBeyond(double asked) { return 2 * std::atan(slope_of_tangent * asked); }

}  // namespace

Matrix3d meanOfTurn(const Vector3d& phi) {
  const Matrix3d X = crossMatrix(phi);
  const MeanFactors factors(phi.squaredNorm());
  return Matrix3d::Identity() + factors.once * X + factors.twice * X * X;
}

RotationOfStep::RotationOfStep(const Vector3d& w, double dt) : phi(dt * w) {
  if (const double length = phi.norm(); length > max_turn) phi *= angleBeyond(length) / length;
  const double t2 = phi.squaredNorm();
  if (t2 < 1e-6) {
    once = 1 - t2 / 6;
    twice = 0.5 - t2 / 24;
    return;
  }
  const double t = std::sqrt(t2), half = std::sin(t / 2);
  once = std::sin(t) / t;
  twice = 2 * half * half / t2;
}

Turn::Turn(const Vector3d& w, double dt) {
  const Vector3d asked = dt * w;
  const double length = asked.norm();
  if (length > max_turn) {
    const double angle = angleBeyond(length), tangent = std::tan(angle / 2),
                 rate = 2 * slope_of_tangent / (1 + tangent * tangent);
    part = angle / length;
    part_slope = (rate - part) / length * (asked / length);
  }
  phi = part * asked;
  mean = meanOfTurn(phi);
  slope = length > max_turn ? Matrix3d(mean * phiSlope()) : mean;
}

Matrix3d Turn::phiSlope() const {
  return part * Matrix3d::Identity() + phi / part * part_slope.transpose();
}

Matrix3d Turn::meanSlope(const Vector3d& r) const {
  const MeanFactors factors(phi.squaredNorm());
  const Vector3d once = cross(phi, r), twice = cross(phi, once);
  Matrix3d by_phi = -factors.once * crossMatrix(r);
  by_phi += factors.twice *
            (phi.dot(r) * Matrix3d::Identity() + phi * r.transpose() - 2 * r * phi.transpose());
  by_phi += (factors.once_slope * once + factors.twice_slope * twice) * phi.transpose();
  if (part == 1) return by_phi;
  return part * by_phi * phiSlope() + (mean * r) * part_slope.transpose();
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
