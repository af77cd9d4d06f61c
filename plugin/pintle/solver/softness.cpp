#include <pintle/solver/softness.h>

#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {

// Rows may repeat each other, or contradict each other by what the tolerance leaves: then impulses that nobody bears would grow
// without end. So each joint of a loop gives, by a part of the tolerance under the load that it bears.
void findSoftness(const Island& island, const Component& component, const SolverOptions& options,
                  const Fronts& fronts, Workspace& work) {
  std::vector<double>& softness = work.softness;
  softness.assign(size_t(component.joints), options.dependent_softness);
  const double give = options.newton_tolerance / 10 / island.dt;
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& of = island.joints[size_t(component.first_joint + c)];
    if (!fronts.isInLoop(c)) {
      softness[size_t(c)] = 0;
      continue;
    }
    double load2 = 0;  // m/s: what its impulses change velocities by
    for (int i = 0; i < of.rows; ++i) {
      const double change = island.rows[size_t(of.first_row + i)].K *
                            work.now.lambda[size_t(of.row_of_component + i)];
      load2 += change * change;
    }
    const double load = std::sqrt(load2);
    if (load * softness[size_t(c)] > give) softness[size_t(c)] = give / load;
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
