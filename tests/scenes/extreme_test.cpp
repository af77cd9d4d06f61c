// Under extreme conditions Pintle's joints stay finite, and end in no worse a class than stock's.
// The table: demos/run.sh extreme. What is known to end worse is named in extreme_known*.txt with its cause,
// and fails here as soon as it does not.
#include <extreme/outcome.h>
#include <gtest/gtest.h>
#include <pintle/solver/exact_joint_solver.h>

#include <fstream>
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

// With this solver (null: Bullet's own), against Bullet's joints on Bullet's.
void expectNeverWorseThanStock(const scenes::SolverFactory& solver, const char* known_file) {
  std::set<std::string> left = known(known_file);
  for (const Case& one : short_cases()) {
    const Outcome stock = run(one, engines::make_stock_joint).outcome,
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

}  // namespace
