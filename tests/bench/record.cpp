// What a Recorder adds to a step: worlds with and without one take turns, and each step counts with its shortest
// time. Usage: record [repeats]
//   record list                  the worlds: index and name
//   record INDEX FRAMES STEPS    runs one, with so many frames a second, for an instruction counter (record.sh)
//   record page FILE TEMPLATE    writes a page of 500 bodies in each of four panes, for tests/page/measure.sh

#include <pintle/record.h>

#include <engines/bullet.h>
#include <scenes/catalog.h>
#include <scenes/crowds.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <list>
#include <memory>
#include <numeric>
#include <vector>

namespace {

struct Case {
  const char* name;
  scenes::Scene scene;
};
const Case cases[] = {{"chain of 10", scenes::chain_scene(10, 1)},
                      {"chain of 100", scenes::chain_scene(100, 1)},
                      {"20 ragdolls", scenes::ragdolls_scene()},
                      {"100 doors", scenes::doors_scene()}};

constexpr int timed_steps = 240, many_ragdolls = 46;
constexpr double dt = 1. / 60;

// With Pintle's joints, their motors on.
std::unique_ptr<engines::BulletEngine> start(const scenes::Scene& scene) {
  auto engine = engines::make_bullet(scene, 10, engines::make_conditioned_joint);
  engine->drive(0, dt);
  return engine;
}

// us, of each step, with frames so often a second; 0: without a recorder.
std::vector<double> run(const Case& of, double frames_per_second, int steps = timed_steps) {
  using Clock = std::chrono::steady_clock;
  const auto engine = start(of.scene);
  std::unique_ptr<pintle::Recorder> recorder;
  pintle::RecorderOptions options;
  if (frames_per_second > 0) {
    options.frames_per_second = frames_per_second;
    recorder = std::make_unique<pintle::Recorder>(engine->world(), options);
  }
  std::vector<double> times;
  for (int i = 0; i < steps; ++i) {
    const auto before = Clock::now();
    engine->world().stepSimulation(btScalar(dt), 0);
    if (recorder) recorder->step();
    times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - before).count());
  }
  return times;
}

// 5 s of 500 bodies, four times.
void writeMany(const char* file, const char* page_template) {
  std::list<std::unique_ptr<engines::BulletEngine>> worlds;
  std::list<pintle::Recorder> recorders;
  pintle::Recordings all;
  for (const char* name : {"first", "second", "third", "fourth"}) {
    btDiscreteDynamicsWorld& world =
        worlds.emplace_back(start(scenes::ragdolls_scene(many_ragdolls)))->world();
    std::printf("%s: %d bodies\n", name, world.getNumCollisionObjects());
    pintle::RecorderOptions options;
    options.name = name;
    options.scene = "many";
    all.emplace_back(recorders.emplace_back(world, options));
    for (int i = 0; i < 300; ++i) {
      world.stepSimulation(btScalar(dt), 0);
      recorders.back().step();
    }
  }
  pintle::writePage(file, all, page_template);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::strcmp(argv[1], "list") == 0) {
    for (std::size_t i = 0; i < std::size(cases); ++i) std::printf("%zu\t%s\n", i, cases[i].name);
    return 0;
  }
  if (argc == 4 && std::strcmp(argv[1], "page") == 0) {
    writeMany(argv[2], argv[3]);
    return 0;
  }
  if (argc == 4) {
    run(cases[std::size_t(std::atoi(argv[1]))], std::atof(argv[2]), std::atoi(argv[3]));
    return 0;
  }
  const int repeats = argc > 1 ? std::atoi(argv[1]) : 20;
  const double rates[] = {0, 60, 30};  // Hz, of frames
  std::printf("%-14s %12s %14s %14s\n", "world", "step us", "60 frames/s", "30 frames/s");
  for (const Case& of : cases) {
    std::vector<double> best[3];
    for (int repeat = 0; repeat < repeats; ++repeat) {
      for (int i = 0; i < 3; ++i) {
        const std::vector<double> times = run(of, rates[i]);
        if (best[i].empty()) best[i] = times;
        for (std::size_t k = 0; k < times.size(); ++k) best[i][k] = std::min(best[i][k], times[k]);
      }
    }
    double sum[3];
    for (int i = 0; i < 3; ++i) sum[i] = std::accumulate(best[i].begin(), best[i].end(), 0.);
    std::printf("%-14s %12.1f %+13.2f%% %+13.2f%%\n", of.name, sum[0] / timed_steps,
                100 * (sum[1] / sum[0] - 1), 100 * (sum[2] / sum[0] - 1));
  }
}
