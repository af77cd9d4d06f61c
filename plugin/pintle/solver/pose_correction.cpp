#include <pintle/solver/pose_correction.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

namespace {

// m: of gyration.
double radius(const IslandBody& body) { return body.scale[1] / body.scale[0]; }

}  // namespace

void correctPoses(const Island& island, const Component& component, const SolverOptions& options,
                  Workspace& work, JointMatrix& K, bool has_factor,
                  std::vector<PoseChange>& changes) {
  const bool held_early = work.now.horizon < island.dt;
  if (held_early) {  // what the rest of the step opens
    work.now.horizon = island.dt;
    moveTo(island, component, work.now);
  }
  std::vector<double> open(work.pieces.size(), 0.);
  std::vector<char> acts(work.pieces.size(), false);
  double largest = 0;  // m or rad
  forEachRow(island, component, [&](int, int, const IslandRow& row, size_t r) {
    const LawPiece& piece = work.pieces[r];
    const bool equality = row.law.isEquality() && !(piece.softness > 0);
    acts[r] = equality || row.open != 0;
    if (!acts[r]) return;
    open[r] = row.open;
    if (equality && piece.acts) open[r] += island.dt * (work.now.rows[r].u - piece.target);
    largest =
        std::abs(open[r]) <= largest ? largest : std::abs(open[r]);  // and not finite if one is
  });
  if (largest <= options.pose_tolerance / 2) return;  // nothing is open
  // The least motion, in the metric of the masses, by the rows as they are at the end.
  if (held_early || !has_factor || largest > options.largest_residue) {
    if (has_factor) moveTo(island, component, work.now);
    std::vector<InverseInertia>& bodies = K.bodies();
    bodies.clear();
    for (int i = component.first_body; i < component.first_body + component.bodies; ++i)
      bodies.emplace_back(island.bodies[size_t(i)], Matrix3d::Zero());
    K.begin();
    forEachRow(island, component, [&](int c, int i, const IslandRow& row, size_t r) {
      if (acts[r]) K.setRow(c, i, work.now.rows[r].J, row.root_K, options.dependent_softness);
    });
    if (!K.factorise(options.least_pivot)) return;
  }
  std::vector<double> x(K.unknowns(), 0.);
  forEachRow(island, component, [&](int c, int i, const IslandRow& row, size_t r) {
    if (work.pieces[r].acts || acts[r]) x[K.row(c) + size_t(i)] = -open[r] / row.root_K;
  });
  K.solve(x.data());
  std::vector<Vector6d> change(size_t(component.bodies), Vector6d::Zero());
  K.addResponse(x.data(), change);
  double moved = 0;
  for (int i = 0; i < component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body + i)];
    changes[size_t(component.first_body + i)] = change[size_t(i)];
    const double by =
        change[size_t(i)].head<3>().norm() + radius(body) * change[size_t(i)].tail<3>().norm();
    moved = by <= moved ? moved : by;  // and not finite if one is
  }
  // Where no motion closes all, the nearest one may be far. No body goes further than all rows together would move it.
  if (largest <= options.largest_residue && std::isfinite(moved)) return;
  double most = 0;  // m: what all rows would move a body by, each alone
  forEachRow(island, component, [&](int c, int, const IslandRow& row, size_t r) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
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
    PoseChange& of = changes[size_t(i)];
    of = std::isfinite(moved) ? PoseChange(most / moved * of) : PoseChange::Zero();
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
