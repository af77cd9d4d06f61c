// Joints are removed, put back and broken while all runs: nothing is thrown that stock joints, on the same
// solver in the same worlds, do not throw.
#include <gtest/gtest.h>
#include <scenes/changing.h>

#include <algorithm>
#include <ostream>

#include "solver_of_tests.h"

namespace changing_worlds_test {

using scenes::ChangingResult;
using scenes::Kinds;
using scenes::PintleJoints;
using scenes::StockJoints;

class ChangingWorlds : public testing::TestWithParam<Kinds> {};

TEST_P(ChangingWorlds, ThrowNothingFasterThanStocks) {
  PINTLE_SKIP_ON_EXACT_SOLVER("its own tests see to it");
  double stock_worst = 0, pintle_worst = 0;
  unsigned worst_seed = 0;
  int stock_fast = 0, pintle_fast = 0, changes = 0;
  const double fast = 100;  // m/s
  for (unsigned seed = 0; seed < 45; ++seed) {
    const ChangingResult stock = scenes::run_changing<StockJoints>(seed, GetParam()),
                         pintle = scenes::run_changing<PintleJoints>(seed, GetParam());
    changes += pintle.changes;
    stock_fast += stock.speed > fast ? 1 : 0;
    pintle_fast += pintle.speed > fast ? 1 : 0;
    stock_worst = std::max(stock_worst, stock.speed);
    if (pintle.speed > pintle_worst) worst_seed = seed;
    pintle_worst = std::max(pintle_worst, pintle.speed);
  }
  EXPECT_GT(changes, 1000);
  EXPECT_LE(pintle_worst, stock_worst) << "m/s, seed " << worst_seed;
  EXPECT_LE(pintle_fast, stock_fast) << "worlds with a body of over " << fast << " m/s";
}

INSTANTIATE_TEST_SUITE_P(Of, ChangingWorlds, testing::Values(Kinds::common, Kinds::all),
                         [](const auto& of) {
                           return of.param == Kinds::common ? "JointsThatBothHave"
                                                            : "AllOfPintlesJoints";
                         });

}  // namespace changing_worlds_test
