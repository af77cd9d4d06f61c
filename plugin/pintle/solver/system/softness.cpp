#include <pintle/solver/system/softness.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {

std::vector<char> findLoops(int bodies, const std::vector<std::array<int, 2>>& joints) {
  std::vector<std::vector<int>> joints_of(static_cast<size_t>(bodies));
  for (size_t c = 0; c < joints.size(); ++c)
    for (const int body : joints[c])
      if (body >= 0) joints_of[size_t(body)].push_back(int(c));
  std::vector<char> in_loop(joints.size(), true);
  std::vector<int> left(static_cast<size_t>(bodies)), ends;
  for (size_t b = 0; b < joints_of.size(); ++b) {
    left[b] = int(joints_of[b].size());
    if (left[b] == 1) ends.push_back(int(b));
  }
  while (!ends.empty()) {
    const int end = ends.back();
    ends.pop_back();
    for (const int c : joints_of[size_t(end)]) {
      if (!in_loop[size_t(c)]) continue;
      in_loop[size_t(c)] = false;
      for (const int body : joints[size_t(c)])
        if (body >= 0 && --left[size_t(body)] == 1) ends.push_back(body);
    }
  }
  return in_loop;
}

// Rows may repeat each other, or contradict each other by what the tolerance leaves: then impulses that nobody bears would grow
// without end. So each joint of a loop gives, by a part of the tolerance under the load that it bears; and one of several stops, which
// may meet in a corner.
void findSoftness(const Island& island, const Component& component, const SolverOptions& options,
                  const std::vector<char>& in_loop, Workspace& work) {
  work.has_loops = std::find(in_loop.begin(), in_loop.end(), true) != in_loop.end();
  std::vector<double>& softness = work.of_loop;
  softness.resize(size_t(component.joints));
  const double give = options.newton_tolerance / options.dependent_margin / island.dt;
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& of = island.joints[size_t(component.first_joint + c)];
    if (!in_loop[size_t(c)] && of.bounded < 2) {
      softness[size_t(c)] = 0;
      continue;
    }
    double load2 = 0;  // m/s: what its impulses change velocities by
    for (int i = 0; i < of.rows; ++i) {
      const double change =
          island.rows[size_t(of.first_row + i)].K * work.lambda[size_t(of.row_of_component + i)];
      load2 += change * change;
    }
    const double load = std::sqrt(load2), most = options.dependent_softness;
    softness[size_t(c)] = load * most > give ? give / load : most;
  }
}

bool isOpen(const Island& island, const Component& component, const Workspace& end,
            double tolerance) {
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    if (!(joint.open > tolerance) && !(end.of_loop[size_t(c)] > 0)) continue;
    for (int i = 0; i < joint.rows; ++i) {
      const IslandRow& row = island.rows[size_t(joint.first_row + i)];
      const auto r = size_t(joint.row_of_component + i);
      const LawPiece& piece = end.pieces[r];
      const double gives = piece.acts && !(piece.softness > 0)
                               ? island.dt * end.softness[r] * row.K * std::abs(end.lambda[r])
                               : 0;
      if (std::abs(row.open) > tolerance || gives > tolerance) return true;
    }
  }
  return false;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
