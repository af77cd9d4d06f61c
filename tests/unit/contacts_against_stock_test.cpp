// Pintle's joints beside stock joints among contacts, on Bullet's solver, in the same scenes: joints are no
// further apart, and they feed no energy to what touches them.
#include <gtest/gtest.h>
#include <scenes/frame_scenes.h>

#include <functional>
#include <ostream>
#include <string>

#include "solver_of_tests.h"

namespace contacts_against_stock_test {

using scenes::PintleJoints;
using scenes::Playground;
using scenes::PlaygroundPtr;
using scenes::PlaygroundSettings;
using scenes::StockJoints;

// --- bridges with crates -------------------------------------------------------------------------

struct Rate {
  int iterations;
  double hz, seconds;
  int bridges;
};
std::ostream& operator<<(std::ostream& out, const Rate& rate) {
  return out << rate.iterations << " iterations, " << rate.hz << " Hz";
}

class BridgesWithCrates : public testing::TestWithParam<Rate> {};

template <class Family>
scenes::BridgesResult bridges(const Rate& rate) {
  return scenes::run_bridges<Family>(rate.iterations, rate.hz, rate.seconds, rate.bridges);
}

// What a step gains in all is contacts' doing, too, and Bullet's integration of what swings: of bridges that stock joints
// have brought to rest less than of those that go on.
TEST_P(BridgesWithCrates, FeedCratesNoMoreThanStockJointsAndThrowNothingOff) {
  PINTLE_SKIP_ON_EXACT_SOLVER("its own tests see to it");
  const scenes::BridgesResult stock = bridges<StockJoints>(GetParam()),
                              pintle = bridges<PintleJoints>(GetParam());
  EXPECT_LE(pintle.fed, stock.fed) << "J, the sum of what joints give";
  EXPECT_LE(pintle.thrown_off, stock.thrown_off) << "crates";
  EXPECT_LE(pintle.mean_gap, stock.mean_gap) << "m";
}

INSTANTIATE_TEST_SUITE_P(Rates, BridgesWithCrates,
                         testing::Values(Rate{10, 60, 6, 6}, Rate{10, 120, 4, 4},
                                         Rate{10, 240, 3, 2}, Rate{100, 60, 6, 15},
                                         Rate{100, 120, 3, 3}, Rate{100, 240, 3, 2}),
                         [](const auto& of) {
                           return std::to_string(of.param.iterations) + "Iterations" +
                                  std::to_string(int(of.param.hz)) + "Hz";
                         });

// --- a frame's scenes ----------------------------------------------------------------------------

using Make = std::function<PlaygroundPtr(const PlaygroundSettings&)>;

struct FrameScene {
  const char* name;
  Make stock, pintle;
};
std::ostream& operator<<(std::ostream& out, const FrameScene& scene) { return out << scene.name; }

class FrameScenes : public testing::TestWithParam<FrameScene> {};

// The mean over joints and steps.
double meanGap(const PlaygroundPtr& world) {
  const int steps = 120;
  double mean = 0;
  for (int i = 0; i < steps; ++i) {
    world->step(1. / 60);
    mean += world->gap().mean / steps;
  }
  return mean;
}

TEST_P(FrameScenes, JointsAreNoFurtherApartThanStocks) {
  PINTLE_SKIP_ON_EXACT_SOLVER("its own tests see to it");
  const PlaygroundSettings settings;
  const double stock = meanGap(GetParam().stock(settings)),
               pintle = meanGap(GetParam().pintle(settings));
  EXPECT_GT(stock, 0);
  EXPECT_LE(pintle, stock);
}

INSTANTIATE_TEST_SUITE_P(
    All, FrameScenes,
    testing::Values(
        FrameScene{"Ragdolls", [](auto& s) { return scenes::make_ragdolls<StockJoints>(s, 5); },
                   [](auto& s) { return scenes::make_ragdolls<PintleJoints>(s, 5); }},
        FrameScene{"Doors", [](auto& s) { return scenes::make_doors<StockJoints>(s, 12); },
                   [](auto& s) { return scenes::make_doors<PintleJoints>(s, 12); }},
        FrameScene{"Vehicles", [](auto& s) { return scenes::make_vehicles<StockJoints>(s, 4); },
                   [](auto& s) { return scenes::make_vehicles<PintleJoints>(s, 4); }},
        FrameScene{"Net", [](auto& s) { return scenes::make_net<StockJoints>(s, 8); },
                   [](auto& s) { return scenes::make_net<PintleJoints>(s, 8); }}),
    [](const auto& of) { return std::string(of.param.name); });

}  // namespace contacts_against_stock_test
