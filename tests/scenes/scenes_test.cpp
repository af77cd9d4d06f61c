// Scenes are what they say: their joints hold at the start, and every contender builds them alike.
#include <engines/bullet.h>
#include <gtest/gtest.h>
#include <measures/run.h>
#include <pintle/solver/exact_joint_solver.h>
#include <reference/integrator.h>
#include <scenes/catalog.h>

#include <set>
#include <string>

namespace {

using scenes::Scene;

class Scenes : public testing::TestWithParam<Scene> {};

std::vector<engines::State> start(const Scene& scene, const engines::Engine& engine) {
  std::vector<engines::State> states;
  for (size_t i = 0; i < scene.bodies.size(); ++i) states.push_back(engine.state(int(i)));
  return states;
}

TEST_P(Scenes, JointsHoldAtTheStart) {
  const Scene& scene = GetParam();
  if (scene.has(scenes::Error::recovery)) return;  // they come to hold
  for (const engines::Contender& contender : engines::contenders()) {
    const auto engine = contender.make(scene, 10);
    if (!engine) continue;
    const std::vector<engines::State> states = start(scene, *engine);
    for (const scenes::Joint& joint : scene.joints) {
      const measures::JointErrors errors =
          measures::joint_errors(joint, states[size_t(joint.a)], states[size_t(joint.b)]);
      EXPECT_LT(errors.gap, 1e-5) << contender.name;
      EXPECT_LT(errors.axis, 1e-5) << contender.name;
    }
  }
}

TEST_P(Scenes, ContendersStartWithTheSameEnergyAndMomentum) {
  const Scene& scene = GetParam();
  const auto pintle = engines::find_contender("pintle")->make(scene, 10);
  ASSERT_TRUE(pintle);
  const std::vector<engines::State> expected = start(scene, *pintle);
  const double scale = std::max(1., std::abs(measures::energy(scene, expected)));
  for (const engines::Contender& contender : engines::contenders()) {
    const auto engine = contender.make(scene, 10);
    if (!engine) continue;
    const std::vector<engines::State> states = start(scene, *engine);
    EXPECT_NEAR(measures::energy(scene, states), measures::energy(scene, expected), 1e-4 * scale)
        << contender.name;
    EXPECT_NEAR(
        (measures::angular_momentum(scene, states) - measures::angular_momentum(scene, expected))
            .norm(),
        0, 1e-4 * scale)
        << contender.name;
  }
}

TEST_P(Scenes, ARunRepeatsExactly) {
  Scene scene = GetParam();
  scene.seconds = std::min(scene.seconds, 0.5);
  scene.horizon = std::min(scene.horizon, scene.seconds);
  const engines::Contender& pintle = *engines::find_contender("pintle");
  const measures::Outcome first = measures::run(scene, *pintle.make(scene, 10), 1. / 60),
                          second = measures::run(scene, *pintle.make(scene, 10), 1. / 60);
  EXPECT_TRUE(first.finite);
  EXPECT_EQ(first.errors, second.errors);
  const bool only_limits = scene.joints[0].kind >= scenes::Kind::angle;  // not always reached
  EXPECT_TRUE(first.rows > 0 || only_limits);
}

/// What joints themselves leave, on the exact solver against stock's on Bullet's: no more, but for rounding.
TEST_P(Scenes, OnTheExactSolverJointsHoldNoWorseThanStocks) {
  const Scene& scene = GetParam();
  const double rounding = engines::precision() == std::string("double") ? 1e-9 : 1e-4;
  const auto engine = [&](const char* contender) {
    return engines::find_contender(contender)->make(scene, 10);
  };
  if (!engine("stock")) GTEST_SKIP() << "no stock joint does it";
  const auto run = [&](const char* contender) {
    return measures::run(scene, *engine(contender), 1. / 60);
  };
  const measures::Outcome stock = run("stock"), exact = run("exact");
  EXPECT_TRUE(exact.finite);
  for (const auto error :
       {measures::Error::gap, measures::Error::axis, measures::Error::overshoot}) {
    EXPECT_LE(exact[error], stock[error] + rounding) << name(error);
  }
}

/// Each has its own of Okabe and Ito's colours, which the colour-blind tell apart; stock is grey, and their yellow a wine red. There are no more of
/// them: steps of second order are of Tol's olive.
TEST(Contenders, HaveColoursOfTheirOwn) {
  std::set<std::string> left = {"#e69f00", "#56b4e9", "#009e73", "#882255", "#0072b2",
                                "#d55e00", "#cc79a7", "#000000", "#7d8590", "#999933"};
  for (const engines::Contender& contender : engines::contenders())
    EXPECT_EQ(left.erase(contender.colour), 1u) << contender.name << ": " << contender.colour;
}

/// Sixteen times shorter steps leave an eighth of the error at most: closed forms are what Bullet's steps tend to.
TEST(ClosedForms, AreApproachedByShorterSteps) {
  const engines::Contender& pintle = *engines::find_contender("pintle");
  for (const Scene& scene :
       {scenes::valve_scene(), scenes::bounce_scene(), scenes::door_scene(1)}) {
    const auto error = [&](double hz) {
      return measures::run(scene, *pintle.make(scene, 10), 1 / hz)[measures::Error::trajectory];
    };
    EXPECT_LT(error(960), error(60) / 8) << scene.name;
  }
}

/// Where nothing touches, limits need no iterations on the exact solver, and hold at the end of the step.
TEST(ExactLimits, HoldWithoutIterations) {
  for (const char* name : {"wedge_acute", "wedge_wide", "cone_shoulder"}) {
    SCOPED_TRACE(name);
    const Scene scene = scenes::named(name);
    const auto overshoot = [&](const char* contender) {
      const auto engine = engines::find_contender(contender)->make(scene, 4);
      return measures::run(scene, *engine, 1. / 60)[measures::Error::overshoot];
    };
    EXPECT_LT(overshoot("exact"), 2e-5);
    EXPECT_LT(100 * overshoot("exact"), overshoot("pintle"));
    EXPECT_LT(10000 * overshoot("exact"), overshoot("stock"));
  }
}

/// A stop whose direction turns over in a step, as at the tip of a flat cone, holds; and springs neither gain nor lose.
TEST(ExactJointSolver, LeavesLittleAtTipsAndSprings) {
  const auto left = [](const char* name, measures::Error error) {
    const Scene scene = scenes::named(name);
    const auto engine = engines::make_bullet(scene, 10, engines::make_conditioned_joint, [] {
      return std::make_unique<pintle::ExactJointSolver>();
    });
    return measures::run(scene, *engine, 1. / 60)[error];
  };
  EXPECT_LT(left("flat_cone", measures::Error::overshoot), 1e-5);
  EXPECT_LT(left("spring", measures::Error::trajectory), 0.005);
  EXPECT_LT(left("suspension", measures::Error::trajectory), 0.005);
}

/// What a whipping chain of light links gains in energy is of Bullet's steps, with joints that leave nothing at
/// all: the exact solver makes up for it.
TEST(Steps, GainTheChainMoreEnergyThanTheExactSolver) {
  const Scene scene = scenes::chain_scene(10, 1);
  const measures::Outcome exact = measures::run(
                              scene, *engines::find_contender("exact")->make(scene, 10), 1. / 60),
                          steps =
                              measures::run(scene, *reference::make_bullet_steps(scene), 1. / 60);
  EXPECT_LT(steps[measures::Error::gap], 1e-9);
  EXPECT_LT(exact[measures::Error::energy], steps[measures::Error::energy] / 2);
}

/// Steps of second order leave a tenth, with IFToMM's Bricard mechanism, too. (The governor's springs are of first order all the same.)
TEST(Steps, OfSecondOrderLeaveATenth) {
  for (const Scene& scene :
       {scenes::pendulum_scene(), scenes::four_bar_scene(), scenes::free_pair_scene(),
        scenes::top_scene(), scenes::named("bricard")}) {
    SCOPED_TRACE(scene.name);
    constexpr double dt = 1. / 240;
    const auto run = [&](const char* who) {
      return measures::run(scene, *engines::find_contender(who)->make(scene, 10), dt);
    };
    const measures::Outcome second = run("second_order"), first = run("exact");
    // In single precision the loads of the linkage, whose rows repeat each other, are those of rounding: then some of its steps are as Bullet's. And what
    // rounding a pose to 1e-7 m gives to velocities, 240 times a second, is more than a tenth of the energy's error.
    constexpr bool is_double = sizeof(btScalar) == sizeof(double);
    EXPECT_LE(second[measures::Error::trajectory],
              first[measures::Error::trajectory] / (is_double ? 10 : 5));
    if (is_double && scene.has(measures::Error::energy)) {
      EXPECT_LE(second[measures::Error::energy], first[measures::Error::energy] / 10);
    }
  }
}

/// Joints that hold leave the errors of Bullet's steps, and no more (or a little less: what chords of arcs give is balanced): in the redundant loop of the
/// linkage, too, where rounding makes rows that ought to say the same contradict each other.
TEST(Steps, AreAllThatPintlesJointsOnTheExactSolverLeave) {
  for (const Scene& scene : {scenes::pendulum_scene(), scenes::four_bar_scene(),
                             scenes::free_pair_scene(), scenes::top_scene()}) {
    SCOPED_TRACE(scene.name);
    constexpr double dt = 1. / 120;
    const measures::Outcome exact = measures::run(
                                scene, *engines::find_contender("exact")->make(scene, 10), dt),
                            steps = measures::run(scene, *reference::make_bullet_steps(scene), dt);
    EXPECT_LT(steps[measures::Error::gap], 1e-9);
    for (const measures::Error error : {measures::Error::trajectory, measures::Error::energy}) {
      EXPECT_LE(exact[error], 1.06 * steps[error]) << name(error);
      EXPECT_GE(exact[error], 0.9 * steps[error]) << name(error);
    }
  }
}

/// What is to show a limit comes to it, and stays there.
TEST(ScenesOfLimits, ComeToTheirLimits) {
  int shown = 0;
  for (const Scene& scene : scenes::catalog()) {
    if (scene.group != scenes::Group::limits) continue;
    ++shown;
    for (const char* who : {"pintle", "exact"}) {
      const auto engine = engines::find_contender(who)->make(scene, 10);
      const double overshoot = measures::run(scene, *engine, 1. / 60)[measures::Error::overshoot];
      EXPECT_GT(overshoot, -1e-3) << scene.name << ' ' << who;
      EXPECT_LT(overshoot, 0.02) << scene.name << ' ' << who;
    }
  }
  EXPECT_EQ(shown, 4);
}

/// The report compares with stock joints: where there are none, it cannot. Of machines it tables what there is.
TEST_P(Scenes, AreBuiltOfStockJointsIfComparedOverAllSettings) {
  const auto stock = engines::find_contender("stock")->make(GetParam(), 10);
  EXPECT_TRUE(stock || GetParam().compared != scenes::Compared::over_all_settings);
}

INSTANTIATE_TEST_SUITE_P(All, Scenes, testing::ValuesIn(scenes::catalog()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
