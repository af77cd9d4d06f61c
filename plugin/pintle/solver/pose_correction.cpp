#include <pintle/solver/pose_correction.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

void correctPoses(const Island& island, const Component& component, const SolverOptions& options,
                  Workspace& work, Fronts& fronts, std::vector<PoseChange>& changes) {
  const bool held_early = work.now.horizon < island.dt;
  if (held_early) {  // what the rest of the step opens
    work.now.horizon = island.dt;
    moveTo(island, component, Tier::start, work.now);
  }
  std::vector<double> open(work.pieces.size(), 0.);
  std::vector<char> acts(work.pieces.size(), false);
  double largest = 0;
  const auto forEachRow = [&](const auto& visit) {
    for (int c = 0; c < component.joints; ++c) {
      const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
      for (int i = 0; i < joint.rows; ++i)
        visit(fronts.joint(c) + i, size_t(joint.row_of_component + i),
              island.rows[size_t(joint.first_row + i)]);
    }
  };
  forEachRow([&](int, size_t r, const IslandRow& row) {
    const LawPiece& piece = work.pieces[r];
    const bool equality = row.law.isEquality() && !(piece.softness > 0);
    acts[r] = equality || row.open != 0;
    if (!acts[r]) return;
    open[r] = row.open;
    if (equality && piece.acts) open[r] += island.dt * (work.now.rows[r].u - piece.target);
    largest = std::fmax(largest, std::abs(open[r]));
  });
  if (largest <= options.newton_tolerance / 2) return;  // nothing is open
  // What is left of Newton's iteration is small enough for its last factor.
  if ((held_early || largest > options.largest_residue) &&
      !Newton(island, component, Tier::start, options, fronts, work).factoriseMotion(acts))
    return;
  std::vector<double> x(size_t(fronts.size()), 0.);
  forEachRow([&](int at, size_t r, const IslandRow& row) {
    if (work.pieces[r].acts) x[size_t(at)] = -open[r] / std::sqrt(row.K);
  });
  fronts.solve(x.data());
  for (int i = component.first_body; i < component.first_body + component.bodies; ++i)
    changes[size_t(i)] =
        island.bodies[size_t(i)].unscaled(&x[size_t(fronts.body(i - component.first_body))]);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
