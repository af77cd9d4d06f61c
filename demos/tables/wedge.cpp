// An arm between the sides of its wedge.

#include "../scenes/directions.h"
#include "catalog_scenes.h"
#include "tables.h"

namespace tables {
namespace {

// The direction at psi about z and at `height` from it, rad.
scenes::Vector3d direction(double psi, double height) {
  return {std::sin(height) * std::cos(psi), std::sin(height) * std::sin(psi), std::cos(height)};
}

// Thrown from 24 directions inside, without gravity, for 2 s each: how far outside it came, and its largest
// angular speed over that of the throw; above 1 the limit has thrown it. Then hanging, with air drag, for 10 s,
// where straight down is 40 degrees off the axis and behind the edge: a wedge of less than half a turn holds it
// in the corner, along the axis; a wider one on a side. In the last 2 s: its angular speed, and how far outside.
Measurement measure_wedge(double total, engines::MakeJoint make_joint) {
  constexpr double dt = 1. / 60, speed = 6;
  double beyond = 0, fastest = 0, restless = 0, off = 0;
  bool finite = true;
  for (int n = 0; n < 24 && finite; ++n) {
    // Directions and spins that are spread out and repeat: multiples of the golden angle.
    const double turn = 2.39996 * n;
    scenes::Scene scene =
        scenes::elbow_scene(total, Eigen::Quaterniond::Identity(),
                            direction(0.45 * total * std::sin(turn), 0.15 + 2.8 * (n + 0.5) / 24));
    scene.gravity = 0;
    scene.seconds = 2;
    spin(scene.bodies.back(), speed * direction(turn, 0.3 + 2.5 * ((7 * n) % 24) / 24.), {0, 0, 0});
    const measures::Outcome outcome =
        measures::run(scene, *engines::make_bullet(scene, 10, make_joint), dt,
                      [&](double, const std::vector<engines::State>& states) {
                        fastest = std::max(fastest, states.back().angular_velocity.norm() / speed);
                      });
    finite = outcome.finite;
    beyond = std::max(beyond, outcome[scenes::Error::overshoot]);
  }
  // A little to one side, so that it is known which way a wedge of more than half a turn lets it slide.
  const scenes::Vector3d down = direction(scenes::pi - 0.1, radians(40));
  scenes::Scene scene = scenes::elbow_scene(
      total, scenes::turn_between(down, -scenes::Vector3d::UnitZ()), direction(0.1 * total, 0.4));
  scene.bodies.back().damping = 0.9;
  scene.seconds = 10;
  measures::Overshoot outside(scene.joints[0]);
  const measures::Outcome outcome =
      measures::run(scene, *engines::make_bullet(scene, 10, make_joint), dt,
                    [&](double time, const std::vector<engines::State>& states) {
                      if (time < scene.seconds - 2 + dt / 2) return;
                      restless = std::max(restless, states.back().angular_velocity.norm());
                      off = std::max(off, outside(states.front(), states.back()));
                    });
  finite = finite && outcome.finite;
  return {{or_infinite(finite, degrees(beyond)), or_infinite(finite, fastest),
           or_infinite(finite, restless), or_infinite(finite, degrees(off))},
          or_infinite(finite, degrees(beyond)),
          microseconds_per_step(outcome)};
}

}  // namespace

void run_wedge(Output& out) {
  Table table(out, "wedge", "an arm is thrown at its limits, and hangs in their corner",
              {{"beyond", "deg", "%.2f", "lost"},
               {"fastest", "of speed", "%.2f", "lost"},
               {"restless", "rad/s", "%.1e", "lost"},
               {"off", "deg", "%.1e", "lost"}});
  for (const double total : {5, 30, 90, 150, 200, 270, 350}) {
    const auto measure = [=](engines::MakeJoint make_joint) {
      return measure_wedge(radians(total), make_joint);
    };
    table.compare(text("%g deg 60Hz", total),
                  {{"stock", [=] { return measure(engines::make_stock_joint); }},
                   {"pintle", [=] { return measure(engines::make_conditioned_joint); }}});
  }
}

}  // namespace tables
