#include <pintle/solver/model/inverse_inertia.h>

#include <Eigen/LU>

namespace pintle {
inline namespace PINTLE_PRECISION {

Matrix3d inverseWhereFree(const IslandBody& body, Matrix3d inertia) {
  const auto isLocked = [&](int k) { return body.locked[size_t(3 + k)]; };
  for (int k = 0; k < 3; ++k)
    if (isLocked(k)) {
      inertia.row(k).setZero();
      inertia.col(k).setZero();
      inertia(k, k) = 1;
    }
  Matrix3d inverse = inertia.inverse();
  for (int k = 0; k < 3; ++k)
    if (isLocked(k)) inverse(k, k) = 0;
  return inverse;
}

InverseInertia InverseInertia::turned(const IslandBody& body, const Matrix3d& by) {
  InverseInertia to(body);
  to.angular = body.locked[3] || body.locked[4] || body.locked[5]
                   ? inverseWhereFree(body, by * body.inertia * by.transpose())
                   : Matrix3d(by * body.inverse_inertia * by.transpose());
  return to;
}

InverseInertia::InverseInertia(const IslandBody& body, const Matrix3d& stiffness)
    : InverseInertia(body) {
  if (!stiffness.isZero(0)) angular = inverseWhereFree(body, body.inertia + stiffness);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
