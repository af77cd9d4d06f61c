// A few of the tables' numbers, for the documentation (plugin/docs/benchmarks.md): a row each, with stock's and Pintle's.

#pragma once

#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace tables {

struct Number;

class Brief {
 public:
  struct Row {
    const char *scene, *what;  // in words
    const char *table, *name;  // of the tables: the scene, the case and the quantity
    const char* quantity;
    const char* unit;  // in words
    const char *stock = "stock", *ours = "pintle";
  };
  static const std::vector<Row>& rows();
  // Those that have its numbers, each once.
  static std::vector<std::string> tables();
  // The table's first lines.
  static std::string head();

  void note(const Number& number);
  // False: it cannot be written, or a row has no number.
  bool write(const std::string& path) const;

 private:
  using Key = std::tuple<std::string, std::string, std::string, std::string>;
  std::string value(const Row& row, const char* who) const;

  std::map<Key, double> numbers_;  // of table, case, contender and quantity
};

}  // namespace tables
