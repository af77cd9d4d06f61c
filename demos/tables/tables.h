// The tables, each in the file of its name. A new one is two lines here. Other scenes of the catalog have one by themselves.

#pragma once

#include <functional>
#include <string>
#include <vector>

#include "output.h"

namespace tables {

void run_chain(Output& out);
void run_recovery(Output& out);
void run_pendulum(Output& out);
void run_valve(Output& out);
void run_door(Output& out);
void run_rope(Output& out);
void run_wedge(Output& out);
void run_slider_crank(Output& out);
void run_shoulder(Output& out);
void run_drive_shaft(Output& out);
void run_bounce(Output& out);
void run_tilt(Output& out);
void run_unstable(Output& out);

struct Entry {
  std::string name;
  std::function<void(Output&)> run;
};

// In the order in which they are printed.
inline std::vector<Entry> tables_of_their_own() {
  return {
      {"chain", run_chain},       {"recovery", run_recovery},
      {"pendulum", run_pendulum}, {"valve", run_valve},
      {"door", run_door},         {"rope", run_rope},
      {"wedge", run_wedge},       {"slider_crank", run_slider_crank},
      {"shoulder", run_shoulder}, {"drive_shaft", run_drive_shaft},
      {"bounce", run_bounce},     {"tilt", run_tilt},
      {"unstable", run_unstable},
  };
}

// Of the catalog's other scenes: their errors.
std::vector<Entry> tables_of_errors();

}  // namespace tables
