// Makes the report of what was measured: tables in Markdown, and the data of the plots.
//   summary OUT INSTRUCTIONS CSV...

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "../json_array.h"
#include "../scenes/catalog.h"
#include "results.h"
#include "step_errors.h"

namespace {

using report::number;
using report::Point;
using report::precisions;
using report::Ratio;
using report::Results;
using report::rounding;
using report::Row;
using report::StepErrors;
using scenes::Error;
using scenes::Scene;

std::string verdict(const Ratio& ratio) {
  // Times differ by a few percent from run to run, and the errors with them.
  constexpr double same = 1.05;
  if (ratio.max <= same && ratio.min >= 1 / same) return "even";
  if (ratio.max <= same) return "wins";
  if (ratio.mean < 1 / same) return "wins in the mean";
  return ratio.mean <= same ? "even in the mean" : "**loses**";
}

std::string share(const Ratio& ratio) {
  return ratio.share < 1 ? " (at " + number(100 * ratio.share) + " %)" : "";
}

// Of scenes and precisions, by the first error of each.
struct Score {
  int scenes = 0, never_above_stock = 0, in_the_mean = 0, tenth = 0;
  void count(const Ratio& errors) {
    ++scenes;
    never_above_stock += errors.max <= 1.05;
    in_the_mean += errors.mean <= 1.05;
    tenth += errors.mean <= 0.1;
  }
};

std::string range(const Ratio& errors) {
  return number(errors.mean) + " (" + number(errors.min) + " to " + number(errors.max) + ")";
}

std::string emphasized(bool first, Error error) {
  return first ? std::string("**") + name(error) + "**" : name(error);
}

// A contender against another one: a line for a scene and error.
Score compare(std::ostream& out, const Results& results, const std::vector<Scene>& all,
              const std::string& ours, const std::string& stock, bool first_errors_only) {
  Score score;
  out << "| scene | error | precision | error ratio at equal time: mean (least to most) "
      << "| time ratio at equal error | verdict |\n|---|---|---|---|---|---|\n";
  for (const Scene& scene : all) {
    for (const Error error : scene.errors) {
      const bool first = error == scene.errors.front();
      if (first_errors_only && !first) continue;
      for (const std::string& precision : precisions) {
        const auto theirs = results.front(precision, scene, error, stock);
        const auto own = results.front(precision, scene, error, ours);
        if (results.points(precision, scene, error, ours).empty() || theirs.empty()) continue;
        const Ratio errors = error_ratio(own, theirs), times = time_ratio(own, theirs);
        out << "| " << scene.name << " | " << emphasized(first, error) << " | " << precision
            << " | " << range(errors) << " | "
            << (times.share > 0 ? number(times.mean) + share(times) : "never as good") << " | "
            << verdict(errors) << " |\n";
        if (first) score.count(errors);
      }
    }
  }
  return score;
}

void print(std::ostream& out, const std::string& who, const Score& score) {
  out << "- " << who << ": nowhere above stock's at equal run time " << score.never_above_stock
      << ", not above it in the mean " << score.in_the_mean
      << ", at most a tenth of it in the mean " << score.tenth << '\n';
}

// Pintle's joints on Bullet's solver and on the exact one, both against stock. Where the first error
// is that of Bullet's steps, also the first of the joints' own.
void write_brief(std::ostream& out, const Results& results, const StepErrors& steps,
                 const std::vector<Scene>& all) {
  Score pintle_score, exact_score, better_score;
  std::string of_the_steps;
  out << "| scene | error | precision | pintle / stock | exact / stock | verdict, by the better of "
         "both "
         "|\n|---|---|---|---|---|---|\n";
  const auto write = [&](const Scene& scene, Error error, bool first) {
    for (const std::string& precision : precisions) {
      const auto stock = results.front(precision, scene, error, "stock");
      if (stock.empty()) continue;
      const auto ratio = [&](const char* ours) {
        return error_ratio(results.front(precision, scene, error, ours), stock);
      };
      const Ratio pintle = ratio("pintle"), exact = ratio("exact");
      const bool exact_is_better = exact.mean < pintle.mean;
      const Ratio& better = exact_is_better ? exact : pintle;
      out << "| " << scene.name << " | " << emphasized(first, error) << " | " << precision << " | "
          << range(pintle) << " | " << range(exact) << " | "
          << (exact_is_better ? "exact: " : "pintle: ") << verdict(better) << " |\n";
      if (!first) continue;
      pintle_score.count(pintle);
      exact_score.count(exact);
      better_score.count(better);
    }
  };
  for (const Scene& scene : all) {
    if (!results.has(scene, &Row::contender, "stock")) continue;
    const Error first = scene.errors.front();
    write(scene, first, true);
    if (first == Error::gap || !report::is_of_the_steps(results, steps, scene, first)) continue;
    of_the_steps += (of_the_steps.empty() ? "" : ", ") + scene.name;
    for (const Error own : {Error::gap, Error::axis}) {
      if (!scene.has(own)) continue;
      write(scene, own, false);
      break;
    }
  }
  out << "\nOf " << better_score.scenes
      << " scenes and precisions, by the first error of each, Pintle's joints\n\n";
  print(out, "on Bullet's solver (pintle)", pintle_score);
  print(out, "on `ExactJointSolver` (exact)", exact_score);
  print(out, "on the better one of both, scene by scene", better_score);
  if (!of_the_steps.empty())
    out << "\nIn " << of_the_steps
        << " the first error is that of Bullet's steps, which joints that leave nothing at all "
           "have as "
           "well (within a tenth, at every length of the step), and the joints' own error is given "
           "below it; what is below the steps' error is so by errors that cancel.\n";
}

constexpr const char* legend =
    "Run time is that of the steps alone, for a second of the scene; both sides choose their best "
    "iterations and step (Pareto fronts, straight between their points). A ratio below 1 is "
    "better. At equal time: the geometric mean over the times from where both have a result, and "
    "the range. At equal error: over the other side's errors, and the part of them that is reached "
    "at all. Errors below rounding (8 epsilon: 1e-6, 2e-15) count as that.";

const std::set<std::string> are_no_peers = {"stock", "document", "pintle", "exact", "second_order"};

void write_summary(std::ostream& out, const Results& results, const StepErrors& steps,
                   const std::vector<Scene>& all) {
  const auto& who = results.contenders();
  out << "# Error against run time\n\nBy `bash demos/run.sh report`. " << legend;
  const bool has_jolt = std::count(who.begin(), who.end(), "jolt") > 0;
  out << (has_jolt ? " Jolt computes in single, and in WebAssembly.\n\n" : "\n\n");
  for (const std::string& ours : who) {
    if (ours == "stock") continue;
    out << "\n## " << ours << " against stock\n\n";
    const Score score = compare(out, results, all, ours, "stock", false);
    out << "\nOf " << score.scenes << " scenes and precisions, by the first error of each:\n\n";
    print(out, ours, score);
  }
  for (const std::string& peer : who) {
    if (are_no_peers.count(peer) > 0) continue;
    for (const char* ours : {"pintle", "exact"}) {
      out << "\n## " << ours << " against " << peer << "\n\n";
      compare(out, results, all, ours, peer, true);
    }
  }
  report::write_steps(out, results, steps, all);
}

// Of a table with a column for each contender, behind those that are named.
void write_head(std::ostream& out, const std::vector<std::string>& named, const Results& results) {
  std::vector<std::string> columns = named;
  columns.insert(columns.end(), results.contenders().begin(), results.contenders().end());
  out << '|';
  for (const std::string& column : columns) out << ' ' << column << " |";
  out << "\n|";
  for (size_t i = 0; i < columns.size(); ++i) out << "---|";
}

void write_instructions(std::ostream& out, const std::string& path, const std::vector<Scene>& all,
                        const Results& results) {
  const auto counts = report::read_instructions(path);
  if (counts.empty()) return;
  out << "\n## Instructions of a step\n\nCallgrind, single precision, 60 Hz, 10 iterations, the "
         "mean over the first steps.\n\n";
  write_head(out, {"scene"}, results);
  for (const Scene& scene : all) {
    out << "\n| " << scene.name << " |";
    for (const std::string& who : results.contenders()) {
      const auto count = counts.find({scene.name, who});
      out << ' ' << (count == counts.end() ? "" : std::to_string(long(count->second))) << " |";
    }
  }
  out << '\n';
}

void write_scene(std::ostream& out, const Results& results, const Scene& scene) {
  out << "# " << scene.name << ": " << scene.title << "\n\n![plot](" << scene.name << ".svg)\n\n";
  for (const std::string& precision : precisions) {
    out << "\n## " << precision << " precision\n\n| contender | iterations | Hz | us a step | "
        << "ms a second |";
    for (const Error error : scene.errors) out << ' ' << name(error) << '/' << unit(error) << " |";
    out << "\n|---|---|---|---|---|";
    for (size_t i = 0; i < scene.errors.size(); ++i) out << "---|";
    for (const Row& row : results.rows()) {
      if (row.scene != scene.name || row.precision != precision) continue;
      out << "\n| " << row.contender << " | "
          << (row.iterations > 0 ? std::to_string(row.iterations) : "") << " | " << row.hz << " | "
          << number(row.microseconds, 3) << " | " << number(row.milliseconds_per_second(), 3)
          << " |";
      for (const Error error : scene.errors)
        out << ' ' << number(row.errors[size_t(error)]) << " |";
    }
    out << '\n';
  }
}

double minError(const std::vector<Point>& points) {
  double min = HUGE_VAL;
  for (const Point& point : points) min = std::min(min, point.error);
  return min;
}

bool is_rounding(const std::vector<Point>& points, const std::string& precision) {
  return std::all_of(points.begin(), points.end(),
                     [&](const Point& point) { return point.error <= rounding(precision); });
}

// Above rounding by more than this stock's errors would all be at the upper edge of a plot that goes down to it.
constexpr double far_above = 1e4;

// For plot.gp: the points of a contender, and after two empty lines its front.
void write_data(const std::string& folder, const Results& results, const Scene& scene) {
  for (const std::string& precision : precisions) {
    for (const Error error : scene.errors) {
      for (const std::string& who : results.contenders()) {
        std::ofstream data(folder + "/" + precision + "_" + name(error) + "_" + who + ".dat");
        const auto points = results.points(precision, scene, error, who);
        // Reduced coordinates leave no gap at all: nothing to draw, if that is far below the others.
        if (is_rounding(points, precision) &&
            minError(results.points(precision, scene, error, "stock")) >
                far_above * rounding(precision))
          continue;
        for (const Point& point : points) {
          if (std::isfinite(point.error)) data << point.time << ' ' << point.error << '\n';
        }
        data << "\n\n";
        for (const Point& point : report::pareto(points))
          data << point.time << ' ' << point.error << '\n';
      }
    }
  }
}

// Machines: every contender at the settings of a game.
void write_machines(std::ostream& out, const Results& results, const std::vector<Scene>& machines) {
  if (machines.empty()) return;
  out << "Machines at 60 Hz and 10 iterations, in double precision; times are those of a "
         "step. An empty field: the engine has no joint for it.\n\n";
  write_head(out, {"machine", "what"}, results);
  out << '\n';
  for (const Scene& scene : machines) {
    const auto write = [&](const std::string& what, auto value) {
      out << "| " << scene.name << " | " << what << " |";
      for (const std::string& who : results.contenders()) {
        out << ' ';
        for (const Row& row : results.rows()) {
          if (row.scene == scene.name && row.contender == who && row.precision == "double")
            out << value(row);
        }
        out << " |";
      }
      out << '\n';
    };
    for (const Error error : scene.errors)
      write(name(error) + std::string(" (") + unit(error) + ')',
            [&](const Row& row) { return number(row.errors[size_t(error)]); });
    write("time (us)", [](const Row& row) { return std::lround(row.microseconds); });
  }
}

// What is lost is null.
bool write_json(const std::string& path, const Results& results, const std::vector<Scene>& all) {
  JsonArray file;
  if (!file.open(path, 6)) return false;
  for (const Row& row : results.rows()) {
    const auto scene =
        std::find_if(all.begin(), all.end(), [&](const Scene& of) { return of.name == row.scene; });
    if (scene == all.end()) continue;
    std::ostream& out = file.next();
    out << R"({"precision": ")" << row.precision << R"(", "scene": ")" << row.scene
        << R"(", "contender": ")" << row.contender << R"(", "iterations": )" << row.iterations
        << R"(, "hz": )" << row.hz << R"(, "microseconds": )" << row.microseconds;
    for (const Error error : scene->errors) {
      out << ", \"" << name(error) << "\": ";
      write_json_number(out, row.errors[size_t(error)]);
    }
    out << '}';
  }
  return file.close();
}

}  // namespace

