// Pintle's joints beside stock joints among contacts, in the same scenes. On Bullet's solver joints are no further
// apart, and they feed no energy to what touches them; on the exact solver they hold.
#include <gtest/gtest.h>
#include <measures/crate_bridges.h>
#include <measures/crowd.h>
#include <measures/run.h>
#include <pintle/solver/exact_joint_solver.h>
#include <scenes/crowds.h>

#include <ostream>
#include <string>

namespace crowds_test {

using engines::make_conditioned_joint;
using engines::make_stock_joint;

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

measures::CrateBridgesResult bridges(engines::MakeJoint make_joint, const Rate& rate) {
  return measures::run_crate_bridges(make_joint, rate.iterations, rate.hz, rate.seconds,
                                     rate.bridges);
}

// What a step gains in all is contacts' doing, too, and Bullet's integration of what swings: of bridges that stock joints
// have brought to rest less than of those that go on.
TEST_P(BridgesWithCrates, FeedCratesNoMoreThanStockJointsAndThrowNothingOff) {
  const measures::CrateBridgesResult stock = bridges(make_stock_joint, GetParam()),
                                     pintle = bridges(make_conditioned_joint, GetParam());
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

// --- crowds --------------------------------------------------------------------------------------

struct Crowd {
  const char* name;
  scenes::Scene scene;
};
std::ostream& operator<<(std::ostream& out, const Crowd& crowd) { return out << crowd.name; }

class Crowds : public testing::TestWithParam<Crowd> {};

// The mean over joints and steps.
double meanGap(const scenes::Scene& scene, engines::MakeJoint make_joint) {
  const auto engine = engines::make_bullet(scene, 10, make_joint);
  const int steps = 120;
  double mean = 0;
  for (int i = 0; i < steps; ++i) {
    engine->drive(i / 60., 1. / 60);
    engine->step(1. / 60);
    mean += measures::gaps(scene, *engine).mean / steps;
  }
  return mean;
}

TEST_P(Crowds, JointsAreNoFurtherApartThanStocks) {
  const scenes::Scene& scene = GetParam().scene;
  const double stock = meanGap(scene, make_stock_joint),
               pintle = meanGap(scene, make_conditioned_joint);
  EXPECT_GT(stock, 0);
  EXPECT_LE(pintle, stock);
}

INSTANTIATE_TEST_SUITE_P(All, Crowds,
                         testing::Values(Crowd{"Ragdolls", scenes::ragdolls_scene(5)},
                                         Crowd{"Doors", scenes::doors_scene(12)},
                                         Crowd{"Vehicles", scenes::vehicles_scene(4)},
                                         Crowd{"Net", scenes::net_scene(8)}),
                         [](const auto& of) { return std::string(of.param.name); });

// --- on the exact solver -------------------------------------------------------------------------

// Bullet's joints are solved by the rows that they write themselves.
std::unique_ptr<btConstraintSolver> exact() {
  auto solver = std::make_unique<pintle::ExactJointSolver>();
  solver->setUpgradesBulletJoints(false);
  return solver;
}

measures::CrowdResult run(scenes::Scene scene, double seconds, engines::MakeJoint make_joint,
                          const scenes::SolverFactory& make_solver = {}) {
  scene.seconds = seconds;
  return measures::run_crowd(scene, *engines::make_bullet(scene, 10, make_joint, make_solver));
}

TEST(ExactCrowds, RagdollsHold) {
  const scenes::Scene pile = scenes::ragdoll_pile_scene(18);
  const auto stock = run(pile, 3, make_stock_joint),
             ours = run(pile, 3, make_conditioned_joint, exact);
  EXPECT_LT(ours.mean_gap, stock.mean_gap / 30);
  EXPECT_GT(ours.lowest, 0);
}

// In each step, however hard they land: a limit among contacts is pushed back, but nothing is pulled to it.
TEST(ExactCrowds, RagdollsHoldInEachStep) {
  const scenes::Scene scene = scenes::ragdolls_scene();
  const auto engine = engines::make_bullet(scene, 10, make_conditioned_joint, exact);
  for (int step = 0; step < 120; ++step) {
    engine->step(1. / 60);
    ASSERT_LT(measures::gaps(scene, *engine).largest, sizeof(btScalar) > 4 ? 1e-6 : 2e-4) << step;
  }
}

// A load of 100 times a plank's mass.
TEST(ExactCrowds, BridgeBearsWhatItsPlanksDoNot) {
  const scenes::Scene bridge = scenes::loaded_bridge_scene();
  const auto stock = run(bridge, 5, make_stock_joint),
             ours = run(bridge, 5, make_conditioned_joint, exact);
  EXPECT_LT(ours.mean_gap, stock.mean_gap / 100);
  EXPECT_GT(ours.lowest, -3) << "the load is on the bridge";
}

TEST(ExactCrowds, TrackRunsAndHolds) {
  const scenes::Scene track = scenes::track_scene();
  const auto stock = run(track, 3, make_stock_joint),
             ours = run(track, 3, make_conditioned_joint, exact);
  EXPECT_LT(ours.mean_gap, stock.mean_gap / 100);
  EXPECT_GT(ours.travel, 5) << "the wheel drives it";
  EXPECT_GT(ours.lowest, -3);
}

// Bullet's hinges turn their rows from step to step: what the last one's impulses say must not depend
// on them.
TEST(ExactCrowds, TrackOfBulletsHingesHolds) {
  const auto ours = run(scenes::track_scene(), 3, make_stock_joint, exact);
  EXPECT_LT(ours.mean_gap, 2e-3);
  EXPECT_GT(ours.travel, 5);
}

TEST(ExactCrowds, SameBitsInEveryRun) {
  const scenes::Scene pile = scenes::ragdoll_pile_scene(9);
  const auto a = run(pile, 1, make_conditioned_joint, exact),
             b = run(pile, 1, make_conditioned_joint, exact);
  EXPECT_EQ(a.mean_gap, b.mean_gap);
  EXPECT_EQ(a.end_kinetic, b.end_kinetic);
  EXPECT_EQ(a.lowest, b.lowest);
}

// --- scenes in scenes ----------------------------------------------------------------------------

TEST(Scenes, AreAppendedWithTheirJointsWhole) {
  scenes::Scene part;
  const int box = part.add(scenes::box(1, {0.1, 0.1, 0.1}, {1, 0, 0}));
  part.connect(scenes::Kind::fixed, 0, box, scenes::at({0.5, 0, 0}));
  scenes::Scene whole;
  whole.bodies[0].pose = scenes::at({0, 0, -1});
  whole.append(part, scenes::at({0, 0, 0}));
  whole.append(part, scenes::with_x({1, 2, 3}, {0, 1, 0}));
  const auto engine = engines::make_bullet(whole, 10, make_conditioned_joint);
  const engines::State ground = engine->state(0), moved = engine->state(2);
  const double wanted[] = {1, 3, 3};
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(moved.pose(i, 3), wanted[i], 1e-6);
  ASSERT_EQ(whole.joints.size(), 2u);
  const measures::JointErrors left = measures::joint_errors(whole.joints[1], ground, moved);
  EXPECT_NEAR(left.gap, 0, 1e-6);
  EXPECT_NEAR(left.axis, 0, 1e-3);
}

}  // namespace crowds_test
