// Purpose: what rows of a joint measure, where their Jacobians tell it: then their end of the step is known without asking the joint.
#pragma once

#include <pintle/solver/model/island.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Three rows that hold a point along three axes are a ball. Returns whether they are. Their Jacobians are then those of a ball, too:
/// where a body is static and the others do not let it turn, Bullet may leave out the moment of one. And they hold it along the axes of
/// the world, unless they are not as soft along all of their own.
bool findPoint(IslandRow* rows);

/// Two or three rows that hold a turn about axes at right angles: they keep axes of the bodies at right angles. Returns whether they do.
/// `w_a`, `w_b`: how these turn in the step, rad/s.
bool findTurn(IslandRow* const* rows, int count, const Vector3d& w_a, const Vector3d& w_b);

/// An angle about an axis that the joint holds: arms at right angles to that, the same of both bodies.
void setTurn(IslandRow& row);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
