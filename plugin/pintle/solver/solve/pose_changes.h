// Purpose: by how much a pose is moved in a step, beside what its velocity does.
#pragma once

#include <pintle/solver/system/joint_matrix.h>
#include <pintle/solver/system/workspace.h>

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

/// Between what contacts push and the step of the velocities `v`, so that bodies of the component come to `end`.
void findChanges(const Island& island, const Component& component, const std::vector<Vector6d>& v,
                 const std::vector<MovedBody>& end, PoseChange* changes);

/// Bodies of the component go a part of the step's way: what contacts push, and what velocities `v` do.
void goOn(const Island& island, const Component& component, const std::vector<Vector6d>& v,
          double part, std::vector<MovedBody>& moved);

/// Whether no joint of the component is open by more than `tolerance` (m or rad) at the start of the step.
bool startsClosed(const Island& island, const Component& component, double tolerance);

/// Whether bodies go round so fast, with `v`, that joints of the component tell by their velocities how often: where they are does not.
bool countsTurns(const Island& island, const Component& component, const std::vector<Vector6d>& v);

/// m or rad: the most by which turning bodies of the component from `start` to `end` changes what those rows of Bullet's measure beside what they
/// say, which is known at the start of the step alone: a lever |A| that turns by phi leaves its tangent by |A| phi^2 / 2. Of `which` rows.
double bendOfRows(const Island& island, const Component& component, const std::vector<char>& which,
                  const std::vector<MovedBody>& start, const std::vector<MovedBody>& end);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
