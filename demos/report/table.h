// The report's numbers as a file: a line for each scene, contender, iterations and step.

#pragma once

#include <map>
#include <string>
#include <vector>

#include "../measures/run.h"

namespace report {

struct Row {
  std::string precision, scene, contender;
  int iterations = 0;       // 0: it does not iterate
  int hz = 0;               // steps a second
  double microseconds = 0;  // a step: the median of the repeats
  int rows = 0;             // of the joints
  measures::Errors errors = {};

  double milliseconds_per_second() const { return microseconds * hz / 1000; }
};

// The line of the file's head, and of a row; both without the line's end.
std::string head();
std::string line(const Row& row);
// Lines that are no rows are left out: a head, or what an interrupted run has left.
std::vector<Row> read(const std::string& path);

// Instructions of a step, of (scene, contender); empty if the file is not there.
std::map<std::pair<std::string, std::string>, double> read_instructions(const std::string& path);

}  // namespace report
