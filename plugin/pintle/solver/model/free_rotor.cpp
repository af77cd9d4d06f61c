#include <pintle/solver/model/free_rotor.h>

#include <cmath>
#include <utility>

namespace pintle {
inline namespace PINTLE_PRECISION {

Matrix3d turnOfRotor(const Matrix3d& axes, const Vector3d& inverse_inertia, const Vector3d& w,
                     double dt) {
  // In the body's own frame, from which L turns back.
  Vector3d L = (axes.transpose() * w).cwiseQuotient(inverse_inertia);
  Matrix3d R = Matrix3d::Identity();
  for (const auto& [axis, part] : {std::pair(0, 0.5), {1, 0.5}, {2, 1.}, {1, 0.5}, {0, 0.5}}) {
    const double angle = part * dt * L[axis] * inverse_inertia[axis];
    const Matrix3d turn = turnBy(angle * Vector3d::Unit(axis));
    R = R * turn;
    L = turn.transpose() * L;
  }
  return axes * R * axes.transpose();
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
