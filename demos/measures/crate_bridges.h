// What joints give to crates that are dropped on bridges.

#pragma once

#include "../engines/bullet.h"

namespace measures {

struct CrateBridgesResult {
  double fed = 0;    // J: the sum of what joints give, over the steps in which they do
  double gains = 0;  // J: the sum of what each step gains of mechanical energy, contacts and all
  double largest_gain = 0;  // J, in a step
  double end_kinetic = 0;   // J
  double mean_gap = 0;      // m, over joints and steps
  double max_gap = 0;       // m
  int thrown_off = 0;       // crates: fallen below their bridge, or past an edge of it
};
CrateBridgesResult run_crate_bridges(engines::MakeJoint make_joint, int iterations, double hz,
                                     double seconds, int count);

}  // namespace measures
