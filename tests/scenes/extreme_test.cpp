// Under extreme conditions Pintle's joints stay finite, and end in no worse a class than stock's; and as the table
// of demos/results says, which demos/run.sh extreme prints.
#include <extreme/outcome.h>
#include <gtest/gtest.h>
#include <measures/run.h>
#include <pintle/solver/exact_joint_solver.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
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
    std::string outcome, error;
    if (!(cell >> outcome >> error)) continue;  // the head
    extreme::Result result;
    result.error = std::strtod(error.c_str(), nullptr);  // also inf, which a stream does not read
    outcome.erase(std::remove(outcome.begin(), outcome.end(), '*'), outcome.end());
    while (name(result.outcome) != outcome && result.outcome != Outcome::non_finite)
      result.outcome = Outcome(int(result.outcome) + 1);
    results[columns[0] + ", " + columns[1]] = result;
  }
  return results;
}
constexpr size_t stock_column = 2, pintle_column = 4, exact_column = 5;

/// Errors of extreme cases differ between compilers, and those near the bound of a class cross it.
bool isAlike(const extreme::Result& a, const extreme::Result& b) {
  return a.outcome == b.outcome || std::abs(std::log(a.error / b.error)) < std::log(3.);
}

// Cases that are known to be worse on Bullet's solver, and their largest errors, of the size or rad.
const std::map<std::string, double> known_to_be_worse = {
    // Stock joints have braked the fall until all is at rest; Pintle's still swing (below).
    {"ball, 1e6 steps after a fall", 1e-2},
    {"hinge, 1e6 steps after a fall", 1e-2},
    // Bullet's slider has no spring, and no body such an inertia: a moment is at most the sum of the other two.
    {"slider with spring, discs: inertia ratio 1e-8", 10}};

void expectNoWorse(const Case& one, const extreme::Result& ours, Outcome stock, bool exact) {
  const auto known = known_to_be_worse.find(one.name());
  if (!exact && known != known_to_be_worse.end())
    EXPECT_LT(ours.error, known->second) << one.name();
  else
    EXPECT_LE(ours.outcome, stock)
        << one.name() << ": stock " << name(stock) << ", ours " << name(ours.outcome);
}

// With this solver (null: Bullet's own), against Bullet's joints on Bullet's, and as the table has it.
void expectNeverWorseThanStock(const scenes::SolverFactory& solver, size_t table_column) {
  const std::map<std::string, extreme::Result> table = published(table_column);
  for (const Case& one : short_cases()) {
    const extreme::Result result = run(one, engines::make_conditioned_joint, solver);
    EXPECT_NE(result.outcome, Outcome::non_finite) << one.name();
    expectNoWorse(one, result, outcomeOfStock(one), solver != nullptr);
    const auto told = table.find(one.name());
    if (told == table.end())
      ADD_FAILURE() << one.name() << " is not in demos/results/extreme.md";
    else
      EXPECT_TRUE(isAlike(result, told->second))
          << one.name() << ": " << name(result.outcome) << ' ' << result.error
          << ", in demos/results/extreme.md " << name(told->second.outcome) << ' '
          << told->second.error;
  }
}

TEST(Extreme, FiniteAndNeverWorseThanStock) { expectNeverWorseThanStock({}, pintle_column); }

TEST(Extreme, FiniteAndNeverWorseThanStockOnTheExactSolver) {
  expectNeverWorseThanStock([] { return std::make_unique<pintle::ExactJointSolver>(); },
                            exact_column);
}

// Bodies that turn kinematic keep their mass; motors start bodies that fall.
TEST(Extreme, HoldsExactlyOnTheExactSolver) {
  const std::set<std::string> names = {
      "ball, kinematic and dynamic by turns", "universal, kinematic and dynamic by turns",
      "hinge with motor, steps of 0.1 s", "hinge with motor, discs: inertia ratio 1e-8"};
  size_t found = 0;
  for (const Case& one : short_cases()) {
    if (names.count(one.name()) == 0) continue;
    ++found;
    const extreme::Result result = run(one, engines::make_conditioned_joint,
                                       [] { return std::make_unique<pintle::ExactJointSolver>(); });
    EXPECT_EQ(result.outcome, Outcome::exact) << one.name() << ": " << result.error;
  }
  EXPECT_EQ(found, names.size());
}

// Those of 10^6 steps, which take too long for a test, are in the table.
TEST(Extreme, TheTableHasNoneThatIsWorseButWhatIsKnown) {
  const std::map<std::string, extreme::Result> stock = published(stock_column);
  for (const size_t column : {pintle_column, exact_column}) {
    const std::map<std::string, extreme::Result> ours = published(column);
    for (const Case& one : extreme::cases()) {
      ASSERT_EQ(ours.count(one.name()), 1u) << one.name();
      expectNoWorse(one, ours.at(one.name()), stock.at(one.name()).outcome, column == exact_column);
    }
  }
}

/// What holds a fall of 10^6 steps to a thousandth has not braked it.
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
  const double stock = energy_left(engines::make_stock_joint).second;
  const auto [least, most] = energy_left(engines::make_conditioned_joint);
  EXPECT_LT(stock, 0.3);
  EXPECT_GT(least, 2 * stock);
  EXPECT_LT(most, 1.1);  // the velocities are half a step behind
}

}  // namespace
