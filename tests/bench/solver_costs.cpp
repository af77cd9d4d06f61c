// What a step costs, scene by scene: the rows of linear.sh.
#include <engines/bullet.h>
#include <measures/run.h>
#include <scenes/catalog.h>
#include <scenes/crowds.h>

#include <cstdio>
#include <optional>

#include "solver_bench.h"

namespace solver_bench {
namespace {

// A timed run is the whole scene. Under an instruction counter, which takes fifty times as long, it is some steps of it.
enum class Purpose { time, count };

struct Cost {
  std::string name, title;
  int rounds;
  std::function<Measured(bool is_exact, Purpose)> run;
};

struct Length {
  int whole, before_counted, counted;  // steps
};

// Of a scene whose joints are of all kinds.
Measured play(const scenes::Scene& scene, bool is_exact, Purpose purpose, const Length& length,
              double hz = 60, bool sleeps = false,
              const scenes::SolverFactory& make_exact = exact) {
  const auto engine =
      is_exact ? engines::make_bullet(scene, 10, engines::make_conditioned_joint, make_exact)
               : engines::make_bullet(scene, 10, engines::make_stock_joint);
  if (sleeps)
    for (size_t i = 1; i < scene.bodies.size(); ++i)
      engine->body(int(i)).forceActivationState(ISLAND_SLEEPING);
  Measured result;
  result.joints = int(scene.joints.size());
  const bool is_timed = purpose == Purpose::time;
  const int first = is_timed ? 0 : length.before_counted,
            steps = is_timed ? length.whole : first + length.counted;
  for (int i = 0; i < steps; ++i) {
    engine->drive(i / hz, 1 / hz);
    if (i < first)
      engine->step(1 / hz);
    else
      timedStep([&] { engine->step(1 / hz); }, result);
    if (!is_timed) continue;
    const double gap = measures::gaps(scene, *engine).largest;
    result.mean_gap += gap / steps;
    result.max_gap = std::max(result.max_gap, gap);
  }
  return result;
}

Cost crowd(const char* name, const char* title, const scenes::Scene& scene, int rounds = 3,
           bool sleeps = false) {
  return {name, title, rounds, [scene, sleeps](bool is_exact, Purpose purpose) {
            return play(scene, is_exact, purpose, {300, 60, 30}, 60, sleeps);
          }};
}

Cost netCost(const char* name, const char* title, int size, NetBy by) {
  const bool is_large = size > 30;
  return {name, title, is_large ? 1 : 3, [=](bool is_exact, Purpose purpose) {
            const int steps = !is_large ? 60 : purpose == Purpose::time ? 30 : 3;
            return net(size, is_exact ? by : NetBy::stock, steps);
          }};
}

// Nets of one kind, as they grow.
void addNets(const char* name, const char* title, scenes::Scene (*make)(int size),
             std::vector<Cost>& all) {
  for (const int size : {10, 15, 20, 30, 40})
    all.push_back({name + ("-" + std::to_string(size)),
                   "net of " + std::to_string(size) + " x " + std::to_string(size) + ", " + title,
                   size > 20 ? 1 : 3, [make, size](bool is_exact, Purpose purpose) {
                     return play(make(size), is_exact, purpose, {90, 60, size > 20 ? 5 : 30}, 60,
                                 false, toAMicrometre);
                   }});
}

Cost growth(const std::string& shape, int joints) {
  return {shape + "-" + std::to_string(joints), shape, joints <= 1000 ? 25 : 3,
          [=](bool is_exact, Purpose purpose) {
            const int steps =
                purpose == Purpose::time ? std::max(3, 5000 / joints) : std::max(1, 2000 / joints);
            return hang(shape, joints, is_exact, steps);
          }};
}

std::vector<Cost> costs() {
  std::vector<Cost> all = {
      crowd("ragdolls", "20 ragdolls", scenes::ragdolls_scene()),
      crowd("doors", "100 doors with limits and motors", scenes::doors_scene()),
      crowd("vehicles", "20 cars with driven wheels", scenes::vehicles_scene()),
      crowd("bridges", "20 rope bridges, a crate on each", scenes::crate_bridges(20).scene),
      crowd("net-on-ball", "net of 15 x 15 bodies on a ball", scenes::net_scene()),
      crowd("taut-net", "taut net of 15 x 15 bodies, a ball on it", scenes::taut_net_scene()),
      netCost("net-30", "net of 30 x 30 bodies, tolerances of 1e-6 m", 30, NetBy::to_a_micrometre),
      netCost("net-100", "net of 100 x 100 bodies, tolerances of 1e-6 m", 100,
              NetBy::to_a_micrometre),
      netCost("net-30-one", "net of 30 x 30 bodies, 1e-4 m, `max_factors` 1", 30,
              NetBy::one_factor),
      netCost("net-100-one", "net of 100 x 100 bodies, 1e-4 m, `max_factors` 1", 100,
              NetBy::one_factor),
      {"chain-loaded", "chain of 100, load 1000:1, 240 Hz", 3,
       [scene = scenes::chain_scene(100, 1000)](bool is_exact, Purpose purpose) {
         return play(scene, is_exact, purpose, {1200, 60, 60}, 240);
       }},
      crowd("boxes", "100 boxes without joints", scenes::boxes_scene(), 7),
      crowd("asleep", "20 ragdolls asleep", scenes::ragdolls_scene(), 15, true)};
  addNets("hangs", "hangs", scenes::hanging_net_scene, all);
  addNets("lies", "on the ground", scenes::lying_net_scene, all);
  addNets("ball", "on a ball", scenes::net_scene, all);
  addNets("taut", "taut, a ball on it", scenes::taut_net_scene, all);
  for (const char* shape : {"chain", "tree"})
    for (const int joints : {10, 100, 1000, 10000, 100000}) all.push_back(growth(shape, joints));
  for (const int joints : {100, 300, 1000}) all.push_back(growth("star", joints));
  return all;
}

std::optional<Cost> named(const std::string& name) {
  for (const Cost& of : costs())
    if (of.name == name) return of;
  std::fprintf(stderr, "solver: there is no scene %s\n", name.c_str());
  return {};
}

}  // namespace

void listCosts() {
  for (const Cost& of : costs()) std::printf("%s\t%s\n", of.name.c_str(), of.title.c_str());
}

bool countCost(const std::string& name, bool is_exact) {
  const std::optional<Cost> of = named(name);
  if (!of) return false;
  const Measured counted = of->run(is_exact, Purpose::count);
  std::printf("%d %d\n", counted.joints, int(counted.times.size()));
  return true;
}

// Each step is the same in every round, so that its shortest time is its own.
bool timeCost(const std::string& name) {
  const std::optional<Cost> of = named(name);
  if (!of) return false;
  Measured shortest[2];
  for (int round = 0; round < of->rounds; ++round) {
    for (const bool is_exact : {false, true}) {
      Measured now = of->run(is_exact, Purpose::time);
      std::vector<double>& before = shortest[is_exact].times;
      for (size_t i = 0; i < before.size(); ++i) now.times[i] = std::min(now.times[i], before[i]);
      shortest[is_exact] = now;
    }
  }
  std::printf("%d", shortest[0].joints);
  for (const Measured& by : shortest) {
    double sum = 0;
    for (const double time : by.times) sum += time;
    std::printf(" %g %g", sum / double(by.times.size()), by.mean_gap);
  }
  std::printf("\n");
  return true;
}

}  // namespace solver_bench
