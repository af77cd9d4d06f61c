// What a table compares: contenders by name, and what a run of each measured.

#pragma once

#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "../scenes/angles.h"

namespace tables {

using scenes::degrees;
using scenes::radians;

// What one run measured. `values` go with the table's columns; infinity: never reached, or lost;
// NaN: there is no such quantity.
struct Measurement {
  std::vector<double> values;
  double error = 0;                  // what the ratio compares
  double microseconds_per_step = 0;  // 0: no time to compare
};

struct Contender {
  std::string who;
  std::function<Measurement()> run;
};

struct Column {
  std::string quantity;
  std::string unit;
  const char* format;  // of one double, at most 9 wide
  const char* infinite = "never";
};

template <class... Arguments>
std::string text(const char* format, Arguments... arguments) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, arguments...);
  return buffer;
}

inline double or_infinite(bool reached, double value) { return reached ? value : HUGE_VAL; }

}  // namespace tables
