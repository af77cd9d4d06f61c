#include "table.h"

#include <cmath>
#include <fstream>
#include <sstream>

namespace report {

using scenes::Error;

std::string head() {
  std::string text = "precision,scene,contender,iterations,hz,us_per_step,rows";
  for (int i = 0; i < int(Error::count); ++i)
    text += std::string(",") + name(Error(i)) + "_" + unit(Error(i));
  return text + ",end";
}

std::string line(const Row& row) {
  std::ostringstream text;
  text.precision(9);
  text << row.precision << ',' << row.scene << ',' << row.contender << ',' << row.iterations << ','
       << row.hz << ',' << row.microseconds << ',' << row.rows;
  for (const double error : row.errors) text << ',' << error;
  text << ",.";  // tells a whole line from one that was cut off
  return text.str();
}

std::vector<Row> read(const std::string& path) {
  std::vector<Row> rows;
  std::ifstream file(path);
  for (std::string text; std::getline(file, text);) {
    std::vector<std::string> cells;
    std::istringstream stream(text);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    if (cells.size() != 8 + size_t(Error::count) || cells.back() != ".") continue;
    Row row{cells[0],
            cells[1],
            cells[2],
            std::stoi(cells[3]),
            std::stoi(cells[4]),
            std::stod(cells[5]),
            std::stoi(cells[6])};
    for (size_t i = 0; i < row.errors.size(); ++i) row.errors[i] = std::stod(cells[7 + i]);
    rows.push_back(row);
  }
  return rows;
}

std::map<std::pair<std::string, std::string>, double> read_instructions(const std::string& path) {
  std::map<std::pair<std::string, std::string>, double> counts;
  std::ifstream file(path);
  std::string scene, contender;
  for (double count; file >> scene >> contender >> count;) counts[{scene, contender}] = count;
  return counts;
}

}  // namespace report
