// A body under the mouse, as Bullet's examples drag it: Pintle's ball joint beside stock's, on Bullet's solver.
#include <gtest/gtest.h>
#include <scenes/dragging.h>

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

class Dragging : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override { PINTLE_SKIP_ON_EXACT_SOLVER("its own tests see to it"); }
};

TEST_P(Dragging, LagsNoMoreThanStock) {
  const DragResult stock = scenes::drag_free<StockJoints>(GetParam()),
                   pintle = scenes::drag_free<PintleJoints>(GetParam());
  // What has been jerked to hundreds of rad/s is a matter of chance.
  const double chance = stock.spin > 100 ? 0.02 * stock.lag : 0;
  EXPECT_LE(pintle.lag, stock.lag + 0.05 + chance) << "m";
}

// A pull at the centre has no lever.
TEST_P(Dragging, SpinsNothingThatIsPulledAtItsCentre) {
  if (!GetParam().centre) return;
  const DragResult stock = scenes::drag_free<StockJoints>(GetParam()),
                   pintle = scenes::drag_free<PintleJoints>(GetParam());
  EXPECT_LE(pintle.spin, stock.spin + 0.5) << "rad/s";
}

TEST_P(Dragging, DoesNotPassTheLimitsOfWhatIsDragged) {
  const DragResult stock = scenes::drag_hung<StockJoints>(GetParam()),
                   pintle = scenes::drag_hung<PintleJoints>(GetParam());
  // No further than the step goes in which the limit is reached, of which nothing tells beforehand.
  EXPECT_LE(pintle.past, std::max(stock.past, pintle.spin / 60) + 5e-3) << "rad";
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
