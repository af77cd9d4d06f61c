// Any scene of the catalog: what its joints err by.

#include <algorithm>

#include "catalog_scenes.h"
#include "tables.h"

namespace tables {
namespace {

void run_errors(const scenes::Scene& scene, Output& out) {
  std::vector<Column> columns;
  for (const scenes::Error error : scene.errors) {
    if (error == scenes::Error::trajectory)
      columns.push_back({"off path", unit(error), "%.3g"});
    else if (error == scenes::Error::overshoot)  // of angles, and of ways
      columns.push_back({"beyond", "rad or m", "%.3g"});
    else
      columns.push_back({name(error), unit(error), "%.3g"});
  }
  Table table(out, scene.name, scene.title, columns);
  std::vector<Contender> contenders;
  for (const char* who : {"stock", "pintle", "exact"}) {
    const engines::Contender& contender = *engines::find_contender(who);
    if (!contender.can_express(scene)) continue;  // Bullet has no joint for some
    const auto run = [&scene, &contender] {
      const auto engine = contender.make(scene, 10);
      const measures::Outcome outcome = measures::run(scene, *engine, 1. / 60);
      Measurement result;
      for (const scenes::Error error : scene.errors)
        result.values.push_back(outcome.finite ? outcome[error] : HUGE_VAL);
      result.error = result.values.front();
      result.microseconds_per_step = microseconds_per_step(outcome);
      return result;
    };
    contenders.push_back({who, run});
  }
  table.compare("60Hz", contenders);
}

}  // namespace

std::vector<Entry> tables_of_errors() {
  const std::vector<Entry> others = tables_of_their_own();
  std::vector<Entry> entries;
  for (const scenes::Scene& scene : scenes::catalog()) {
    const auto has_its_own = [&](const Entry& of) { return of.name == scene.name; };
    if (std::none_of(others.begin(), others.end(), has_its_own))
      entries.push_back({scene.name, [scene](Output& out) { run_errors(scene, out); }});
  }
  return entries;
}

}  // namespace tables
