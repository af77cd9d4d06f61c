// Two boxes whose axes are apart at the start.

#include "joints.h"
#include "recovery.h"
#include "table.h"
#include "tables.h"

namespace tables {

void run_recovery(Output& out) {
  Table table(out, "recovery", "two free boxes, their axes apart at the start",
              {{"steps", "to 1 deg", "%.0f"},
               {"speed", "rad/s", "%.1f"},
               {"end", "deg", "%.1e"},
               {"max gap", "m", "%.2e"}});
  struct Direction {
    const char* name;
    Eigen::Vector3d about;
  };
  const Direction directions[] = {
      {"x", {1, 0, 0}}, {"y", {0, 1, 0}}, {"(0.6 0.8 0)", {0.6, 0.8, 0}}};
  for (const Direction& direction : directions) {
    for (const double angle : {45, 90, 120, 170, 179, 180}) {
      scenes::RecoverySettings settings;
      settings.angle = radians(angle);
      settings.about = direction.about;
      table.compare(text("%g about %s", angle, direction.name),
                    {{"stock", [&] { return measure<Stock>(settings); }},
                     {"pintle", [&] { return measure<Ours>(settings); }},
                     {"doc.", [&] { return measure<Ours>(settings, document); }}});
    }
  }
}

}  // namespace tables
