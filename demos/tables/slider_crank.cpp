// A motor drives a piston.

#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/slider_joint.h>

#include "../scenes/slider_crank.h"
#include "joints.h"
#include "table.h"
#include "tables.h"

namespace tables {
namespace {

Measurement measure(const scenes::SliderCrankResult& r) {
  const double error = or_infinite(r.finite, r.max_piston_error);
  return {{error, or_infinite(r.finite, r.max_reading_error), or_infinite(r.finite, r.max_gap),
           or_infinite(r.finite, degrees(r.max_crank_error))},
          error,
          r.microseconds_per_step};
}

}  // namespace

void run_slider_crank(Output& out) {
  Table table(out, "slider_crank", "a motor drives a piston at 1 turn/s for 5 s",
              {{"piston", "m", "%.1e", "lost"},
               {"reading", "m", "%.1e", "lost"},
               {"max gap", "m", "%.1e", "lost"},
               {"crank", "deg", "%.1e", "lost"}});
  for (const int iterations : {10, 100}) {
    for (const double hz : {60, 120, 240, 480}) {
      scenes::SliderCrankSettings settings;
      settings.dt = 1 / hz;
      settings.iterations = iterations;
      table.compare(
          text("%gHz %dit", hz, iterations),
          {{"stock",
            [&] {
              return measure(
                  scenes::slider_crank<Stock, btPoint2PointConstraint, btSliderConstraint>(
                      settings));
            }},
           {"pintle", [&] {
              return measure(
                  scenes::slider_crank<Ours, pintle::BallJoint, pintle::SliderJoint>(settings));
            }}});
    }
  }
}

}  // namespace tables
