// A box swings on a tilted axis.

#include "../scenes/pendulum.h"
#include "joints.h"
#include "table.h"
#include "tables.h"

namespace tables {
namespace {

template <class Hinge, class Configure = scenes::AsConstructed>
Measurement measure(const scenes::PendulumSettings& settings, Configure configure = {}) {
  const scenes::PendulumResult r = scenes::pendulum<Hinge>(settings, configure);
  const double period_error = or_infinite(r.period > 0, r.period_error);
  return {{period_error, r.max_gap, degrees(r.max_axis_angle), r.max_energy_error},
          std::abs(period_error),
          r.microseconds_per_step};
}

}  // namespace

void run_pendulum(Output& out) {
  Table table(out, "pendulum", "one link swings for 20 s on an axis tilted by 30 deg",
              {{"period", "relative", "%+.2e"},
               {"max gap", "m", "%.2e"},
               {"axes", "deg", "%.1e"},
               {"energy", "relative", "%.2e"}});
  for (const double hz : {60, 240, 1000}) {
    for (const double amplitude : {10, 120, 170}) {
      scenes::PendulumSettings settings;
      settings.amplitude = radians(amplitude);
      settings.dt = 1 / hz;
      table.compare(text("from %g deg %gHz", amplitude, hz),
                    {{"stock", [&] { return measure<Stock>(settings); }},
                     {"pintle", [&] { return measure<Ours>(settings); }},
                     {"doc.", [&] { return measure<Ours>(settings, document); }}});
    }
  }
}

}  // namespace tables
