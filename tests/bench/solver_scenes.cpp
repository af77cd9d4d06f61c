// Whole scenes: among contacts, with motors and limits, and with joints that cannot all hold.
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/universal_joint.h>

#include <engines/bullet.h>
#include <measures/crowd.h>
#include <scenes/catalog.h>
#include <scenes/crowds.h>
#include <scenes/drive_shaft.h>
#include <scenes/shoulder.h>
#include <scenes/slider_crank.h>
#include <scenes/tangle.h>

#include <cmath>
#include <cstdio>

#include "solver_bench.h"

namespace solver_bench {

using bench::cell;
using scenes::SolverFactory;

// --- among contacts --------------------------------------------------------------------------------

namespace {

void print(const char* scene, const char* who, const measures::CrowdResult& r,
           const measures::CrowdResult& stock) {
  std::printf("%-10s %-16s %7d %9.1e %9.1e %10.1e %9.1e %8.2f %8.2f %9.0f %6.2f\n", scene, who,
              r.joints, r.mean_gap, r.max_gap, r.mean_penetration, r.end_kinetic, r.lowest,
              r.travel, r.microseconds_per_step,
              r.microseconds_per_step / stock.microseconds_per_step);
}

struct Crowd {
  const char *name, *title;
  scenes::Scene scene;
};
std::vector<Crowd> crowds() {
  return {{"doors", "100 doors with limits and motors", scenes::doors_scene()},
          {"vehicles", "20 cars with driven wheels", scenes::vehicles_scene()},
          {"bridges", "20 rope bridges, a crate on each", scenes::crate_bridges(20).scene},
          {"ragdolls", "20 ragdolls", scenes::ragdolls_scene()},
          {"pile", "pile of 50 ragdolls", scenes::ragdoll_pile_scene()},
          {"bridge", "bridge of 100 planks, a load of 100 planks dropped on it",
           scenes::loaded_bridge_scene()},
          {"track", "closed track of 200 links around two wheels", scenes::track_scene()}};
}

}  // namespace

int stepScene(const std::string& name, const std::string& solver, int steps) {
  scenes::Scene scene;
  const bool is_chain = name == "chain";
  if (is_chain) scene = scenes::chain_scene(100, 1000);
  for (const Crowd& of : crowds())
    if (of.name == name) scene = of.scene;
  const double dt = is_chain ? 1 / 240. : 1 / 60.;
  const bool is_least = solver == "least";
  const auto least = [] { return exactTo(1e-5, 1); };
  const auto engine =
      solver == "stock"
          ? engines::make_bullet(scene, 10, engines::make_stock_joint)
          : engines::make_bullet(scene, is_least ? 1 : 10, engines::make_conditioned_joint,
                                 is_least ? SolverFactory(least) : SolverFactory(exact));
  for (int i = 0; i < steps; ++i) {
    engine->drive(i * dt, dt);
    engine->step(dt);
  }
  return int(scene.joints.size());
}

void crowd() {
  std::printf("\n%-10s %-16s %7s %9s %9s %10s %9s %8s %8s %9s %6s\n", "", "", "joints", "mean gap",
              "max gap", "deepest", "end J", "lowest", "travel", "us/step", "ratio");
  for (const auto& [name, title, scene] : crowds()) {
    const auto with = [&scene = scene](engines::MakeJoint make_joint, const SolverFactory& solver) {
      return [&scene, make_joint, solver] {
        return measures::run_crowd(scene, *engines::make_bullet(scene, 10, make_joint, solver));
      };
    };
    const auto results = inTurn<measures::CrowdResult>(
        {with(engines::make_stock_joint, {}), with(engines::make_conditioned_joint, exact),
         with(engines::make_stock_joint, exact)});
    addHolds(title, results[0], results[1], results[2]);
    const char* names[] = {"stock, 10", "exact", "exact, stock j."};
    for (size_t i = 0; i < results.size(); ++i) print(name, names[i], results[i], results[0]);
  }
}

// --- motors and limits -------------------------------------------------------------------------------

// Where nothing touches.
void motors() {
  std::printf("\n%-44s %-36s %12s %12s\n", "", "", "pintle, 10", "exact");
  const auto compare = [](const char* scene, const char* error, const char* unit, double bullets,
                          double ours) {
    std::printf("%-44s %-36s %12.1e %12.1e\n", scene, error, bullets, ours);
    moves.add({scene, error, cell(bullets, unit), cell(ours, unit)});
  };
  const auto both = [](auto run, auto settings) {
    const auto bullets = run(settings);
    settings.make_solver = exact;
    return std::make_pair(bullets, run(settings));
  };
  const auto crank = both(
      [](const scenes::SliderCrankSettings& settings) {
        return scenes::slider_crank<pintle::QuaternionHinge, pintle::BallJoint,
                                    pintle::SliderJoint>(settings);
      },
      scenes::SliderCrankSettings());
  compare("slider-crank", "the piston from its closed form", " m", crank.first.max_piston_error,
          crank.second.max_piston_error);
  compare("slider-crank", "the crank from its motor's speed", " rad", crank.first.max_crank_error,
          crank.second.max_crank_error);
  const auto shaft =
      both(scenes::drive_shaft<pintle::UniversalJoint>, scenes::DriveShaftSettings());
  compare("shafts at 30°, 300 rpm, a universal joint", "the second shaft from its closed form",
          " rad", shaft.first.universal_error, shaft.second.universal_error);
  const auto arm = both(
      [](const scenes::ShoulderSettings& settings) {
        return scenes::shoulder<pintle::ConeTwistJoint>(settings);
      },
      scenes::ShoulderSettings());
  compare("an arm thrown at its cone", "how far beyond it", " rad",
          std::max(arm.first.swing_beyond, 0.), std::max(arm.second.swing_beyond, 0.));
}

// --- tangles -----------------------------------------------------------------------------------------

// Largest speed (m/s) or spin (5 rad/s) of each tangle over what is no matter there: stock's, or 20.
void tangles() {
  constexpr unsigned count = 1000;
  using scenes::PintleJoints;
  using scenes::StockJoints;
  const char* names[] = {"pintle, 10", "exact, stock j.", "exact"};
  const char* titles[] = {"Pintle's joints on Bullet's solver",
                          "Bullet's joints on the exact solver",
                          "Pintle's joints on the exact solver"};
  std::vector<double> wildness[3];
  for (unsigned seed = 0; seed < count; ++seed) {
    const auto speed = [](const scenes::TangleResult& result) {
      return result.finite ? std::max(result.speed, result.spin / 5) : HUGE_VAL;
    };
    const double usual = std::max(speed(scenes::tangle<StockJoints>(seed)), 20.);
    wildness[0].push_back(speed(scenes::tangle<PintleJoints>(seed)) / usual);
    wildness[1].push_back(speed(scenes::tangle<StockJoints>(seed, exact)) / usual);
    wildness[2].push_back(speed(scenes::tangle<PintleJoints>(seed, exact)) / usual);
  }
  std::printf("\n%-16s %8s  %8s  %8s  (of %u tangles, fastest body over stock's)\n", "", "median",
              "99 %", "largest", count);
  for (size_t i = 0; i < 3; ++i) {
    std::sort(wildness[i].begin(), wildness[i].end());
    std::printf("%-16s %8.2f  %8.2f  %8.2f\n", names[i], wildness[i][count / 2],
                wildness[i][count * 99 / 100], wildness[i].back());
    wild.add({titles[i], cell(wildness[i][count / 2]), cell(wildness[i][count * 99 / 100]),
              cell(wildness[i].back())});
  }
}

}  // namespace solver_bench
