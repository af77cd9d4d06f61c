// Under extreme conditions Pintle's joints stay finite, and end in no worse a class than stock's.
// What is known to end worse is named in extreme_known*.txt with its cause, and fails here as soon as it does
// not. And they end as the table of demos/results says, which demos/run.sh extreme prints.
#include <extreme/outcome.h>
#include <gtest/gtest.h>
#include <measures/run.h>
#include <pintle/solver/exact_joint_solver.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

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

/// What the published table says of each case in this precision, in one of its columns.
std::map<std::string, extreme::Result> published(size_t of_column) {
  std::map<std::string, extreme::Result> results;
  std::ifstream file(PINTLE_SOURCE_DIR "/demos/results/extreme.md");
  bool here = false;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("## ", 0) == 0)
      here = line == "## " + std::string(engines::precision()) + " precision";
    if (!here || line.rfind("| ", 0) != 0) continue;
    std::vector<std::string> columns;
    std::istringstream text(line.substr(2));
    for (std::string column; std::getline(text, column, '|'); text.ignore(1))
      columns.push_back(column.substr(0, column.find_last_not_of(' ') + 1));
    std::istringstream cell(columns.at(of_column));
    std::string outcome;
    extreme::Result result;
    if (!(cell >> outcome >> result.error)) continue;  // the head
    outcome.erase(std::remove(outcome.begin(), outcome.end(), '*'), outcome.end());
    while (name(result.outcome) != outcome && result.outcome != Outcome::non_finite)
      result.outcome = Outcome(int(result.outcome) + 1);
    results[columns[0] + ", " + columns[1]] = result;
  }
  return results;
}
constexpr size_t pintle_column = 4, exact_column = 5;

/// Errors of extreme cases differ between compilers, and those near the bound of a class cross it.
bool isAlike(const extreme::Result& a, const extreme::Result& b) {
  return a.outcome == b.outcome || std::abs(std::log(a.error / b.error)) < std::log(3.);
}

// With this solver (null: Bullet's own), against Bullet's joints on Bullet's, and as the table has it.
void expectNeverWorseThanStock(const scenes::SolverFactory& solver, const char* known_file,
                               size_t table_column) {
  std::set<std::string> left = known(known_file);
  const std::map<std::string, extreme::Result> table = published(table_column);
  for (const Case& one : extreme::cases()) {
    if (one.is_long) {
      left.erase(one.name());
      continue;
    }
    const extreme::Result result = run(one, engines::make_conditioned_joint, solver);
    const Outcome stock = outcomeOfStock(one), ours = result.outcome;
    EXPECT_NE(ours, Outcome::non_finite) << one.name();
    const auto told = table.find(one.name());
    if (told == table.end())
      ADD_FAILURE() << one.name() << " is not in demos/results/extreme.md";
    else
      EXPECT_TRUE(isAlike(result, told->second))
          << one.name() << ": " << name(ours) << ' ' << result.error
          << ", in demos/results/extreme.md " << name(told->second.outcome) << ' '
          << told->second.error;
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

TEST(Extreme, FiniteAndNeverWorseThanStock) {
  expectNeverWorseThanStock({}, "extreme_known.txt", pintle_column);
}

TEST(Extreme, FiniteAndNeverWorseThanStockOnTheExactSolver) {
  expectNeverWorseThanStock([] { return std::make_unique<pintle::ExactJointSolver>(); },
                            "extreme_known_exact.txt", exact_column);
}

// What one solver is worse with the other is not.
TEST(Extreme, WithOneSolverOrTheOtherNeverWorseThanStock) {
  const std::set<std::string> exact = known("extreme_known_exact.txt");
  for (const std::string& name : known("extreme_known.txt"))
    EXPECT_EQ(exact.count(name), 0u) << name;
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
