// Pintle's joints beside Bullet's own in whole frames, both on btSequentialImpulseConstraintSolver, in the
// same run: what a step costs and how far joints are apart, and what the two do among contacts, from bad
// starts, in worlds that change, and under the mouse.
// Usage: frames [--seconds N] [--repeats N] [--converged] [scene...]
//   scenes      ragdolls doors vehicles bridges net chains (together: cost), crates tutorial starts worlds dragging
//   --seconds   of each run, in place of the scene's own
//   --repeats   of each timed run; a step counts with its shortest time
//   --converged starts: also what stock joints do at 200 iterations; tutorial: also 1000 iterations

#include <pintle/joints/dot_hinge.h>
#include <pintle/joints/two_point_hinge.h>

#include <measures/crate_bridges.h>
#include <measures/run.h>
#include <scenes/chain.h>
#include <scenes/changing.h>
#include <scenes/crowds.h>
#include <scenes/dragging.h>
#include <scenes/starts.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "processor_time.h"

namespace {

using engines::make_conditioned_joint;
using engines::make_stock_joint;
using scenes::PintleJoints;
using scenes::PlaygroundPtr;
using scenes::PlaygroundSettings;
using scenes::StockJoints;

struct Options {
  double seconds = 0;  // 0: as the scene has it
  int repeats = 5;
  bool converged = false;  // also stock's starts at 200 iterations
};

// --- cost ------------------------------------------------------------------------------------------

struct Cost {
  double mean_gap = 0;     // m, over joints and steps
  double largest_gap = 0;  // m, the mean over steps of the largest
  double microseconds = 0;
};

struct Contender {
  engines::MakeJoint make_joint;
  Cost cost = {};
  std::vector<double> shortest = {};  // us, of each step
};

// Both run side by side and take turns every few steps. Each step is the same in every repeat, so that its
// shortest time is its own.
void measure(const scenes::Scene& scene, std::vector<Contender>& contenders, double seconds,
             int repeats) {
  const double dt = 1. / 60;
  const int steps = int(std::lround(seconds / dt)), turn = 10;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    std::vector<std::unique_ptr<engines::BulletEngine>> worlds;
    for (Contender& contender : contenders) {
      worlds.push_back(engines::make_bullet(scene, 10, contender.make_joint));
      contender.shortest.resize(size_t(steps), HUGE_VAL);
    }
    for (int from = 0; from < steps; from += turn) {
      for (size_t k = 0; k < worlds.size(); ++k) {
        Contender& contender = contenders[k];
        for (int step = from; step < std::min(from + turn, steps); ++step) {
          worlds[k]->drive(step * dt, dt);
          const double before = bench::processorTime();
          worlds[k]->step(dt);
          double& shortest = contender.shortest[size_t(step)];
          shortest = std::min(shortest, bench::processorTime() - before);
          if (repeat > 0) continue;
          const measures::Gaps gap = measures::gaps(scene, *worlds[k]);
          contender.cost.mean_gap += gap.mean / steps;
          contender.cost.largest_gap += gap.largest / steps;
        }
      }
    }
  }
  for (Contender& contender : contenders) {
    contender.cost.microseconds = 0;
    for (const double t : contender.shortest) contender.cost.microseconds += t / steps;
  }
}

struct CostScene {
  const char* name;
  double seconds;
  scenes::Scene scene;
};

const std::vector<CostScene>& costScenes() {
  static const std::vector<CostScene> all = {{"ragdolls", 5, scenes::ragdolls_scene()},
                                             {"doors", 3, scenes::doors_scene()},
                                             {"vehicles", 4, scenes::vehicles_scene()},
                                             {"bridges", 4, scenes::crate_bridges(20).scene},
                                             {"net", 4, scenes::net_scene()}};
  return all;
}

void costHeader() {
  static bool done = false;
  if (done) return;
  done = true;
  std::printf("\n%-10s %6s %11s %11s %7s %11s %11s %9s %9s %6s\n", "cost", "joints", "stock gap",
              "Pintle gap", "ratio", "stock worst", "Pintle w.", "stock us", "Pintle us", "time");
}

