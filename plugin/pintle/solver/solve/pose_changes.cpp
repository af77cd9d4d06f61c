#include <pintle/solver/solve/pose_changes.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {

void findChanges(const Island& island, const Component& component, const std::vector<Vector6d>& v,
                 const std::vector<MovedBody>& end, PoseChange* changes) {
  for (int b = 0; b < component.bodies; ++b) {
    const MovedBody by_velocity(v[size_t(b)], island.dt), &to = end[size_t(b)];
    const Vector6d& push = island.bodies[size_t(component.first_body + b)].push;
    changes[b].head<3>() = to.move - by_velocity.move;
    Matrix3d turn = by_velocity.turn.transpose() * to.turn;
    if (!push.isZero(0)) {
      const MovedBody by_push(push, island.dt);
      changes[b].head<3>() -= by_push.move;
      turn *= by_push.turn.transpose();
    }
    changes[b].tail<3>() = rotationVector(turn);
  }
}

void goOn(const Island& island, const Component& component, const std::vector<Vector6d>& v,
          double part, std::vector<MovedBody>& moved) {
  for (size_t b = 0; b < v.size(); ++b) {
    moved[b].goOn(island.bodies[size_t(component.first_body) + b].push, island.dt, part);
    moved[b].goOn(v[b], island.dt, part);
  }
}

bool startsClosed(const Island& island, const Component& component, double tolerance) {
  const IslandJoint* const joints = &island.joints[size_t(component.first_joint)];
  return std::all_of(joints, joints + component.joints,
                     [&](const IslandJoint& joint) { return joint.open <= tolerance; });
}

bool countsTurns(const Island& island, const Component& component, const std::vector<Vector6d>& v) {
  if (std::all_of(v.begin(), v.end(), [&](const Vector6d& of) {
        return RotationOfStep::follows(of.tail<3>(), island.dt);
      }))
    return false;
  bool any = false;
  forEachRow(island, component, [&](int, int, const IslandRow& row, size_t) {
    any = any || (row.isOfAxis() && row.isOfAngle());
  });
  return any;
}

double bendOfRows(const Island& island, const Component& component, const std::vector<char>& which,
                  const std::vector<MovedBody>& start, const std::vector<MovedBody>& end) {
  double most = 0;
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    double turn[2];  // rad: as far as the body has come, which may be several times round
    for (int side = 0; side < 2; ++side) {
      const auto i = size_t(joint.body[size_t(side)] - component.first_body);
      turn[side] =
          joint.body[size_t(side)] < 0 ? 0 : island.dt * (end[i].v - start[i].v).tail<3>().norm();
    }
    for (int i = 0; i < joint.rows; ++i) {
      const IslandRow& row = island.rows[size_t(joint.first_row + i)];
      if (row.has_position || row.start != nullptr || !which[size_t(joint.row_of_component + i)])
        continue;
      // An angle changes by how both turn; a point or a length by where both levers end.
      const double a = row.J.A_a.norm(), b = row.J.A_b.norm();
      const double bend = row.J.L_b.isZero(0)
                              ? std::fmax(a, b) * (turn[0] + turn[1]) * (turn[0] + turn[1])
                              : a * turn[0] * turn[0] + b * turn[1] * turn[1];
      most = larger(most, bend / 2);
    }
  }
  return most;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
