// Under extreme conditions Pintle's joints stay finite, and end in no worse a class than stock's.
// The table: demos/run.sh extreme. What is known to end worse is named in extreme_known*.txt with its cause,
// and fails here as soon as it does not.
#include <extreme/outcome.h>
#include <gtest/gtest.h>
#include <measures/run.h>
#include <pintle/solver/exact_joint_solver.h>

#include <fstream>
#include <map>
#include <set>

namespace {

using extreme::Case;
using extreme::Outcome;

std::vector<Case> short_cases() {
  std::vector<Case> cases;
  for (const Case& one : extreme::cases()) {
    if (!one.is_long) cases.push_back(one);
  }
  return cases;
}

/// Lines "precision: case"; lines that begin with # say why.
std::set<std::string> known(const char* file_name) {
  std::set<std::string> names;
  std::ifstream file(std::string(PINTLE_SOURCE_DIR "/tests/scenes/") + file_name);
  const std::string prefix = std::string(engines::precision()) + ": ";
  for (std::string line; std::getline(file, line);) {
    if (line.rfind(prefix, 0) == 0) names.insert(line.substr(prefix.size()));
    if (line.rfind("both: ", 0) == 0) names.insert(line.substr(6));
  }
  return names;
}

TEST(Extreme, CoversAtLeastTwoHundredCasesOfDifferentNames) {
  std::set<std::string> names;
  for (const Case& one : extreme::cases()) names.insert(one.name());
  EXPECT_EQ(names.size(), extreme::cases().size());
  EXPECT_GE(short_cases().size(), 200u);
}

/// Of Bullet's joints on Bullet's solver: found once for all tests.
Outcome outcomeOfStock(const Case& one) {
  static std::map<std::string, Outcome> found;
  const auto [it, is_new] = found.emplace(one.name(), Outcome::exact);
  if (is_new) it->second = run(one, engines::make_stock_joint).outcome;
  return it->second;
}

// With this solver (null: Bullet's own), against Bullet's joints on Bullet's.
void expectNeverWorseThanStock(const scenes::SolverFactory& solver, const char* known_file) {
  std::set<std::string> left = known(known_file);
  for (const Case& one : extreme::cases()) {
    if (one.is_long) {
      left.erase(one.name());
      continue;
    }
    const Outcome stock = outcomeOfStock(one),
                  ours = run(one, engines::make_conditioned_joint, solver).outcome;
    EXPECT_NE(ours, Outcome::non_finite) << one.name();
    const bool good = ours <= stock;
    if (left.erase(one.name()) > 0) {
      EXPECT_FALSE(good) << one.name() << " is good now: no longer a known failure";
    } else {
      EXPECT_TRUE(good) << one.name() << ": stock " << name(stock) << ", ours " << name(ours);
    }
  }
  for (const std::string& name : left)
    ADD_FAILURE() << name << " is known, but there is no such case";
}

TEST(Extreme, FiniteAndNeverWorseThanStock) { expectNeverWorseThanStock({}, "extreme_known.txt"); }

TEST(Extreme, FiniteAndNeverWorseThanStockOnTheExactSolver) {
  expectNeverWorseThanStock([] { return std::make_unique<pintle::ExactJointSolver>(); },
                            "extreme_known_exact.txt");
}

/// Why a fall of 10^6 steps ends in a worse class than stock's: it has not ended.
TEST(Extreme, AFallGoesOnWhichStockJointsBrake) {
  const auto energy_left = [](engines::MakeJoint make_joint) {
    scenes::Scene scene;
    for (const Case& one : extreme::cases()) {
      if (one.name() == "ball, 1e4 steps after a fall") scene = one.scene;
    }
    const auto engine = engines::make_bullet(scene, 10, make_joint);
    const double hanging = -scenes::standard_gravity * (0.5 + 1.5);  // J, of 1 kg each
    double least = HUGE_VAL, most = -HUGE_VAL;  // in the last second, of what it fell with
    measures::run(scene, *engine, 1. / 60,
                  [&](double time, const std::vector<engines::State>& states) {
                    if (time < scene.seconds - 1) return;
                    const double left = 1 - measures::energy(scene, states) / hanging;
                    least = std::min(least, left);
                    most = std::max(most, left);
                  });
    return std::make_pair(least, most);
  };
  const auto [least, most] = energy_left(engines::make_conditioned_joint);
  EXPECT_GT(least, 0.7);
  EXPECT_LT(most, 1.1);  // the velocities are half a step behind
  EXPECT_LT(energy_left(engines::make_stock_joint).second, 0.3);
}

}  // namespace
