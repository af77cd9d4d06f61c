#include "outcome.h"

#include <algorithm>
#include <cmath>

#include "../measures/run.h"

namespace extreme {

const char* name(Outcome outcome) {
  static const char* const names[] = {"exact", "settles", "bounded", "diverges", "non-finite"};
  return names[int(outcome)];
}

Result run(const Case& one, engines::MakeJoint make_joint, const scenes::SolverFactory& solver) {
  const auto engine = engines::make_bullet(one.scene, one.iterations, make_joint, solver);
  if (one.prepare) one.prepare(*engine);
  std::vector<measures::Overshoot> overshoots;
  for (const scenes::Joint& joint : one.scene.joints) overshoots.emplace_back(joint);
  double error = 0, speed = 0;  // in the last half
  const int steps = std::max(20, int(std::lround(one.scene.seconds / one.dt)));
  for (int step = 0; step < steps; ++step) {
    if (one.act) one.act(*engine, step);
    engine->drive(step * one.dt, one.dt);
    engine->step(one.dt);
    std::vector<engines::State> now;
    for (size_t i = 0; i < one.scene.bodies.size(); ++i) now.push_back(engine->state(int(i)));
    for (const engines::State& state : now) {
      if (!state.pose.matrix().allFinite() || !state.velocity.allFinite() ||
          !state.angular_velocity.allFinite())
        return {Outcome::non_finite, HUGE_VAL};
    }
    const bool counts = step >= steps / 2;
    for (size_t i = 0; i < one.scene.joints.size(); ++i) {
      const scenes::Joint& joint = one.scene.joints[i];
      const engines::State &a = now[size_t(joint.a)], &b = now[size_t(joint.b)];
      const double beyond = overshoots[i](a, b);  // follows the turns: not only where it counts
      if (!counts) continue;
      const measures::JointErrors left = measures::joint_errors(joint, a, b);
      const double unit = joint.kind == scenes::Kind::slider ? one.size : 1;
      error = std::max({error, left.gap / one.size, left.axis, beyond / unit});
      speed = std::max({speed, now[size_t(joint.b)].velocity.norm(),
                        now[size_t(joint.b)].angular_velocity.norm() * one.size});
    }
  }
  if (error > 10 || speed > 100 * one.speed) return {Outcome::diverges, error};
  if (error > 0.05) return {Outcome::bounded, error};
  return {error > 1e-3 ? Outcome::settles : Outcome::exact, error};
}

}  // namespace extreme
