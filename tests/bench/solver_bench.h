// Parts of the benchmark `solver`: what they share.
#pragma once

#include <pintle/solver/exact_joint_solver.h>

#include <scenes/world.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "page_table.h"

namespace solver_bench {

// The parts, each a table or more.
void chains();
void scaling();
void grid();
void crowd();
void motors();
void tangles();

// What a run measures.
struct Measured {
  double microseconds_per_step = 0, mean_gap = 0, max_gap = 0, bytes = 0;
  int joints = 0;
  std::vector<double> times = {};  // us, of each step
};
// Adds its time. linear.sh counts its instructions.
void timedStep(const std::function<void()>& step, Measured& to);
// Runs of scaling's and grid's.
Measured hang(const std::string& shape, int joints, bool is_exact, int steps);
enum class NetBy { stock, default_options, to_a_micrometre, one_factor };
Measured net(int size, NetBy by, int steps);

// The rows of linear.sh.
void listCosts();
// Runs one of them for an instruction counter, and prints its joints and steps. False: there is none of that name.
bool countCost(const std::string& name, bool is_exact);
// Prints its joints, and by stock's solver and by the exact one the time of a step and the mean gap.
bool timeCost(const std::string& name);

// One of a crowd, or `chain`, by `stock`, `exact`, or `least`: the exact solver with one pass and coarse tolerances. Returns how many
// joints it has; 0: there is none of that name.
int stepScene(const std::string& name, const std::string& solver, int steps);

// Bullet's joints are solved by the rows that they write themselves.
inline std::unique_ptr<btConstraintSolver> exact() {
  auto solver = std::make_unique<pintle::ExactJointSolver>();
  solver->setUpgradesBulletJoints(false);
  return solver;
}
inline std::unique_ptr<btConstraintSolver> exactTo(double tolerance, int max_factors) {
  auto solver = std::make_unique<pintle::ExactJointSolver>();
  pintle::SolverOptions options = solver->options();
  options.newton_tolerance = options.pose_tolerance = options.loose_pose_tolerance = tolerance;
  options.max_factors = max_factors;
  solver->setOptions(options);
  solver->setUpgradesBulletJoints(false);
  return solver;
}
inline std::unique_ptr<btConstraintSolver> toAMicrometre() {
  return exactTo(1e-6, pintle::SolverOptions().max_factors);
}

// Runs all in turn and keeps the shortest time of each.
template <class Result>
std::vector<Result> inTurn(const std::vector<std::function<Result()>>& runs, int rounds = 5) {
  std::vector<Result> results(runs.size());
  for (int round = 0; round < rounds; ++round) {
    for (size_t i = 0; i < runs.size(); ++i) {
      const Result now = runs[i]();
      const double before = results[i].microseconds_per_step;
      results[i] = now;
      if (round > 0) results[i].microseconds_per_step = std::min(before, now.microseconds_per_step);
    }
  }
  return results;
}

// --- the page's tables -------------------------------------------------------------------------------

inline bench::PageTable holds("holds", {"scene", "mean gap, Bullet", "mean gap, exact",
                                        "largest gap, Bullet", "largest gap, exact",
                                        "mean gap, Bullet's joints on the exact solver",
                                        "time, exact / Bullet"});
inline bench::PageTable moves("motors", {"scene", "error", "Pintle's joints on Bullet's solver",
                                         "Pintle's joints on the exact solver"});
inline bench::PageTable wild("tangles", {"joints, solver", "median", "99 % are below", "most"});
inline bench::PageTable nets("nets", {"bodies", "joints", "options", "time, exact / Bullet",
                                      "mean gap, exact", "mean gap, Bullet", "memory of a joint"});
inline bench::PageTable cost("scaling",
                             {"shape", "joints", "time, exact / Bullet", "a joint's time, exact",
                              "a joint's time, Bullet", "memory"});

// Bullet's joints on Bullet's solver, Pintle's and Bullet's on the exact one.
template <class Result>
void addHolds(const std::string& scene, const Result& stock, const Result& exact,
              const Result& exact_stock) {
  holds.add({scene, bench::cell(stock.mean_gap, " m"), bench::cell(exact.mean_gap, " m"),
             bench::cell(stock.max_gap, " m"), bench::cell(exact.max_gap, " m"),
             bench::cell(exact_stock.mean_gap, " m"),
             bench::ratio(exact.microseconds_per_step / stock.microseconds_per_step)});
}

}  // namespace solver_bench
