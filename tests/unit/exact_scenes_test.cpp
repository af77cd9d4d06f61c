// The figures of ExactJointSolver in the scenes, with its default settings, and with the joints of both.
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/solver/exact_joint_solver.h>

#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <gtest/gtest.h>
#include <scenes/chain.h>
#include <scenes/crowd.h>

namespace {

constexpr bool is_double = sizeof(btScalar) == sizeof(double);

scenes::ChainSettings chain(int links, double ratio, double dt, bool exact = true) {
  scenes::ChainSettings settings;
  settings.links = links;
  settings.ratio = ratio;
  settings.dt = dt;
  if (exact) settings.make_solver = [] { return std::make_unique<pintle::ExactJointSolver>(); };
  return settings;
}

TEST(ExactScenes, ChainsHold) {
  EXPECT_LE(scenes::chain<pintle::QuaternionHinge>(chain(10, 100, 1. / 60)).mean_gap, 1e-4);
  EXPECT_LE(scenes::chain<pintle::QuaternionHinge>(chain(10, 1, 1. / 60)).mean_gap, 1e-3);
  // In single precision a position of 100 m has digits of 8e-6 m.
  EXPECT_LE(scenes::chain<pintle::QuaternionHinge>(chain(100, 1000, 1. / 240)).mean_gap,
            is_double ? 1e-6 : 1e-5);
}

TEST(ExactScenes, ChainsOfBulletsHingesHold) {
  for (const double ratio : {1., 100.}) {
    const auto ours = scenes::chain<btHingeConstraint>(chain(10, ratio, 1. / 60));
    const auto stock = scenes::chain<btHingeConstraint>(chain(10, ratio, 1. / 60, false));
    EXPECT_LT(ours.mean_gap, stock.mean_gap / 10) << ratio;
  }
}

class Extreme : public testing::TestWithParam<double> {};

TEST_P(Extreme, ChainHolds) {
  const double ratio = GetParam();
  const auto r = scenes::chain<pintle::QuaternionHinge>(chain(10, ratio, 1. / 60));
  ASSERT_TRUE(r.finite);
  EXPECT_LE(r.mean_gap, 1e-4);
  EXPECT_LE(r.max_gap, 4e-4);
}

INSTANTIATE_TEST_SUITE_P(Ratios, Extreme, testing::Values(1e3, 1e4, 1e5, 1e6));

TEST(ExactScenes, LongExtremeChainHolds) {
  const auto r = scenes::chain<pintle::QuaternionHinge>(chain(100, 1e4, 1. / 60));
  EXPECT_LE(r.mean_gap, 2.5e-4);
}

// --- contacts --------------------------------------------------------------------------------------

scenes::CrowdSettings crowd(bool exact, double seconds, int size) {
  scenes::CrowdSettings settings;
  settings.seconds = seconds;
  settings.size = size;
  if (exact) settings.make_solver = [] { return std::make_unique<pintle::ExactJointSolver>(); };
  return settings;
}

TEST(ExactScenes, RagdollsHold) {
  const auto stock =
      scenes::ragdolls<btHingeConstraint, btConeTwistConstraint>(crowd(false, 3, 18));
  const auto ours =
      scenes::ragdolls<pintle::QuaternionHinge, pintle::ConeTwistJoint>(crowd(true, 3, 18));
  EXPECT_LT(ours.mean_gap, stock.mean_gap / 30);
  EXPECT_GT(ours.lowest, 0);
}

TEST(ExactScenes, BridgeBearsWhatItsPlanksDoNot) {
  const auto ours = scenes::bridge<pintle::QuaternionHinge>(crowd(true, 5, 100));
  const auto stock = scenes::bridge<btHingeConstraint>(crowd(false, 5, 100));
  EXPECT_LT(ours.mean_gap, stock.mean_gap / 100);
  EXPECT_GT(ours.lowest, -3) << "the load is on the bridge";
}

TEST(ExactScenes, TrackRunsAndHolds) {
  const auto ours = scenes::track<pintle::QuaternionHinge>(crowd(true, 3, 200));
  const auto stock = scenes::track<btHingeConstraint>(crowd(false, 3, 200));
  EXPECT_LT(ours.mean_gap, stock.mean_gap / 100);
  EXPECT_GT(ours.travel, 5) << "the wheel drives it";
  EXPECT_GT(ours.lowest, -3);
}

// Bullet's hinges turn their rows from step to step: what the last one's impulses say must not depend
// on them.
TEST(ExactScenes, TrackOfBulletsHingesHolds) {
  const auto ours = scenes::track<btHingeConstraint>(crowd(true, 3, 200));
  EXPECT_LT(ours.mean_gap, 2e-3);
  EXPECT_GT(ours.travel, 5);
}

}  // namespace
