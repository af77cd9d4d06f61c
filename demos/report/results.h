// What was measured, as the report asks for it: errors and times of a contender in a scene, and its front.

#pragma once

#include <string>
#include <vector>

#include "../scenes/scene.h"
#include "pareto.h"
#include "table.h"

namespace report {

const std::string precisions[] = {"single", "double"};

// Below this an error is nothing but rounding, and ratios of it mean nothing: 8 epsilon.
double rounding(const std::string& precision);

// "lost" if it is not finite.
std::string number(double value, int digits = 2);

class Results {
 public:
  explicit Results(std::vector<Row> rows);

  const std::vector<Row>& rows() const { return rows_; }
  const std::vector<std::string>& contenders() const { return contenders_; }

  // Any row of the scene.
  bool has(const scenes::Scene& scene, std::string Row::*field, const std::string& value) const;
  std::vector<Point> points(const std::string& precision, const scenes::Scene& scene,
                            scenes::Error error, const std::string& contender) const;
  std::vector<Point> front(const std::string& precision, const scenes::Scene& scene,
                           scenes::Error error, const std::string& contender) const;
  // Over all iterations, in double precision.
  double min_error(const scenes::Scene& scene, scenes::Error error, const std::string& contender,
                   int hz) const;

 private:
  std::vector<Row> rows_;
  std::vector<std::string> contenders_;
};

}  // namespace report
