// The front of what nothing else beats: no point is both faster and better.

#pragma once

#include <vector>

namespace report {

struct Point {
  double time, error;
};

// Of the points, by rising time and falling error. What is not finite is on no front.
std::vector<Point> pareto(std::vector<Point> points);

// The least error within a time, the least time for an error; infinity: there is none. Between two
// points iterations and step can be chosen in between: a straight line on logarithmic axes.
double error_at(const std::vector<Point>& front, double time);
double time_at(const std::vector<Point>& front, double error);

struct Ratio {
  double mean = 0;          // geometric, over the range that both fronts share
  double min = 0, max = 0;  // in it
  double share = 0;         // the part of the range where ours has a value at all
};

// Ours over stock's, of errors above 0. At equal run time: over the times from where both have begun
// to the end of the longer front.
Ratio error_ratio(const std::vector<Point>& ours, const std::vector<Point>& stock);
// At equal error: over stock's errors, from its worst to its best.
Ratio time_ratio(const std::vector<Point>& ours, const std::vector<Point>& stock);

}  // namespace report
