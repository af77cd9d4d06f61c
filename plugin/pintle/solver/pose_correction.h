// Purpose: joints that are open are brought together by moving poses, which carries no momentum and feeds no kinetic energy: the standard
// projection (Hairer, Lubich and Wanner 2003, IV.4) of the poses q at the end of the step, in the metric of the masses,
//   d A d -> min   with   C(q + d) = 0:   d = A^-1 J^T lambda,   K lambda = -C(q),   K = J A^-1 J^T
// again from each q + d, by a factor of K that is kept while it contracts, with Broyden's corrections (broyden.h).
#pragma once

#include <pintle/solver/broyden.h>
#include <pintle/solver/solver_options.h>
#include <pintle/solver/workspace.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// m and rad, of a body: before its velocity moves it.
using PoseChange = Vector6d;

/// With which a body that moves with `next` comes to where it comes with `v` and `change`.
inline PoseChange changeFor(const Vector6d& next, const Vector6d& v, const PoseChange& change,
                            double dt) {
  PoseChange to;
  to.head<3>() = change.head<3>() + dt * (v - next).head<3>();
  to.tail<3>() =
      rotationVector(RotationOfStep(next.tail<3>(), dt).matrix().transpose() *
                     RotationOfStep(v.tail<3>(), dt).matrix() * turnBy(change.tail<3>()));
  return to;
}

/// The same for next = part * v, and no change before: both turn about one axis.
inline PoseChange changeForPart(double part, const Vector6d& v, double dt) {
  PoseChange to;
  to.head<3>() = dt * (1 - part) * v.head<3>();
  to.tail<3>() =
      RotationOfStep::vector(v.tail<3>(), dt) - RotationOfStep::vector(part * v.tail<3>(), dt);
  return to;
}

/// Of each body of the component: the least move, in the metric of the masses, that closes what its rows have open, and what the
/// velocities leave: Newton's iteration for the poses at the end of the step. `has_factor`: K is that with which the velocities were
/// found, of the rows of the start. Returns what is left open, m or rad.
double correctPoses(const Island& island, const Component& component, const SolverOptions& options,
                    double tolerance, Workspace& work, JointMatrix& K, bool has_factor,
                    PoseChange* changes);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
