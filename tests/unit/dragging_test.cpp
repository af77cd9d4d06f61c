// A body under the mouse, as Bullet's examples drag it: Pintle's ball joint beside stock's.
#include <gtest/gtest.h>
#include <scenes/dragging.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>

#include "solver_of_tests.h"

namespace dragging_test {

using scenes::DragCase;
using scenes::DragResult;
using scenes::PintleJoints;
using scenes::StockJoints;

struct Case : DragCase {};
std::ostream& operator<<(std::ostream& out, const Case& drag) { return out << name(drag); }

class Dragging : public testing::TestWithParam<Case> {};

struct Lag {
  double mean = 0, variance_of_mean = 0;  // m
};

// What turns by more than pi/4 a step, which is more than Bullet turns a body by, goes where chance takes it: its lag is
// the mean of nine bodies whose masses differ by a thousandth at most.
template <class Joints>
Lag lag(const DragCase& drag, bool is_chance) {
  constexpr int to_each_side = 4;
  const int n = is_chance ? to_each_side : 0, count = 2 * n + 1;
  Lag lag;
  double squares = 0;
  for (int i = -n; i <= n; ++i) {
    DragCase other = drag;
    other.mass *= 1 + 1e-3 * i / to_each_side;
    const double one = scenes::drag_free<Joints>(other).lag;
    lag.mean += one / count;
    squares += one * one / count;
  }
  lag.variance_of_mean = std::max(0., squares - lag.mean * lag.mean) / count;
  return lag;
}

TEST_P(Dragging, LagsNoMoreThanStock) {
  const double spin = scenes::drag_free<StockJoints>(GetParam()).spin;
  const bool is_chance = spin > 3.14159265 / 4 * 60;
  const Lag stock = lag<StockJoints>(GetParam(), is_chance),
            pintle = lag<PintleJoints>(GetParam(), is_chance);
  const double chance = 2 * std::sqrt(stock.variance_of_mean + pintle.variance_of_mean);
  EXPECT_LE(pintle.mean, stock.mean + 0.05 + chance) << "m";
}

// A pull at the centre has no lever.
TEST_P(Dragging, SpinsNothingThatIsPulledAtItsCentre) {
  if (!GetParam().centre) return;
  const DragResult stock = scenes::drag_free<StockJoints>(GetParam()),
                   pintle = scenes::drag_free<PintleJoints>(GetParam());
  EXPECT_LE(pintle.spin, stock.spin + 0.5) << "rad/s";
}

TEST_P(Dragging, DoesNotPassTheLimitsOfWhatIsDragged) {
  if (!GetParam().clamp)
    PINTLE_SKIP_ON_EXACT_SOLVER("a drag of any force and a limit contradict each other");
  const DragResult stock = scenes::drag_hung<StockJoints>(GetParam()),
                   pintle = scenes::drag_hung<PintleJoints>(GetParam());
  // No further than the step goes in which the limit is reached, of which nothing tells beforehand.
  EXPECT_LE(pintle.past, std::max(stock.past, pintle.spin / 60) + 2e-2) << "rad";
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const DragCase& drag : scenes::drag_cases()) all.push_back({drag});
  return all;
}

INSTANTIATE_TEST_SUITE_P(All, Dragging, testing::ValuesIn(cases()), [](const auto& of) {
  std::string text;
  for (const char c : name(of.param))
    if (std::isalnum(static_cast<unsigned char>(c)))
      text += c;
    else if (c == '.')
      text += 'p';
  return text;
});

}  // namespace dragging_test
