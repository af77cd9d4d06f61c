// What two boxes measure whose joint is violated at the start.

#pragma once

#include "../scenes/recovery.h"
#include "measurement.h"

namespace tables {

template <class Hinge, class Configure = scenes::AsConstructed>
Measurement measure(const scenes::RecoverySettings& settings, Configure configure = {}) {
  const scenes::RecoveryResult r = scenes::recovery<Hinge>(settings, configure);
  const double steps = or_infinite(r.finite && r.steps >= 0, r.steps);
  return {{steps, r.max_angular_speed, degrees(r.end_axis_angle), r.max_gap},
          steps,
          r.microseconds_per_step};
}

}  // namespace tables
