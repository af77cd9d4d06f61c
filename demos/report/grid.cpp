// Runs scenes with every contender over iterations and steps, and writes a line a run: its errors, and
// the run time of a step.
//
// The contenders take turns, several times, each with as many of the scene's first steps as take a
// few milliseconds. A run repeats exactly, so that its every step has a median over the repeats,
// which leaves out what disturbed one of them; the run time is their mean. Nothing but the step is
// timed.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <set>
#include <string>
#include <tuple>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "../progress.h"
#include "../scenes/catalog.h"
#include "table.h"

namespace {

using engines::Contender;
using report::Row;
using scenes::Scene;

struct Options {
  std::vector<std::string> scenes, contenders;  // empty: all
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
  const auto is_left_out = [](const Scene& scene) {
    return scene.compared == scenes::Compared::nowhere && scene.problem.empty();
  };
  all.erase(std::remove_if(all.begin(), all.end(), is_left_out), all.end());
  return all;
}

bool is_chosen(const std::string& name, const std::vector<std::string>& chosen) {
  return chosen.empty() || std::find(chosen.begin(), chosen.end(), name) != chosen.end();
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
std::vector<Row> measure(const Group& group, const Options& options, const std::set<Key>& done) {
  const double dt = 1. / group.hz;
  std::vector<Row> rows;
  std::vector<const Contender*> who;
  std::vector<int> steps;
  for (const Contender& contender : engines::contenders()) {
    if (!is_chosen(contender.name, options.contenders)) continue;
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
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
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
    if (!is_chosen(scene.name, options.scenes)) continue;
    if (scene.compared == scenes::Compared::as_games_run) {
      groups.push_back({&scene, 10, 60, true});
      continue;
    }
    for (const int hz : options.hz) {
      for (const int iterations : options.iterations)
        groups.push_back({&scene, iterations, hz, iterations == options.iterations.front()});
    }
  }

  std::set<Key> done;
  for (const Row& row : report::read(options.csv)) done.insert(key(row));
  std::ofstream csv(options.csv, std::ios::app);
  if (csv.tellp() == 0) csv << report::head();
  csv << '\n';  // ends a line that was cut off

  double weight = 0;
  for (const Group& group : groups) weight += group.weight();
  Progress progress(weight);
  for (const Group& group : groups) {
    const std::vector<Row> rows = measure(group, options, done);
    for (const Row& row : rows) csv << line(row) << std::endl;  // kept if the run is interrupted
    if (!csv) {
      progress.clear();
      std::fprintf(stderr, "--csv: cannot write %s\n", options.csv.c_str());
      return EXIT_FAILURE;
    }
    if (rows.empty()) {
      progress.skip(group.weight());
    } else {
      progress.advance(group.weight(), std::string(engines::precision()) + ", " +
                                           group.scene->name + ", " + std::to_string(group.hz) +
                                           " Hz");
    }
  }
  return EXIT_SUCCESS;
}

struct Steps {
  std::string scene, contender;
  int iterations = 10, hz = 60, count = 0;
};

// For an instruction counter: so many steps, and no more.
int run_steps(const Steps& steps) {
  const Contender* const contender = engines::find_contender(steps.contender);
  for (const Scene& scene : compared()) {
    if (scene.name != steps.scene || contender == nullptr) continue;
    const auto engine = contender->make(scene, steps.iterations);
    if (!engine) return EXIT_FAILURE;
    for (int step = 0; step < steps.count; ++step) {
      engine->drive(double(step) / steps.hz, 1. / steps.hz);
      engine->step(1. / steps.hz);
    }
    return EXIT_SUCCESS;
  }
  return EXIT_FAILURE;
}

// From one scene to another, in the catalog's order; empty: from the first, to the last.
std::vector<std::string> range(const std::vector<std::string>& scenes, const std::string& from,
                               const std::string& to) {
  const auto first = from.empty() ? scenes.begin() : std::find(scenes.begin(), scenes.end(), from);
  const auto last = to.empty() ? scenes.end() : std::find(first, scenes.end(), to);
  return {first, last == scenes.end() ? last : last + 1};
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
  std::vector<std::string> scenes, contenders;
  for (const Scene& scene : compared()) scenes.push_back(scene.name);
  for (const Contender& contender : engines::contenders()) contenders.push_back(contender.name);

  Options options;
  Steps count;
  std::string from, to;
  bool quick = false, list = false;
  CLI::App app("Measures error against run time of all contenders.");
  app.add_option("--scene", options.scenes, "Only this scene; may be given more than once")
      ->check(CLI::IsMember(scenes))
      ->allow_extra_args(false);
  app.add_option("--contender", options.contenders,
                 "Only this contender; may be given more than once")
      ->check(CLI::IsMember(contenders))
      ->allow_extra_args(false);
  app.add_option("--from", from, "The first of a range of scenes")->check(CLI::IsMember(scenes));
  app.add_option("--to", to, "The last of a range of scenes")->check(CLI::IsMember(scenes));
  app.add_flag("--quick", quick, "Fewer iterations and steps");
  app.add_option("--csv", options.csv,
                 "Where the numbers go; what it holds already is not run again")
      ->take_last();
  app.add_flag("--list", list, "Name the scenes, and the contenders with their colours");
  CLI::App& steps = *app.add_subcommand("steps", "So many steps alone, for instruction counters");
  steps.add_option("scene", count.scene)->required();
  steps.add_option("contender", count.contender)->required();
  steps.add_option("iterations", count.iterations)->required();
  steps.add_option("hz", count.hz)->required();
  steps.add_option("steps", count.count)->required();
  CLI11_PARSE(app, argc, argv);

  if (steps) return run_steps(count);
  if (list) {
    for (const std::string& scene : scenes) std::printf("scene %s\n", scene.c_str());
    for (const Contender& contender : engines::contenders())
      std::printf("contender %s %s\n", contender.name.c_str(), contender.colour.c_str());
    return EXIT_SUCCESS;
  }
  if (quick) {
    options.iterations = {1, 10, 50};
    options.hz = {60, 240};
  }
  if (!from.empty() || !to.empty()) {
    for (const std::string& name : range(scenes, from, to)) options.scenes.push_back(name);
  }
  try {
    return run_grid(options);
  } catch (const std::exception& error) {  // of another engine
    return std::fprintf(stderr, "\n%s\n", error.what()), EXIT_FAILURE;
  }
}
