// Purpose: what the rows of a component measure over the step, if their bodies move with given velocities:
//   u = (C(q_1) - C(q_0)) / dt,   the mean of J v over the way from q_0 to q_1
// so that a row that is met is met in poses, and not in directions of the start alone.
#pragma once

#include <pintle/solver/model/island.h>

#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Where bodies end the step that move with `v`: those of the component.
void moveBodies(const Island& island, const Component& component, const Vector6d* v,
                std::vector<MovedBody>& moved);
/// u of each row: (C(end) - C(start)) / dt, or J v of a row that is known at the start alone.
void measureAtEnd(const Island& island, const Component& component,
                  const std::vector<MovedBody>& moved, std::vector<double>& u);
/// The same of `which` rows. Of others: J v.
void measureAtEnd(const Island& island, const Component& component,
                  const std::vector<MovedBody>& moved, const std::vector<char>& which,
                  std::vector<double>& u);
/// How C of `which` rows changes there with the poses of their bodies. Of others: at the start.
void differentiateAtEnd(const Island& island, const Component& component,
                        const std::vector<MovedBody>& moved, const std::vector<char>& which,
                        std::vector<RowJacobian>& J);
/// Where forces lead beyond a stop whose direction has turned over by then, as at the tip of a flat cone, the stop acts along the
/// direction there.
void turnStops(Island& island, const Component& component);
/// J v of each row.
void measureAtStart(const Island& island, const Component& component, const Vector6d* v,
                    std::vector<double>& u);

/// Mean velocity of the body of a joint from the one that it starts with (IslandBody::v0, or v_free) to v at the end of the step (those of the
/// component).
Vector6d meanVelocity(const Island& island, const IslandJoint& joint, int side,
                      const Component& component, const std::vector<Vector6d>& v,
                      Vector6d IslandBody::*start = &IslandBody::v0);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
