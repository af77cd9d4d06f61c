#include "pareto.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace report {

std::vector<Point> pareto(std::vector<Point> points) {
  std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) {
    return a.time < b.time || (a.time == b.time && a.error < b.error);
  });
  std::vector<Point> front;
  for (const Point& point : points) {
    if (!std::isfinite(point.error)) continue;
    if (front.empty() || point.error < front.back().error) front.push_back(point);
  }
  return front;
}

namespace {

// y at x on the straight line through two points, all logarithmic.
double between(double x_0, double y_0, double x_1, double y_1, double x) {
  return y_0 * std::pow(y_1 / y_0, std::log(x / x_0) / std::log(x_1 / x_0));
}

}  // namespace

double error_at(const std::vector<Point>& front, double time) {
  if (front.empty() || time < front.front().time) return HUGE_VAL;
  for (size_t i = 1; i < front.size(); ++i) {
    const Point &before = front[i - 1], &after = front[i];
    if (time < after.time) return between(before.time, before.error, after.time, after.error, time);
  }
  return front.back().error;
}

double time_at(const std::vector<Point>& front, double error) {
  if (front.empty() || error < front.back().error) return HUGE_VAL;
  for (size_t i = front.size() - 1; i > 0; --i) {
    const Point &before = front[i - 1], &after = front[i];
    if (error < before.error)
      return between(after.error, after.time, before.error, before.time, error);
  }
  return front.front().time;
}

namespace {

// Over a range in equal factors, of the ratios that are finite.
Ratio ratio_over(double low, double high, const std::function<double(double)>& ratio) {
  constexpr int samples = 200;
  Ratio result;
  result.min = HUGE_VAL;
  double sum = 0;
  int finite = 0;
  for (int i = 0; i < samples; ++i) {
    const double at = low * std::pow(high / low, (i + 0.5) / samples), value = ratio(at);
    if (!std::isfinite(value)) continue;
    ++finite;
    sum += std::log(value);
    result.min = std::min(result.min, value);
    result.max = std::max(result.max, value);
  }
  result.share = double(finite) / samples;
  result.mean = finite > 0 ? std::exp(sum / finite) : HUGE_VAL;
  return result;
}

}  // namespace

Ratio error_ratio(const std::vector<Point>& ours, const std::vector<Point>& stock) {
  if (ours.empty() || stock.empty()) return {HUGE_VAL, HUGE_VAL, HUGE_VAL, 0};
  const double begin = std::max(ours.front().time, stock.front().time);
  const double end = std::max({ours.back().time, stock.back().time, begin});
  return ratio_over(begin, end,
                    [&](double time) { return error_at(ours, time) / error_at(stock, time); });
}

Ratio time_ratio(const std::vector<Point>& ours, const std::vector<Point>& stock) {
  if (ours.empty() || stock.empty()) return {HUGE_VAL, HUGE_VAL, HUGE_VAL, 0};
  return ratio_over(stock.back().error, stock.front().error, [&](double error) {
    // The end of the range is one of stock's errors, but for rounding.
    return time_at(ours, error) / time_at(stock, std::max(error, stock.back().error));
  });
}

}  // namespace report
