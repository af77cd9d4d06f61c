// Where the numbers go: every one as a line of a CSV file, and as an object of a JSON file.

#pragma once

#include <algorithm>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "../progress.h"
#include "brief.h"

namespace tables {

struct Number {
  std::string scene, name, who, quantity, unit;
  double value;
};

// The long form, with a line a number.
class NumberFile {
 public:
  enum class Form { csv, json };

  // False: the file cannot be written.
  bool open(const std::string& path, Form form);
  void write(const Number& number);
  // False: something was not written.
  bool close();

 private:
  std::ofstream file_;
  Form form_ = Form::csv;
  bool is_first_ = true;
};

// What the tables hold, found without a run.
struct Plan {
  std::vector<std::string> titles;  // a table each
  std::set<std::string> contenders;
  int cases = 0;
};

struct Output {
  NumberFile csv, json;
  Brief brief;
  std::vector<std::string> contenders;  // empty: all
  Plan* plan = nullptr;                 // set: nothing is run, and nothing printed
  Progress* progress = nullptr;
  bool all_repeated = true;

  bool shows(const std::string& who) const {
    return contenders.empty() ||
           std::find(contenders.begin(), contenders.end(), who) != contenders.end();
  }
};

}  // namespace tables
