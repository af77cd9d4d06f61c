// Runs the gallery's scenes with each contender, and writes the recordings as one page.

#include <pintle/record.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "engines/engine.h"
#include "json_array.h"
#include "measures/run.h"
#include "progress.h"
#include "scenes/catalog.h"

namespace {

using engines::Engine;
using scenes::Scene;

constexpr double dt = 1. / 60;
// Of a run: a page of all scenes is to stay small.
constexpr double max_poses = 20e3;  // bytes
constexpr double max_frames = 200;
// Bodies of a scene that is run with more iterations, too.
constexpr double max_moving = 12;

// Records the engine that it drives.
class Recorded : public Engine {
 public:
  Recorded(std::unique_ptr<Engine> engine, const pintle::RecorderOptions& options)
      : engine_(std::move(engine)), recorder_(*engine_->bullet_world(), options) {}

  void drive(double time, double length) override { engine_->drive(time, length); }
  void step(double length) override {
    recorder_.begin();
    engine_->step(length);
    recorder_.step();
  }
  engines::State state(int body) const override { return engine_->state(body); }
  int rows() const override { return engine_->rows(); }
  bool broken(int joint) const override { return engine_->broken(joint); }
  pintle::Recorder& recorder() { return recorder_; }

 private:
  std::unique_ptr<Engine> engine_;
  pintle::Recorder recorder_;
};

// A contender as it is shown.
struct Kind {
  const char *contender, *name;
  int iterations;
  const char* detail;
};
const Kind kinds[] = {
    {"stock", "stock", 10, "Bullet's joints, sequential impulses, 10 iterations"},
    {"pintle", "pintle", 10, "Pintle's joints, sequential impulses, 10 iterations"},
    {"exact", "exact", 10, "Pintle's joints on ExactJointSolver"},
    {"multibody", "multibody", 10, "btMultiBody, reduced coordinates"},
    {"stock", "stock, 50 iterations", 50, "Bullet's joints, sequential impulses, 50 iterations"},
    {"pintle", "pintle, 50 iterations", 50, "Pintle's joints, sequential impulses, 50 iterations"},
};

struct Words {
  const char *label, *unit;
};
Words words(scenes::Error error) {
  switch (error) {
    case scenes::Error::gap: return {"gap, mean of the worst", "m"};
    case scenes::Error::axis: return {"angle off, mean of the worst", "rad"};
    case scenes::Error::overshoot: return {"beyond a limit, most", "rad"};
    case scenes::Error::energy: return {"energy, largest change", "relative"};
    case scenes::Error::gained: return {"energy, largest gain", "relative"};
    case scenes::Error::momentum: return {"momentum, largest change", "relative"};
    case scenes::Error::trajectory: return {"distance from the true path", "m"};
    case scenes::Error::recovery: return {"time to come together", "s"};
    case scenes::Error::count: break;
  }
  return {"", ""};
}

double moving(const Scene& scene) {
  double count = 0;
  for (const scenes::Body& body : scene.bodies) count += body.mass > 0 ? 1 : 0;
  return count;
}

// A rate at which the poses of what moves have room.
double frame_rate(const Scene& scene) {
  const double frames = std::min(max_frames, max_poses / (28 * moving(scene)));
  const double wanted = frames / scene.seconds;
  for (const double rate : {60., 30., 20.}) {
    if (wanted >= rate) return rate;
  }
  return 15;
}

std::string headline(const Scene& scene) {
  return scene.headline.empty() ? scene.name : scene.headline;
}

std::string description(const Scene& scene) {
  const std::string text = scene.text.empty() ? scene.title + "." : scene.text;
  if (engines::find_contender("stock")->can_express(scene)) return text;
  return text + " Bullet has no such joint: there is no stock run.";
}

using Runs = std::vector<std::unique_ptr<Recorded>>;

// On a line of its own. (Names hold nothing that JSON would have to escape.)
void write_figure(std::ostream& out, const Scene& scene, const Kind& kind, const Words& of,
                  double value) {
  out << R"({"precision": ")" << engines::precision() << R"(", "scene": ")" << scene.name
      << R"(", "who": ")" << kind.name << R"(", "quantity": ")" << of.label << R"(", "unit": ")"
      << of.unit << R"(", "value": )";
  write_json_number(out, value);
  out << '}';
}

