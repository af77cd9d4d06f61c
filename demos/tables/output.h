// Where the numbers go: every one as a line of a CSV file, and as an object of a JSON file.

#pragma once

#include <algorithm>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "../json_array.h"
#include "../progress.h"
#include "brief.h"

namespace tables {

struct Number {
  std::string scene, name, who, quantity, unit;
  double value;
};

// The long form, with a line a number, in either file that is open.
class NumberFiles {
 public:
  // False: the file cannot be written.
  bool open_csv(const std::string& path);
  bool open_json(const std::string& path) { return json_.open(path, digits); }
  void write(const Number& number);
  // False: something was not written.
  bool close();

 private:
  static constexpr int digits = 9;

  std::ofstream csv_;
  JsonArray json_;
};

// What the tables hold, found without a run.
struct Plan {
  std::vector<std::string> titles;  // a table each
  std::set<std::string> contenders;
  int cases = 0;
};

struct Output {
  NumberFiles files;
  Brief brief;
  std::vector<std::string> contenders;  // empty: all
  Plan* plan = nullptr;                 // set: nothing is run, and nothing printed
  Progress* progress = nullptr;
  bool once = false;  // without the runs that find the best times, and that numbers repeat
  bool all_repeated = true;

  bool shows(const std::string& who) const {
    return contenders.empty() ||
           std::find(contenders.begin(), contenders.end(), who) != contenders.end();
  }
};

}  // namespace tables
