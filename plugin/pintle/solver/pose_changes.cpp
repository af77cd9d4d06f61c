#include <pintle/solver/pose_changes.h>

#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {

void shorten(const Island& island, const Component& component, const JointMatrix& K,
             const std::vector<double>& open_rows, PoseChange* changes) {
  const auto body = [&](int i) -> const IslandBody& {
    return island.bodies[size_t(component.first_body + i)];
  };
  double most = 0, moved = 0;  // m
  forEachRow(island, component, [&](int c, int i, const IslandRow& row, size_t) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    const double open = std::abs(open_rows[K.row(c, i)]) * row.root_K * island.dt;
    for (int side = 0; side < 2; ++side)
      if (joint.body[size_t(side)] >= 0) {
        const IslandBody& of = island.bodies[size_t(joint.body[size_t(side)])];
        const double length = row.J.L(side).norm(),
                     by = open / row.K *
                          (length / of.mass +
                           of.radius() * (of.inverse_inertia * row.J.A(side)).norm());
        // A free body moves by no more than sqrt(2) open / |L|. One that can only turn about a short lever would go much further.
        most += length > 0 ? std::fmin(by, std::sqrt(2.) * open / length) : by;
      }
  });
  for (int i = 0; i < component.bodies; ++i) {
    const double by = changes[i].head<3>().norm() + body(i).radius() * changes[i].tail<3>().norm();
    moved = by <= moved ? moved : by;  // and not finite if one is
  }
  if (moved <= most) return;
  for (int i = 0; i < component.bodies; ++i)
    changes[i] = std::isfinite(moved) ? PoseChange(most / moved * changes[i])
                                      : PoseChange(PoseChange::Zero());
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
