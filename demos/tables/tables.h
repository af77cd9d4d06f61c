// The tables, each in the file of its name. A new one is two lines here.

#pragma once

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
  const char* name;
  void (*run)(Output&);
};

// In the order in which they are printed.
constexpr Entry all_tables[] = {
    {"chain", run_chain},       {"recovery", run_recovery},
    {"pendulum", run_pendulum}, {"valve", run_valve},
    {"door", run_door},         {"rope", run_rope},
    {"wedge", run_wedge},       {"slider_crank", run_slider_crank},
    {"shoulder", run_shoulder}, {"drive_shaft", run_drive_shaft},
    {"bounce", run_bounce},     {"tilt", run_tilt},
    {"unstable", run_unstable},
};

}  // namespace tables