void cost(const CostScene& scene, const Options& options) {
  costHeader();
  std::vector<Contender> both = {{make_stock_joint}, {make_conditioned_joint}};
  measure(scene.scene, both, options.seconds > 0 ? options.seconds : scene.seconds,
          options.repeats);
  const Cost &stock = both[0].cost, &pintle = both[1].cost;
  std::printf("%-10s %6d %11.2e %11.2e %7.3f %11.2e %11.2e %9.1f %9.1f %6.3f\n", scene.name,
              int(scene.scene.joints.size()), stock.mean_gap, pintle.mean_gap,
              pintle.mean_gap / stock.mean_gap, stock.largest_gap, pintle.largest_gap,
              stock.microseconds, pintle.microseconds, pintle.microseconds / stock.microseconds);
  std::fflush(stdout);
}

void chains(const Options& options) {
  const int iterations[] = {1, 2, 4, 10, 20, 50, 100};
  std::printf("\n%-14s", "chain, gap");
  for (const int n : iterations) std::printf(" %7d", n);
  std::printf("   (of Pintle's mean gap to stock's, by iterations)\n");
  double worst = 0;
  for (const double ratio : {1., 10., 100.}) {
    std::printf("chain(10,%4g) ", ratio);
    for (const int n : iterations) {
      scenes::ChainSettings settings;
      settings.ratio = ratio;
      settings.iterations = n;
      if (options.seconds > 0) settings.seconds = options.seconds;
      const double stock = scenes::chain<btHingeConstraint>(settings).mean_gap,
                   pintle = scenes::chain<pintle::QuaternionHinge>(settings).mean_gap;
      // Where stock's chain tears, the ratio says nothing.
      std::printf(" %7.3f%s", pintle / stock, stock < 1 ? "" : "*");
      if (stock < 1) worst = std::max(worst, pintle / stock);
    }
    std::printf("\n");
  }
  std::printf("worst          %7.3f   (*: stock's gap is over 1 m; not counted)\n", worst);
  std::fflush(stdout);
}

// --- bridges with crates ---------------------------------------------------------------------------

void crates(const Options& options) {
  const double seconds = options.seconds > 0 ? options.seconds : 6;
  std::printf("\n%-26s %-8s %11s %11s %10s %10s %10s %4s\n", "50 bridges with crates", "", "fed J",
              "gains J", "end J", "mean gap", "max gap", "off");
  for (const int iterations : {10, 100}) {
    for (const double hz : {60., 120., 240.}) {
      const auto print = [&](const char* who, const measures::CrateBridgesResult& r) {
        std::printf("%3d iterations, %3.0f Hz     %-8s %11.4g %11.3g %10.3g %10.2e %10.2e %4d\n",
                    iterations, hz, who, r.fed, r.gains, r.end_kinetic, r.mean_gap, r.max_gap,
                    r.thrown_off);
        std::fflush(stdout);
      };
      print("stock", measures::run_crate_bridges(make_stock_joint, iterations, hz, seconds, 50));
      print("Pintle",
            measures::run_crate_bridges(make_conditioned_joint, iterations, hz, seconds, 50));
    }
  }
}

// --- starts ----------------------------------------------------------------------------------------

void tutorial(const Options& options) {
  const double seconds = options.seconds > 0 ? options.seconds : 10;
  std::printf("\n%-26s %-8s %11s %9s %9s %9s\n", "tutorial's rope bridge", "", "gain J", "m/s",
              "rad/s", "end gap");
  std::vector<int> counts = {10, 100};
  if (options.converged) counts.push_back(1000);
  for (const int iterations : counts) {
    PlaygroundSettings settings;
    settings.iterations = iterations;
    const auto print = [&](const char* who, const PlaygroundPtr& world) {
      const scenes::StartResult r = scenes::run_start(*world, seconds);
      std::printf("%4d iterations            %-8s %11.4g %9.3g %9.3g %9.2e\n", iterations, who,
                  r.energy, r.speed, r.spin, r.gap);
    };
    print("stock", scenes::make_tutorial_bridge<StockJoints>(settings));
    print("Pintle", scenes::make_tutorial_bridge<PintleJoints>(settings));
  }
}

constexpr unsigned start_seeds = 40;

struct DotHinges : PintleJoints {
  using Hinge = pintle::DotHinge;
};
struct TwoPointHinges : PintleJoints {
  using Hinge = pintle::TwoPointHinge;
};

