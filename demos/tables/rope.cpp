// A weight on a rope, or on a rod.

#include "../measures/courses.h"
#include "../scenes/pendulum.h"
#include "catalog_scenes.h"
#include "tables.h"

namespace tables {
namespace {

// Of the weight, whatever it hangs on.
Measurement measure_rope(const scenes::Scene& scene, double dt, bool slack,
                         engines::MakeJoint make_joint) {
  const auto engine = engines::make_bullet(scene, 10, make_joint);
  const scenes::Body& weight = scene.bodies[size_t(scene.probe_body)];
  const scenes::Vector3d start = weight.pose.translation();
  const double amplitude = std::atan2(start.x(), -start.z()), g = scenes::standard_gravity;
  measures::Period period(amplitude);
  double stretch = 0, energy = 0;
  const measures::Outcome outcome = measures::run(
      scene, *engine, dt, [&](double time, const std::vector<engines::State>& states) {
        const engines::State& now = states[size_t(scene.probe_body)];
        const scenes::Vector3d at = now.pose.translation();
        const scenes::Vector3d w = now.pose.linear().transpose() * now.angular_velocity;
        const double kinetic =
            weight.mass * now.velocity.squaredNorm() + weight.inertia.dot(w.cwiseAbs2());
        const double gained =
            (kinetic / 2 + weight.mass * g * (at.z() - start.z())) / scene.energy_scale;
        const double longer = at.norm() - 1;
        stretch = std::max(stretch, slack ? longer : std::abs(longer));
        energy = std::max(energy, slack ? gained : std::abs(gained));
        period.observe(time, std::atan2(at.x(), -at.z()));
      });
  const double exact = scenes::pendulum_period(weight.mass, weight.mass * g, amplitude);
  return {{slack ? NAN : or_infinite(period.value() > 0, period.value() / exact - 1),
           or_infinite(outcome.finite, stretch), or_infinite(outcome.finite, energy)},
          or_infinite(outcome.finite, stretch),
          microseconds_per_step(outcome)};
}

}  // namespace

void run_rope(Output& out) {
  Table table(out, "rope", "a weight swings on a rod, or falls until its rope is taut",
              {{"period", "relative", "%+.2e"},
               {"stretch", "m", "%.2e", "lost"},
               {"energy", "relative", "%.2e", "lost"}});
  for (const bool slack : {false, true}) {
    const scenes::Scene scene = scenes::rope_scene(slack), sticks = scenes::stick_rope_scene(slack);
    for (const double hz : {60, 240}) {
      table.compare(
          text("%s %gHz", slack ? "rope" : "rod from 60 deg", hz),
          {{"stock",
            [&] { return measure_rope(sticks, 1 / hz, slack, engines::make_stock_joint); }},
           {"pintle",
            [&] { return measure_rope(scene, 1 / hz, slack, engines::make_conditioned_joint); }}});
    }
  }
}

}  // namespace tables
