#include "step_errors.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <stdexcept>

#include "../reference/integrator.h"

namespace report {

using scenes::Error;
using scenes::Scene;

namespace {

// The least error of a contender in steps of that length, over all iterations; empty where it is not compared.
std::string least(const Results& results, const Scene& scene, Error error, const std::string& who,
                  int hz) {
  if (!results.has(scene, &Row::contender, who)) return "";
  return number(results.min_error(scene, error, who, hz));
}

}  // namespace

StepErrors errors_of_steps(const Results& results, const std::vector<Scene>& all) {
  StepErrors errors;
  for (const Scene& scene : all) {
    std::set<int> lengths;
    for (const Row& row : results.rows()) {
      if (row.scene == scene.name) lengths.insert(row.hz);
    }
    try {
      for (const int hz : lengths)
        errors[scene.name][hz] =
            measures::run(scene, *reference::make_bullet_steps(scene), 1. / hz).errors;
    } catch (const std::invalid_argument&) {
    }
  }
  return errors;
}

bool is_of_the_steps(const Results& results, const StepErrors& steps, const Scene& scene,
                     Error error) {
  const auto of_scene = steps.find(scene.name);
  if (of_scene == steps.end()) return false;
  const auto follow_the_steps = [&](const std::string& who) {
    return std::all_of(of_scene->second.begin(), of_scene->second.end(),
                       [&](const auto& hz_and_errors) {
                         constexpr double same = 1.1;
                         const auto& [hz, errors] = hz_and_errors;
                         const double ours = results.min_error(scene, error, who, hz);
                         const double of_steps = errors[size_t(error)];
                         return of_steps > 0 && ours < same * of_steps && of_steps < same * ours;
                       });
  };
  return follow_the_steps("pintle") || follow_the_steps("exact");
}

namespace {

constexpr const char* compared[] = {"stock", "pintle", "exact", "second_order"};

// Head of a table with a column for each of them.
void write_head(std::ostream& out, const char* first) {
  out << "| " << first << " | error | Hz | steps alone |";
  for (const char* who : compared) out << ' ' << who << " |";
  out << "\n|---|---|---|---|";
  for (size_t i = 0; i < std::size(compared); ++i) out << "---|";
  out << '\n';
}

}  // namespace

void write_steps(std::ostream& out, const Results& results, const StepErrors& steps,
                 const std::vector<Scene>& all) {
  out << "\n## What Bullet's steps alone leave\n\nBullet's own steps with joints that leave "
         "nothing "
         "(`demos/reference`), and the least error of each contender in steps of that length, over "
         "all iterations; double precision.\n\n";
  write_head(out, "scene");
  for (const Scene& scene : all) {
    const auto of_scene = steps.find(scene.name);
    if (of_scene == steps.end()) continue;
    for (const Error error : scene.errors) {
      if (error == Error::gap || error == Error::axis) continue;  // they leave none
      for (const auto& [hz, errors] : of_scene->second) {
        out << "| " << scene.name << " | " << name(error) << " | " << hz << " | "
            << number(errors[size_t(error)]) << " |";
        for (const char* who : compared)
          out << ' ' << least(results, scene, error, who, hz) << " |";
        out << '\n';
      }
    }
  }
}

void write_published(std::ostream& out, const Results& results, const StepErrors& steps,
                     const std::vector<Scene>& all) {
  std::ostringstream rows;
  for (const Scene& scene : all) {
    if (scene.problem.empty()) continue;
    std::set<int> lengths;
    for (const Row& row : results.rows())
      if (row.scene == scene.name && row.precision == "double") lengths.insert(row.hz);
    for (const Error error : scene.errors) {
      for (const int hz : lengths) {
        rows << "| " << scene.problem << ", " << scene.name << " | " << name(error) << " ("
             << unit(error) << ") | " << hz << " |";
        const auto of_scene = steps.find(scene.name);
        // Joints that leave nothing leave no gap.
        const bool of_steps =
            of_scene != steps.end() && error != Error::gap && error != Error::axis;
        rows << ' ' << (of_steps ? number(of_scene->second.at(hz)[size_t(error)]) : "") << " |";
        for (const char* who : compared)
          rows << ' ' << least(results, scene, error, who, hz) << " |";
        rows << '\n';
      }
    }
  }
  if (rows.str().empty()) return;
  out << "Of published problems the least error of each, over all iterations, in double "
         "precision; "
         "trajectories are against the stored references. The steps alone are Bullet's, with "
         "joints "
         "that leave nothing. An empty field: Bullet has no joint for it.\n\n";
  write_head(out, "problem");
  out << rows.str();
}

}  // namespace report
