// A scene's table: a line for each contender in each case.

#pragma once

#include "measurement.h"
#include "output.h"

namespace tables {

// Prints one scene's table, line by line as the runs end, 80 columns wide. The first contender
// whose name begins with "stock" is the one that all others are compared with.
class Table {
 public:
  Table(Output& out, const std::string& scene, const std::string& title,
        std::vector<Column> columns);

  void compare(const std::string& name, const std::vector<Contender>& contenders);

 private:
  // Runs all contenders again, in turns, for the best time of each.
  void repeat(const std::string& name, const std::vector<Contender>& contenders,
              std::vector<Measurement>& results);

  Output& out_;
  std::string scene_;
  std::vector<Column> columns_;
};

}  // namespace tables
