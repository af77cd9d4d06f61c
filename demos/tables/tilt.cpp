// A leaning cube is pushed against the limit of an angle.

#include "catalog_scenes.h"
#include "tables.h"

namespace tables {
namespace {

Measurement measure_tilt(const scenes::Scene& scene, engines::MakeJoint make_joint) {
  const measures::Outcome outcome =
      measures::run(scene, *engines::make_bullet(scene, 10, make_joint), 1. / 60);
  const double beyond = outcome[scenes::Error::overshoot];
  return {{degrees(beyond)}, beyond, microseconds_per_step(outcome)};
}

}  // namespace

void run_tilt(Output& out) {
  Table table(out, "tilt", "a leaning cube is pushed against the limit of an angle",
              {{"beyond", "deg", "%.2e", "lost"}});
  for (const double angle : {0, 20, 60, 80}) {
    const scenes::Scene scene = scenes::tilt_scene(radians(angle));
    table.compare(
        text("%g deg 60Hz", angle),
        {{"doc.", [&] { return measure_tilt(scene, engines::make_document_joint); }},
         {"pintle", [&] { return measure_tilt(scene, engines::make_conditioned_joint); }}});
  }
}

}  // namespace tables
