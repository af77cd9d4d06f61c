// Purpose: numbers of a step that Bullet cannot hold. A solve is in double precision: its velocities and poses may be finite there, and
// not in single precision.
#pragma once

#include <pintle/solver/model/contacts.h>
#include <pintle/solver/model/island.h>
#include <pintle/solver/solve/chord.h>
#include <pintle/solver/solve/pose_changes.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// True where a Scalar holds x, which NaN never is.
bool isRepresentable(double x);

/// True where a step that ends with velocity v, and moves the pose by `change` besides, takes a body to numbers that Bullet cannot hold,
/// sums on the way there included.
bool overflows(const IslandBody& of, const btSolverBody& bullets, const Vector6d& v,
               const PoseChange& change, double dt);
/// True where the impulses of a component's rows, or their forces, do. `lambda`: N s or N m s, of each row.
bool overflows(const std::vector<double>& lambda, double dt);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
