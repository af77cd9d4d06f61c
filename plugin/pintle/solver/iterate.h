// Purpose: a component of joints as it would end the step with given velocities: poses, what its rows measure there, and where
// their impulses act.
#pragma once

#include <pintle/solver/island.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

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

/// Only u of all rows, at velocities v. `bodies`: memory for it.
void measure(const Island& island, const Component& component, double dt,
             const std::vector<Vector6d>& v, std::vector<MovedBody>& bodies,
             std::vector<double>& u);

/// To where its velocity leads from `start` within dt.
void moveBody(const btTransform& start, double dt, BodyAtEnd& end);
/// The body of a joint.
const BodyAtEnd& bodyOf(const Island& island, const IslandJoint& joint, int side,
                        const Component& component, const Iterate& at);
/// Its mean velocity, from the one that it starts with (IslandBody::v0, or v_free).
Vector6d meanVelocity(const Island& island, const IslandJoint& joint, int side,
                      const Component& component, const Iterate& at,
                      Vector6d IslandBody::*start = &IslandBody::v0);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
