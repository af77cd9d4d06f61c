#include <pintle/solver/model/turn.h>

#include <LinearMath/btTransformUtil.h>

#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

constexpr double max_turn = double(ANGULAR_MOTION_THRESHOLD);
const double slope_of_tangent = std::tan(max_turn / 2) / max_turn;

double angleBeyond(double asked) { return 2 * std::atan(slope_of_tangent * asked); }

}  // namespace

Vector3d RotationOfStep::vector(const Vector3d& w, double dt) {
  const Vector3d phi = dt * w;
  const double length = phi.norm();
  return length > max_turn ? Vector3d(angleBeyond(length) / length * phi) : phi;
}

RotationOfStep::RotationOfStep(const Vector3d& w, double dt, double part)
    : RotationOfStep(part * vector(w, dt)) {}

RotationOfStep::RotationOfStep(const Vector3d& phi_of_it) : phi(phi_of_it) {
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

bool RotationOfStep::follows(const Vector3d& w, double dt) { return dt * w.norm() <= max_turn; }

}  // namespace PINTLE_PRECISION
}  // namespace pintle
