// Purpose: A^-1 of a body: of its mass, 3 for the linear part, and 3 x 3 for the turn. 0 where its factors hold it.
#pragma once

#include <pintle/solver/model/island.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Of an inertia about the axes that the body's factors leave free; 0 about the others.
Matrix3d inverseWhereFree(const IslandBody& body, Matrix3d inertia);

/// A^-1 of a body, in the world: 0 where its factors hold it.
struct InverseInertia {
  Vector3d linear;
  Matrix3d angular;
  double scale[2];  ///< square roots of the mass, and of a mean of the inertia

  explicit InverseInertia(const IslandBody& body)
      : linear(body.inverse_mass),
        angular(body.inverse_inertia),
        scale{body.scale[0], body.scale[1]} {}
  /// After a turn.
  static InverseInertia turned(const IslandBody& body, const Matrix3d& by);
  /// With `stiffness` (kg m^2, symmetric, not negative) added to what turns.
  InverseInertia(const IslandBody& body, const Matrix3d& stiffness);
  /// Of an impulse, N s and N m s.
  Vector6d answer(const Vector3d& along, const Vector3d& about) const {
    Vector6d to;
    to << linear.cwiseProduct(along), angular * about;
    return to;
  }
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
