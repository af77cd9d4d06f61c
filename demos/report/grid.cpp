// Runs scenes with every contender over iterations and steps, and writes a line a run: its errors, and
// the run time of a step.
//
// The contenders take turns, several times, each with as many of the scene's first steps as take a
// few milliseconds. A run repeats exactly, so that its every step has a median over the repeats,
// which leaves out what disturbed one of them; the run time is their mean. Nothing but the step is
// timed.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <set>
#include <string>
#include <tuple>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "../scenes/catalog.h"
#include "table.h"

namespace {

using engines::Contender;
using report::Row;
using scenes::Scene;

struct Options {
  std::vector<std::string> scenes;  // empty: all
  std::vector<int> iterations = {1, 2, 4, 10, 20, 50, 100, 200};
  std::vector<int> hz = {60, 120, 240, 1000};
  int repeats = 5;
  std::string csv = "report.csv";
};

// Contenders that are compared at one number of iterations and one step.
struct Group {
  const Scene* scene;
  int iterations, hz;
  bool first;  // also those that do not iterate
  // About what it costs, in steps of a joint: for the remaining time.
  double weight() const {
    const double joints = double(scene->joints.size()) * (scene->contacts() ? 2 : 1);
    return scene->seconds * hz * (1 + joints) * (8 + iterations);
  }
};

using Key = std::tuple<std::string, std::string, int, int>;
Key key(const Row& row) { return {row.scene, row.contender, row.iterations, row.hz}; }

std::vector<Scene> compared() {
  std::vector<Scene> all = scenes::catalog();
  const auto is_left_out = [](const Scene& scene) { return !scene.in_report; };
  all.erase(std::remove_if(all.begin(), all.end(), is_left_out), all.end());
  return all;
}

double mean_of_medians(const std::vector<std::vector<double>>& repeats) {
  const size_t steps = repeats.front().size();
  double sum = 0;
  for (size_t step = 0; step < steps; ++step) {
    std::vector<double> of_step;
    for (const std::vector<double>& repeat : repeats) of_step.push_back(repeat[step]);
    const auto middle = of_step.begin() + long(of_step.size() / 2);
    std::nth_element(of_step.begin(), middle, of_step.end());
    sum += *middle;
  }
  return sum / double(steps);
}

// What the group still lacks.
std::vector<Row> measure(const Group& group, int repeats, const std::set<Key>& done) {
  const double dt = 1. / group.hz;
  std::vector<Row> rows;
  std::vector<const Contender*> who;
  std::vector<int> steps;
  for (const Contender& contender : engines::contenders()) {
    const bool iterates = contender.iterates_in(*group.scene);
    if (!iterates && !group.first) continue;
    Row row{engines::precision(), group.scene->name, contender.name,
            iterates ? group.iterations : 0, group.hz};
    if (done.count(key(row))) continue;
    const auto engine = contender.make(*group.scene, group.iterations);
    if (!engine) continue;
    const measures::Outcome outcome = measures::run(*group.scene, *engine, dt);
    row.errors = outcome.errors;
    row.rows = outcome.rows;
    rows.push_back(row);
    who.push_back(&contender);
    constexpr double seconds_a_repeat = 4e-3;
    const double step = outcome.seconds / std::max(1, outcome.steps);
    steps.push_back(
        std::clamp(int(seconds_a_repeat / step), std::min(10, outcome.steps), outcome.steps));
  }
  std::vector<std::vector<std::vector<double>>> times(who.size());  // by contender and repeat
  for (int repeat = 0; repeat < repeats; ++repeat) {
    for (size_t i = 0; i < who.size(); ++i) {
      times[i].push_back(
          measures::step_times(*group.scene, *who[i], group.iterations, dt, steps[i]));
    }
  }
  for (size_t i = 0; i < who.size(); ++i) rows[i].microseconds = 1e6 * mean_of_medians(times[i]);
  return rows;
}

int run_grid(const Options& options) {
  const std::vector<Scene> all = compared();
  std::vector<Group> groups;
  for (const Scene& scene : all) {
    if (!options.scenes.empty() &&
        std::find(options.scenes.begin(), options.scenes.end(), scene.name) == options.scenes.end())
      continue;
    for (const int hz : options.hz) {
      for (const int iterations : options.iterations)
        groups.push_back({&scene, iterations, hz, iterations == options.iterations.front()});
    }
  }
  if (groups.empty()) return std::fprintf(stderr, "no such scene\n"), EXIT_FAILURE;

  std::set<Key> done;
  for (const Row& row : report::read(options.csv)) done.insert(key(row));
  std::ofstream csv(options.csv, std::ios::app);
  if (csv.tellp() == 0) csv << report::head();
  csv << '\n';  // ends a line that was cut off

  double weight = 0, weight_done = 0, weight_skipped = 0;
  for (const Group& group : groups) weight += group.weight();
  const auto start = std::chrono::steady_clock::now();
  for (const Group& group : groups) {
    const std::vector<Row> rows = measure(group, options.repeats, done);
    for (const Row& row : rows) csv << line(row) << std::endl;  // kept if the run is interrupted
    if (!csv) return std::fprintf(stderr, "cannot write %s\n", options.csv.c_str()), EXIT_FAILURE;
    (rows.empty() ? weight_skipped : weight_done) += group.weight();
    const double elapsed =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double left =
        weight_done > 0 ? elapsed * (weight - weight_skipped - weight_done) / weight_done : 0;
    std::fprintf(stderr, "\r%s: %3.0f %%, %s, %3d iterations, %4d Hz, %.0f s left        ",
                 engines::precision(), 100 * (weight_done + weight_skipped) / weight,
                 group.scene->name.c_str(), group.iterations, group.hz, left);
  }
  std::fprintf(stderr, "\n");
  return EXIT_SUCCESS;
}

// For an instruction counter: so many steps, and no more.
int run_steps(const std::string& scene_name, const std::string& contender_name, int iterations,
              int hz, int steps) {
  const Contender* const contender = engines::find_contender(contender_name);
  for (const Scene& scene : compared()) {
    if (scene.name != scene_name || contender == nullptr) continue;
    const auto engine = contender->make(scene, iterations);
    if (!engine) return EXIT_FAILURE;
    for (int step = 0; step < steps; ++step) {
      engine->drive(double(step) / hz, 1. / hz);
      engine->step(1. / hz);
    }
    return EXIT_SUCCESS;
  }
  return EXIT_FAILURE;
}

int usage(std::FILE* out) {
  std::fprintf(out,
               "  --scene NAME   only this scene; may be given more than once\n"
               "  --from NAME --to NAME   a range of them\n"
               "  --quick        fewer iterations and steps\n"
               "  --csv FILE     where the numbers go; what it holds already is not run again\n"
               "  --list         names the scenes, and the contenders with their colours\n"
               "scenes:");
  for (const Scene& scene : compared()) std::fprintf(out, " %s", scene.name.c_str());
  std::fprintf(out, "\n");
  return out == stderr ? EXIT_FAILURE : EXIT_SUCCESS;
}

// Where nothing moves across an axis, rounding errors decay below the smallest normal number, and
// arithmetic with them takes a hundred times as long. As games do.
void flush_denormals() {
#if defined(__SSE__)
  constexpr unsigned flush_results = 0x8000, take_as_zero = 0x0040;
  _mm_setcsr(_mm_getcsr() | flush_results | take_as_zero);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  flush_denormals();
  Options options;
  std::string from, to;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const auto value = [&] { return i + 1 < argc ? std::string(argv[++i]) : std::string(); };
    if (argument == "steps" && argc == 7) {
      return run_steps(argv[2], argv[3], std::atoi(argv[4]), std::atoi(argv[5]),
                       std::atoi(argv[6]));
    }
    if (argument == "--scene") {
      options.scenes.push_back(value());
    } else if (argument == "--from") {
      from = value();
    } else if (argument == "--to") {
      to = value();
    } else if (argument == "--quick") {
      options.iterations = {1, 10, 50};
      options.hz = {60, 240};
    } else if (argument == "--csv") {
      options.csv = value();
    } else if (argument == "--list") {
      for (const Scene& scene : compared()) std::printf("scene %s\n", scene.name.c_str());
      for (const Contender& contender : engines::contenders())
        std::printf("contender %s %s\n", contender.name.c_str(), contender.colour.c_str());
      return EXIT_SUCCESS;
    } else {
      return usage(argument == "--help" ? stdout : stderr);
    }
  }
  if (!from.empty() || !to.empty()) {
    bool inside = from.empty();
    for (const Scene& scene : compared()) {
      inside = inside || scene.name == from;
      if (inside) options.scenes.push_back(scene.name);
      if (scene.name == to) break;
    }
    if (!inside) return usage(stderr);
  }
  return run_grid(options);
}