template <class Family>
void startsOf(const char* name, scenes::Kind kind, double seconds, bool converged) {
  using scenes::Start;
  scenes::PlaygroundSettings many;
  many.iterations = 200;
  for (const Start start : {Start::overlapping, Start::apart, Start::turned, Start::all}) {
    double energy[2] = {0, 0}, speed[2] = {0, 0}, spin[2] = {0, 0}, worst = 0, limit = 0;
    int more_energy = 0, more_speed = 0;
    for (unsigned seed = 0; seed < start_seeds; ++seed) {
      const scenes::StartResult r[] = {
          scenes::run_start(*scenes::make_start<StockJoints>(kind, start, seed), seconds),
          scenes::run_start(*scenes::make_start<Family>(kind, start, seed), seconds)};
      if (converged)
        limit = std::max(
            limit,
            scenes::run_start(*scenes::make_start<StockJoints>(kind, start, seed, many), seconds)
                .energy);
      for (int i = 0; i < 2; ++i) {
        energy[i] = std::max(energy[i], r[i].energy);
        speed[i] = std::max(speed[i], r[i].speed);
        spin[i] = std::max(spin[i], r[i].spin);
      }
      if (r[1].energy > 1e-3) worst = std::max(worst, r[1].energy / std::max(r[0].energy, 1e-3));
      more_energy += r[1].energy > 1.05 * r[0].energy + 1e-3 ? 1 : 0;
      more_speed += r[1].speed > 1.05 * r[0].speed + 1e-2 ? 1 : 0;
    }
    std::printf("%-18s %-12s %10.3g %10.3g %8.2f %8.3g %8.3g %8.3g %8.3g %6d %6d", name,
                scenes::start_name(start), energy[0], energy[1], worst, speed[0], speed[1], spin[0],
                spin[1], more_energy, more_speed);
    if (converged) std::printf(" %10.3g", limit);
    std::printf("\n");
    std::fflush(stdout);
  }
}

void starts(const Options& options) {
  using scenes::Kind;
  const double seconds = options.seconds > 0 ? options.seconds : 3;
  std::printf(
      "\n%-18s %-12s %10s %10s %8s %8s %8s %8s %8s %6s %6s   (of %u starts; > : Pintle's over 1.05 "
      "times stock's; from the constant velocity joint on stock's is a stand-in)\n",
      "starts", "", "stock J", "Pintle J", "worst", "stock v", "Pintle v", "stock w", "Pintle w",
      "E >", "v >", start_seeds);
  if (options.converged) std::printf("last column: stock J at 200 iterations\n");
  for (int k = 0; k <= int(Kind::contact); ++k) {
    startsOf<PintleJoints>(scenes::kind_name(Kind(k)), Kind(k), seconds, options.converged);
    if (Kind(k) != Kind::hinge) continue;
    startsOf<DotHinges>("dot hinge", Kind::hinge, seconds, options.converged);
    startsOf<TwoPointHinges>("two-point hinge", Kind::hinge, seconds, options.converged);
  }
}

// --- worlds that change ----------------------------------------------------------------------------

void worlds(const Options& options) {
  const unsigned count = 200;
  const int steps = options.seconds > 0 ? int(options.seconds * 60) : 300;
  std::printf("\n%-26s %-8s %10s %8s %8s %12s\n", "200 worlds that change", "", "> 1000 m/s",
              "> 100", "median", "largest m/s");
  for (const auto kinds : {scenes::Kinds::common, scenes::Kinds::all}) {
    const char* which =
        kinds == scenes::Kinds::common ? "joints that both have" : "all of Pintle's joints";
    std::vector<double> speeds[2];
    int too_fast[2] = {0, 0}, fast[2] = {0, 0}, slower = 0;
    for (unsigned seed = 0; seed < count; ++seed) {
      const scenes::ChangingResult r[] = {scenes::run_changing<StockJoints>(seed, kinds, steps),
                                          scenes::run_changing<PintleJoints>(seed, kinds, steps)};
      for (int i = 0; i < 2; ++i) {
        speeds[i].push_back(r[i].speed);
        too_fast[i] += r[i].speed > 1000 ? 1 : 0;
        fast[i] += r[i].speed > 100 ? 1 : 0;
      }
      slower += r[1].speed <= 1.05 * r[0].speed ? 1 : 0;
      if (r[1].speed <= 1000 && r[0].speed <= 1000) continue;
      std::printf("  seed %u: stock %.4g m/s (step %d), Pintle %.4g (step %d, joints of that body:",
                  seed, r[0].speed, r[0].step, r[1].speed, r[1].step);
      for (const scenes::Kind kind : r[1].kinds) std::printf(" %s", scenes::kind_name(kind));
      std::printf(")\n");
    }
    for (int i = 0; i < 2; ++i) {
      std::sort(speeds[i].begin(), speeds[i].end());
      std::printf("%-26s %-8s %10d %8d %8.2f %12.4g\n", which, i == 0 ? "stock" : "Pintle",
                  too_fast[i], fast[i], speeds[i][count / 2], speeds[i].back());
    }
    std::printf("  Pintle's fastest body at most 1.05 times stock's in %d of %u\n", slower, count);
    std::fflush(stdout);
  }
}

