// Purpose: a component of joints as it would end the step with given velocities: poses, what its rows measure there, and where
// their impulses act.
#pragma once

#include <pintle/solver/island.h>
#include <pintle/solver/turn.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Where a body ends the step.
struct BodyAtEnd {
  Vector6d v;
  Turn turn;
  btTransform pose;
};

/// A row, if the step ends like this.
struct RowAtEnd {
  double u;       ///< its velocity
  RowJacobian J;  ///< du/dv
  RowJacobian G;  ///< along which its impulse acts: the discrete gradient (discrete_gradient.h)
};

/// The state of the iteration of one component.
struct Iterate {
  /// s: rows hold at this time of the step. At its end, or earlier: with 0 in velocity, which is a linear problem. By the
  /// discrete gradient up to then joints never gain either.
  double horizon = 0;
  std::vector<BodyAtEnd> bodies;
  std::vector<RowAtEnd> rows;
  std::vector<double> lambda;  ///< N s, N m s
};

/// Bodies and rows of the component at velocities `at.bodies[].v`.
void moveTo(const Island& island, const Component& component, Iterate& at);

/// A body at the end of the step, as far as u of rows needs it.
struct MovedBody {
  Vector6d v;
  RotationOfStep turn;

  MovedBody(const Vector6d& velocity, double dt) : v(velocity), turn(velocity.tail<3>(), dt) {}
};
/// Only u of all rows, at velocities v. `bodies`: memory for it.
void measure(const Island& island, const Component& component, double dt,
             const std::vector<Vector6d>& v, std::vector<MovedBody>& bodies,
             std::vector<double>& u);

/// The body of a joint; one that does not move rests.
const BodyAtEnd& bodyOf(const IslandJoint& joint, int side, const Component& component,
                        const Iterate& at);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
