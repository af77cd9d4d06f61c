#include "crate_bridges.h"

#include <algorithm>
#include <cmath>

#include "../scenes/crowds.h"
#include "joint_work.h"
#include "run.h"

namespace measures {
namespace {

using scenes::CrateBridges;
using scenes::Vector3d;

bool is_on(const CrateBridges::Crate& crate, const Vector3d& p) {
  return p.z() > crate.from.z() - 3 && p.x() > crate.from.x() && p.x() < crate.to.x() &&
         std::abs(p.y() - crate.from.y()) < 2 * CrateBridges::half_width;
}

double energy_of(const CrateBridges& bridges, engines::BulletEngine& engine, double gravity) {
  double sum = 0;
  for (size_t i = 1; i < bridges.scene.bodies.size(); ++i)
    sum += scenes::energy(engine.body(int(i)), gravity);
  return sum;
}

}  // namespace

CrateBridgesResult run_crate_bridges(engines::MakeJoint make_joint, int iterations, double hz,
                                     double seconds, int count) {
  const CrateBridges bridges = scenes::crate_bridges(count);
  const auto engine = engines::make_bullet(bridges.scene, iterations, make_joint);
  const auto energy = [&] { return energy_of(bridges, *engine, bridges.scene.gravity); };
  const int steps = int(std::lround(seconds * hz));
  CrateBridgesResult result;
  JointWork work(engine->world());
  double last_energy = energy();
  for (int i = 0; i < steps; ++i) {
    work.beginStep();
    engine->step(1 / hz);
    result.fed += std::max(0., work.endStep(1 / hz));
    const double gain = energy() - last_energy;
    last_energy += gain;
    result.gains += std::max(0., gain);
    result.largest_gain = std::max(result.largest_gain, gain);
    const Gaps now = gaps(bridges.scene, *engine);
    result.mean_gap += now.mean / steps;
    result.max_gap = std::max(result.max_gap, now.largest);
  }
  result.end_kinetic = energy_of(bridges, *engine, 0);
  for (const CrateBridges::Crate& crate : bridges.crates)
    result.thrown_off += is_on(crate, engine->state(crate.body).pose.translation()) ? 0 : 1;
  return result;
}

}  // namespace measures