// --- under the mouse -------------------------------------------------------------------------------

void dragging(const Options& options) {
  const int frames = options.seconds > 0 ? int(options.seconds * 60) : 300;
  std::printf("\n%-38s %10s %10s %10s %10s\n", "dragged box", "stock w", "Pintle w", "stock lag",
              "Pintle lag");
  int count = 0, lags = 0, spins = 0, off_spins = 0;
  for (const scenes::DragCase& drag : scenes::drag_cases()) {
    const scenes::DragResult stock = scenes::drag_free<StockJoints>(drag, frames),
                             pintle = scenes::drag_free<PintleJoints>(drag, frames);
    const bool lag = pintle.lag > stock.lag + 0.05,
               spin = drag.centre && pintle.spin > stock.spin + 0.5,
               off_spin = !drag.centre && pintle.spin > 1.5 * stock.spin + 0.5;
    ++count;
    lags += lag ? 1 : 0;
    spins += spin ? 1 : 0;
    off_spins += off_spin ? 1 : 0;
    std::printf("%-38s %10.3g %10.3g %10.3g %10.3g%s%s%s\n", scenes::name(drag).c_str(), stock.spin,
                pintle.spin, stock.lag, pintle.lag, lag ? "  lags" : "", spin ? "  spins" : "",
                off_spin ? "  spins (off)" : "");
  }
  std::printf(
      "of %d cases Pintle's lags by more than stock + 0.05 m in %d, spins by more than stock + 0.5 "
      "rad/s, pulled at "
      "the centre, in %d; off it, by more than 1.5 stock + 0.5 rad/s, in %d\n",
      count, lags, spins, off_spins);
  std::printf("\n%-38s %10s %10s %10s %10s\n", "dragged board on a limited hinge", "stock past",
              "Pintle p.", "stock w", "Pintle w");
  int hung = 0, past = 0;
  for (const scenes::DragCase& drag : scenes::drag_cases()) {
    const scenes::DragResult stock = scenes::drag_hung<StockJoints>(drag, frames),
                             pintle = scenes::drag_hung<PintleJoints>(drag, frames);
    const bool passes = pintle.past > stock.past + 5e-3;
    ++hung;
    past += passes ? 1 : 0;
    std::printf("%-38s %10.3g %10.3g %10.3g %10.3g%s\n", scenes::name(drag).c_str(), stock.past,
                pintle.past, stock.spin, pintle.spin, passes ? "  passes" : "");
  }
  std::printf("of %d cases Pintle's passes its limits by more than stock + 5e-3 rad in %d\n", hung,
              past);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  std::vector<std::string> wanted;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--seconds") == 0 && i + 1 < argc)
      options.seconds = std::atof(argv[++i]);
    else if (std::strcmp(argv[i], "--repeats") == 0 && i + 1 < argc)
      options.repeats = std::max(1, std::atoi(argv[++i]));
    else if (std::strcmp(argv[i], "--converged") == 0)
      options.converged = true;
    else
      wanted.push_back(argv[i]);
  }
  const auto want = [&](const char* name, const char* group = "") {
    return wanted.empty() || std::any_of(wanted.begin(), wanted.end(), [&](const std::string& w) {
             return w == name || w == group;
           });
  };
  std::printf("%s precision\n", sizeof(btScalar) == sizeof(double) ? "double" : "single");
  for (const CostScene& scene : costScenes())
    if (want(scene.name, "cost")) cost(scene, options);
  if (want("chains", "cost")) chains(options);
  if (want("crates")) crates(options);
  if (want("tutorial")) tutorial(options);
  if (want("starts")) starts(options);
  if (want("worlds")) worlds(options);
  if (want("dragging")) dragging(options);
}
