// What becomes of a crowd: how its joints hold, how deep its contacts are, and where it ends.

#pragma once

#include "../engines/engine.h"

namespace measures {

struct CrowdResult {
  double mean_gap = 0, max_gap = 0;  // m: of the worst joint, over the steps
  double mean_penetration = 0;       // m: of the deepest contact; other engines than Bullet's: 0
  double end_kinetic = 0;            // J: what has not come to rest
  double lowest = 0;                 // m: of any centre, at the end
  double travel = 0;                 // m: of the scene's probe, along its way
  bool finite = true;
  int joints = 0;
  double microseconds_per_step = 0;  // by the clock: does not repeat
};
CrowdResult run_crowd(const scenes::Scene& scene, engines::Engine& engine, double dt = 1. / 60);

}  // namespace measures
