// Joints that start wrong feed no more energy than stock's on Bullet's solver. Where Bullet has no such joint, the
// comparison is with its stand-in (scenes/families.h).
#include <gtest/gtest.h>
#include <scenes/starts.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "solver_of_tests.h"

namespace starts_test {

using scenes::Kind;
using scenes::PintleJoints;
using scenes::Start;
using scenes::StartResult;
using scenes::StockJoints;

class TutorialBridge : public testing::TestWithParam<int> {};

TEST_P(TutorialBridge, GainsNoMoreEnergyThanStock) {
  scenes::PlaygroundSettings settings;
  settings.make_solver = scenes::default_solver();
  settings.iterations = GetParam();
  const StartResult stock =
                        scenes::run_start(*scenes::make_tutorial_bridge<StockJoints>(settings), 5),
                    pintle =
                        scenes::run_start(*scenes::make_tutorial_bridge<PintleJoints>(settings), 5);
  EXPECT_LE(pintle.energy, stock.energy) << "J";
  EXPECT_LE(pintle.gap, stock.gap) << "m, at the end";
}

INSTANTIATE_TEST_SUITE_P(Iterations, TutorialBridge, testing::Values(10, 100));

class Starts : public testing::TestWithParam<std::tuple<Kind, Start>> {};

// One start is a matter of chance: the sum over some, and the worst of them.
TEST_P(Starts, GainNoMoreEnergyThanStock) {
  const auto [kind, start] = GetParam();
  scenes::PlaygroundSettings settings;
  settings.make_solver = scenes::default_solver();
  double stock_sum = 0, stock_worst = 0, pintle_sum = 0, pintle_worst = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    const double stock = scenes::run_start(
                             *scenes::make_start<StockJoints>(kind, start, seed, settings), 2)
                             .energy,
                 pintle = scenes::run_start(
                              *scenes::make_start<PintleJoints>(kind, start, seed, settings), 2)
                              .energy;
    stock_sum += stock;
    pintle_sum += pintle;
    stock_worst = std::max(stock_worst, stock);
    pintle_worst = std::max(pintle_worst, pintle);
  }
  const double rounding = 1e-6;  // J
  EXPECT_LE(pintle_sum, stock_sum + rounding) << "J, of all starts";
  EXPECT_LE(pintle_worst, stock_worst + rounding) << "J, of the worst";
}

INSTANTIATE_TEST_SUITE_P(
    All, Starts,
    testing::Combine(testing::Values(Kind::ball, Kind::hinge, Kind::slider, Kind::fixed,
                                     Kind::cone_twist, Kind::universal, Kind::constant_velocity,
                                     Kind::wedge, Kind::angle, Kind::distance, Kind::contact),
                     testing::Values(Start::overlapping, Start::apart, Start::turned, Start::all)),
    [](const auto& of) {
      std::string text = std::string(scenes::kind_name(std::get<0>(of.param))) + "_" +
                         scenes::start_name(std::get<1>(of.param));
      std::replace_if(
          text.begin(), text.end(), [](char c) { return c == ' ' || c == '-'; }, '_');
      return text;
    });

}  // namespace starts_test
