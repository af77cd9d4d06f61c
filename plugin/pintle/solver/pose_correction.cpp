#include <pintle/solver/pose_correction.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

namespace {

// m: of gyration.
double radius(const IslandBody& body) { return body.scale[1] / body.scale[0]; }

}  // namespace

void correctPoses(const Island& island, const Component& component, const SolverOptions& options,
                  Workspace& work, Fronts& fronts, std::vector<PoseChange>& changes) {
  const bool held_early = work.now.horizon < island.dt;
  if (held_early) {  // what the rest of the step opens
    work.now.horizon = island.dt;
    moveTo(island, component, Tier::start, work.now);
  }
  std::vector<double> open(work.pieces.size(), 0.);
  std::vector<char> acts(work.pieces.size(), false);
  double largest = 0;  // m or rad
  const auto forEachRow = [&](const auto& visit) {
    for (int c = 0; c < component.joints; ++c) {
      const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
      for (int i = 0; i < joint.rows; ++i)
        visit(joint, fronts.joint(c) + i, size_t(joint.row_of_component + i),
              island.rows[size_t(joint.first_row + i)]);
    }
  };
  forEachRow([&](const IslandJoint&, int, size_t r, const IslandRow& row) {
    const LawPiece& piece = work.pieces[r];
    const bool equality = row.law.isEquality() && !(piece.softness > 0);
    acts[r] = equality || row.open != 0;
    if (!acts[r]) return;
    open[r] = row.open;
    if (equality && piece.acts) open[r] += island.dt * (work.now.rows[r].u - piece.target);
    largest = std::fmax(largest, std::abs(open[r]));
  });
  if (largest <= options.pose_tolerance / 2) return;  // nothing is open
  // What is left of Newton's iteration is small enough for its last factor.
  if ((held_early || largest > options.largest_residue) &&
      !Newton(island, component, Tier::start, options, fronts, work).factoriseMotion(acts))
    return;
  std::vector<double> x(size_t(fronts.size()), 0.);
  forEachRow([&](const IslandJoint&, int at, size_t r, const IslandRow& row) {
    if (work.pieces[r].acts) x[size_t(at)] = -open[r] / row.root_K;
  });
  fronts.solve(x.data());
  double moved = 0;
  for (int i = component.first_body; i < component.first_body + component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(i)];
    Vector6d& change = changes[size_t(i)];
    change = body.unscaled(&x[size_t(fronts.body(i - component.first_body))]);
    const double by = change.head<3>().norm() + radius(body) * change.tail<3>().norm();
    moved = by <= moved ? moved : by;  // and not finite if one is
  }
  // Where no motion closes all, the nearest one may be far. No body goes further than all rows together would move it.
  if (largest <= options.largest_residue) return;
  double most = 0;  // m: what all rows would move a body by, each alone
  forEachRow([&](const IslandJoint& joint, int, size_t r, const IslandRow& row) {
    for (int side = 0; side < 2; ++side)
      if (joint.body[size_t(side)] >= 0) {
        const IslandBody& body = island.bodies[size_t(joint.body[size_t(side)])];
        most += std::abs(open[r]) / row.K *
                (row.J.L(side).norm() / body.mass +
                 radius(body) * (body.inverse_inertia * row.J.A(side)).norm());
      }
  });
  if (moved <= most) return;
  for (int i = component.first_body; i < component.first_body + component.bodies; ++i) {
    PoseChange& change = changes[size_t(i)];
    change = std::isfinite(moved) ? PoseChange(most / moved * change) : PoseChange::Zero();
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
