#include <pintle/solver/solve/overflow.h>

#include <pintle/finite.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Room for the rounding of Bullet's sums.
constexpr double max_scalar =
    double(std::numeric_limits<Scalar>::max()) * (1 - 8 * double(SIMD_EPSILON));

template <class Vector>
bool areRepresentable(const Vector& x) {
  return isNumber(x.sum()) && (x.array().abs() <= max_scalar).all();
}

}  // namespace

bool isRepresentable(double x) { return isNumber(x) && std::abs(x) <= max_scalar; }

bool overflows(const IslandBody& of, const btSolverBody& bullets, const Vector6d& v,
               const PoseChange& change, double dt) {
  // Bullet adds the change to the velocity at the start, and then what forces do.
  const Vector6d by_impulses = v - freeVelocity(bullets);
  Vector6d start;
  start << inDouble(bullets.m_linearVelocity), inDouble(bullets.m_angularVelocity);
  if (!areRepresentable(v) || !areRepresentable(by_impulses) ||
      !areRepresentable(start + by_impulses) || !areRepresentable(change))
    return true;
  // Poses are moved in this order.
  Vector3d x = inDouble(of.start.getOrigin());
  for (const Vector3d& way :
       {Vector3d(dt * of.push.head<3>()), Vector3d(change.head<3>()), Vector3d(dt * v.head<3>())}) {
    x += way;
    if (!areRepresentable(way) || !areRepresentable(x)) return true;
  }
  return !areRepresentable(of.push);
}

bool overflows(const std::vector<double>& lambda, double dt) {
  const double unit = std::fmax(1, 1 / dt);
  return !std::all_of(lambda.begin(), lambda.end(),
                      [&](double of) { return isRepresentable(unit * of); });
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