int main(int argc, char** argv) {
  std::string out, instructions, json;
  std::vector<std::string> files;
  CLI::App app("Writes the report's pages from what its runs have measured.");
  app.add_option("folder", out, "Where to")->required();
  app.add_option("instructions", instructions, "What callgrind has counted")->required();
  app.add_option("csv", files, "What the runs have measured")->required()->check(CLI::ExistingFile);
  app.add_option("--json", json,
                 "Also write all that was measured as an array of objects to this file");
  CLI11_PARSE(app, argc, argv);
  std::vector<Row> rows;
  for (const std::string& file : files) {
    const std::vector<Row> more = report::read(file);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  const Results results(rows);
  std::vector<Scene> all, measured, machines;
  for (const Scene& scene : scenes::catalog()) {
    if (std::none_of(rows.begin(), rows.end(),
                     [&](const Row& row) { return row.scene == scene.name; }))
      continue;
    all.push_back(scene);
    (scene.compared == scenes::Compared::as_games_run ? machines : measured).push_back(scene);
  }

  std::filesystem::create_directories(out);
  std::ofstream summary(out + "/summary.md");
  const StepErrors steps = report::errors_of_steps(results, measured);
  write_summary(summary, results, steps, measured);
  if (!machines.empty()) summary << "\n## Machines\n\n";
  write_machines(summary, results, machines);
  write_instructions(summary, instructions, all, results);
  std::ofstream brief(out + "/brief.md");  // for plugin/docs/benchmarks.md
  write_brief(brief, results, steps, measured);
  std::ofstream published(out + "/published.md"), of_machines(out + "/machines.md");
  report::write_published(published, results, steps, measured);
  write_machines(of_machines, results, machines);
  std::ofstream plots(out + "/plots.txt");  // scene|title|errors|units|contenders|precisions
  for (const Scene& scene : measured) {
    std::ofstream page(out + "/" + scene.name + ".md");
    write_scene(page, results, scene);
    const std::string data = out + "/data/" + scene.name;
    std::filesystem::create_directories(data);
    write_data(data, results, scene);
    plots << scene.name << '|' << scene.title << '|';
    for (const Error error : scene.errors) plots << name(error) << ' ';
    plots << '|';
    for (const Error error : scene.errors) plots << unit(error) << ' ';
    plots << '|';
    for (const std::string& who : results.contenders()) {
      if (results.has(scene, &Row::contender, who)) plots << who << ' ';
    }
    plots << '|';
    for (const std::string& precision : precisions) {
      if (results.has(scene, &Row::precision, precision)) plots << precision << ' ';
    }
    plots << '\n';
  }
  if (!json.empty() && !write_json(json, results, all))
    return std::fprintf(stderr, "--json: cannot write %s\n", json.c_str()), 1;
  if (!summary || !brief || !published || !of_machines || !plots)
    return std::fprintf(stderr, "cannot write %s\n", out.c_str()), 1;
}
