// A shaft turns another at a bend.

#include "../scenes/drive_shaft.h"
#include "table.h"
#include "tables.h"

namespace tables {
namespace {

template <class Joint>
Measurement measure(const scenes::DriveShaftSettings& settings) {
  const scenes::DriveShaftResult r = scenes::drive_shaft<Joint>(settings);
  constexpr bool constant = std::is_same_v<Joint, pintle::ConstantVelocityJoint>;
  const double error = or_infinite(r.finite, constant ? r.velocity_error : r.universal_error);
  return {{r.min, r.max, r.ripple, degrees(error)}, error, r.microseconds_per_step};
}

}  // namespace

void run_drive_shaft(Output& out) {
  Table table(out, "drive_shaft",
              "a shaft turns another at a bend (ideal of a universal joint: ripple)",
              {{"least", "out/in", "%.5f"},
               {"most", "out/in", "%.5f"},
               {"ripple", "out/in", "%.2e"},
               {"error", "deg", "%.1e", "lost"}});
  struct Speed {
    double rpm, hz;
  };
  for (const Speed& speed : {Speed{20, 60}, {300, 60}, {1000, 240}}) {
    for (const double bend : {5, 20, 40, 60}) {
      scenes::DriveShaftSettings settings;
      settings.bend = radians(bend);
      settings.rpm = speed.rpm;
      settings.dt = 1 / speed.hz;
      table.compare(
          text("%g deg %grpm %gHz", bend, speed.rpm, speed.hz),
          {{"ideal u.",
            [&] {
              const double c = std::cos(settings.bend);
              return Measurement{{c, 1 / c, (1 / c - c) / 2, 0}};
            }},
           {"stock u.", [&] { return measure<btUniversalConstraint>(settings); }},
           {"pintle u", [&] { return measure<pintle::UniversalJoint>(settings); }},
           {"pintle c", [&] { return measure<pintle::ConstantVelocityJoint>(settings); }}});
    }
  }
}

}  // namespace tables
