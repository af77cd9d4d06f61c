// A chain of hinges falls.

#include "../scenes/chain.h"
#include "joints.h"
#include "table.h"
#include "tables.h"

namespace tables {
namespace {

template <class Hinge, class Configure = scenes::AsConstructed>
Measurement measure(const scenes::ChainSettings& settings, Configure configure = {}) {
  const scenes::ChainResult r = scenes::chain<Hinge>(settings, configure);
  const double mean_gap = or_infinite(r.finite, r.mean_gap);
  return {
      {mean_gap, or_infinite(r.finite, r.max_gap), or_infinite(r.finite, degrees(r.max_axis_angle)),
       or_infinite(r.finite, r.end_energy_error)},
      mean_gap,
      r.microseconds_per_step};
}

}  // namespace

void run_chain(Output& out) {
  Table table(out, "chain", "fall for 5 s (number of links x mass of the last, iterations)",
              {{"mean gap", "m", "%.2e", "lost"},
               {"max gap", "m", "%.2e", "lost"},
               {"axes", "deg", "%.2f", "lost"},
               {"energy", "mgN^2/2", "%+.1e", "lost"}});
  struct Case {
    int links;
    double ratio, hz;
    int iterations;
  };
  std::vector<Case> cases;
  for (const double ratio : {1, 10, 100}) {
    for (const int iterations : {4, 10, 20, 50, 100}) cases.push_back({10, ratio, 60, iterations});
  }
  cases.push_back({10, 1e4, 60, 10});
  cases.push_back({10, 1e4, 1000, 10});
  cases.push_back({100, 1000, 240, 10});
  for (const Case& c : cases) {
    scenes::ChainSettings settings;
    settings.links = c.links;
    settings.ratio = c.ratio;
    settings.dt = 1 / c.hz;
    settings.iterations = c.iterations;
    table.compare(text("%dx%g %gHz %dit", c.links, c.ratio, c.hz, c.iterations),
                  {{"stock", [&] { return measure<Stock>(settings); }},
                   {"pintle", [&] { return measure<Ours>(settings); }},
                   {"plain", [&] { return measure<Ours>(settings, plain_rows); }}});
  }
}

}  // namespace tables
