#include "results.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace report {

using scenes::Error;
using scenes::Scene;

double rounding(const std::string& precision) {
  return 8 * (precision == "double" ? std::numeric_limits<double>::epsilon()
                                    : double(std::numeric_limits<float>::epsilon()));
}

std::string number(double value, int digits) {
  char text[32];
  if (!std::isfinite(value)) return "lost";
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

Results::Results(std::vector<Row> rows) : rows_(std::move(rows)) {
  for (const Row& row : rows_) {
    if (std::find(contenders_.begin(), contenders_.end(), row.contender) == contenders_.end())
      contenders_.push_back(row.contender);
  }
}

bool Results::has(const Scene& scene, std::string Row::*field, const std::string& value) const {
  return std::any_of(rows_.begin(), rows_.end(), [&](const Row& row) {
    return row.scene == scene.name && row.*field == value;
  });
}

std::vector<Point> Results::points(const std::string& precision, const Scene& scene, Error error,
                                   const std::string& contender) const {
  std::vector<Point> points;
  for (const Row& row : rows_) {
    if (row.precision != precision || row.scene != scene.name || row.contender != contender)
      continue;
    points.push_back(
        {row.milliseconds_per_second(), std::max(row.errors[size_t(error)], rounding(precision))});
  }
  return points;
}

std::vector<Point> Results::front(const std::string& precision, const Scene& scene, Error error,
                                  const std::string& contender) const {
  return pareto(points(precision, scene, error, contender));
}

double Results::min_error(const Scene& scene, Error error, const std::string& contender,
                          int hz) const {
  double min = HUGE_VAL;
  for (const Row& row : rows_) {
    if (row.scene == scene.name && row.contender == contender && row.hz == hz &&
        row.precision == "double")
      min = std::min(min, row.errors[size_t(error)]);
  }
  return min;
}

}  // namespace report