void record(const Scene& scene, const Kind& kind, Runs& runs, JsonArray& figures) {
  const engines::Contender& contender = *engines::find_contender(kind.contender);
  // Where more work would lessen its errors, or to play with it; but for what is large.
  const bool more = contender.iterates_in(scene) && moving(scene) <= max_moving &&
                    (scene.compared == scenes::Compared::over_all_settings ||
                     scene.group == scenes::Group::known);
  if (kind.iterations != 10 && !more) return;
  std::unique_ptr<Engine> engine = contender.make(scene, kind.iterations);
  if (!engine || engine->bullet_world() == nullptr) return;
  pintle::RecorderOptions options;
  options.name = kind.name;
  options.scene = scene.name;
  options.title = headline(scene);
  options.text = scene.text;
  options.group = name(scene.group);
  options.detail = kind.detail;
  options.colour = contender.colour;
  options.frames_per_second = frame_rate(scene);
  options.measure_forces = true;
  runs.push_back(std::make_unique<Recorded>(std::move(engine), options));
  Recorded& recorded = *runs.back();
  const measures::Outcome outcome = measures::run(scene, recorded, dt);
  const auto note = [&](const Words& of, double value) {
    recorded.recorder().addFigure(of.label, of.unit, value);
    if (figures.is_open()) write_figure(figures.next(), scene, kind, of, value);
  };
  for (const scenes::Error error : scene.errors) note(words(error), outcome[error]);
  note({"time of a step", "us"}, 1e6 * outcome.seconds / outcome.steps);
}

// By groups, each in the catalog's order.
std::vector<Scene> gallery() {
  std::vector<Scene> all = scenes::catalog();
  std::stable_sort(all.begin(), all.end(),
                   [](const Scene& a, const Scene& b) { return a.group < b.group; });
  return all;
}

struct Options {
  std::string page, form, json;
  std::vector<std::string> scenes, contenders;  // empty: all

  static bool has(const std::vector<std::string>& chosen, const std::string& name) {
    return chosen.empty() || std::find(chosen.begin(), chosen.end(), name) != chosen.end();
  }
};

void write(const Options& options, std::vector<Scene> scenes) {
  const auto is_left_out = [&](const Scene& scene) {
    return options.scenes.empty() ? !scene.in_gallery : !Options::has(options.scenes, scene.name);
  };
  scenes.erase(std::remove_if(scenes.begin(), scenes.end(), is_left_out), scenes.end());
  JsonArray figures;
  if (!options.json.empty() && !figures.open(options.json, 9))
    throw std::runtime_error("--json: cannot write " + options.json);
  Progress progress(double(scenes.size()));
  Runs runs;
  for (Scene& scene : scenes) {
    scene.text = description(scene);
    for (const Kind& kind : kinds) {
      if (Options::has(options.contenders, kind.contender)) record(scene, kind, runs, figures);
    }
    progress.advance(1, scene.name);
  }
  if (!figures.close()) throw std::runtime_error("--json: a file could not be written to its end");
  pintle::Recordings recordings;
  for (const auto& recorded : runs) recordings.push_back(recorded->recorder());
  pintle::writePage(options.page, recordings, options.form);
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<Scene> all = gallery();
  std::vector<std::string> names;
  std::set<std::string> contenders;
  for (const Scene& scene : all) names.push_back(scene.name);
  for (const Kind& kind : kinds) contenders.insert(kind.contender);

  Options options;
  bool list = false;
  CLI::App app("Writes the gallery of scenes as one page.");
  app.add_option("page", options.page, "The file that is written");
  app.add_option("--template", options.form, "The page without recordings, as it is built")
      ->check(CLI::ExistingFile);
  app.add_option("--scene", options.scenes,
                 "Only this scene; may be given more than once\n"
                 "(without it: all but some large ones)")
      ->check(CLI::IsMember(names))
      ->allow_extra_args(false);
  app.add_option("--contender", options.contenders,
                 "Only this contender; may be given more than once")
      ->check(CLI::IsMember(contenders))
      ->allow_extra_args(false);
  app.add_option("--json", options.json,
                 "Also write the figures of every run as an array of objects\n"
                 "(null: never reached, or lost)");
  app.add_flag("--list", list, "Name the scenes, and run nothing");
  CLI11_PARSE(app, argc, argv);

  if (list) {
    for (const Scene& scene : all)
      std::printf("%-20s %s\n", scene.name.c_str(), headline(scene).c_str());
    return EXIT_SUCCESS;
  }
  if (options.page.empty()) {
    std::fprintf(stderr, "page is required: the file that is written\n");
    return EXIT_FAILURE;
  }
  try {
    write(options, all);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
