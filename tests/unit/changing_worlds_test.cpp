// Joints are removed, put back and broken while all runs: nothing is thrown that stock joints, on the same
// solver in the same worlds, do not throw.
#include <gtest/gtest.h>
#include <scenes/changing.h>

#include <algorithm>
#include <cmath>
#include <ostream>

namespace changing_worlds_test {

using scenes::ChangingResult;
using scenes::Kinds;
using scenes::PintleJoints;
using scenes::StockJoints;

struct Worlds {
  Kinds kinds;
  unsigned first_seed, count;
};
std::ostream& operator<<(std::ostream& out, const Worlds& worlds) {
  return out << "seeds from " << worlds.first_seed << ", " << worlds.count;
}

class ChangingWorlds : public testing::TestWithParam<Worlds> {};

TEST_P(ChangingWorlds, ThrowNothingFasterThanStocks) {
  const double fast = 100, too_fast = 1000;  // m/s
  struct Count {
    int fast = 0, too_fast = 0;
    double worst = 0;
    void add(const ChangingResult& result, double from, double too) {
      fast += result.speed > from ? 1 : 0;
      too_fast += result.speed > too ? 1 : 0;
      worst = std::max(worst, result.speed);
    }
  } stock, pintle;
  int changes = 0;
  for (unsigned i = 0; i < GetParam().count; ++i) {
    const unsigned seed = GetParam().first_seed + i;
    stock.add(scenes::run_changing<StockJoints>(seed, GetParam().kinds), fast, too_fast);
    const ChangingResult result = scenes::run_changing<PintleJoints>(seed, GetParam().kinds);
    pintle.add(result, fast, too_fast);
    changes += result.changes;
  }
  EXPECT_GT(changes, 1000);
  EXPECT_LE(pintle.too_fast, stock.too_fast)
      << "worlds with a body of over 1000 m/s; the fastest " << pintle.worst;
  // A world is a matter of chance: a count may be off by its deviation.
  EXPECT_LE(pintle.fast, stock.fast + std::sqrt(stock.fast)) << "worlds with one of over 100 m/s";
}

INSTANTIATE_TEST_SUITE_P(Of, ChangingWorlds,
                         testing::Values(Worlds{Kinds::common, 0, 41}, Worlds{Kinds::all, 71, 41}),
                         [](const auto& of) {
                           return of.param.kinds == Kinds::common ? "JointsThatBothHave"
                                                                  : "AllOfPintlesJoints";
                         });

}  // namespace changing_worlds_test
