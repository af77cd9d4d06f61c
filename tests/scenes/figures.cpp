#include "figures.h"

#include <measures/run.h>
#include <scenes/catalog.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

namespace figures {
namespace {

std::string path() {
  return std::string(PINTLE_SOURCE_DIR) + "/tests/scenes/figures_" + engines::precision() + ".csv";
}

bool is_single() { return std::string(engines::precision()) == "single"; }

}  // namespace

Figures measure() {
  Figures figures;
  for (scenes::Scene scene : scenes::catalog()) {
    // Where bodies strike each other, or the solver is far from its solution, rounding soon decides
    // what follows.
    const bool chaotic = scene.contacts() || scene.name == "crane" || scene.name == "heavy_crane";
    scene.seconds = std::min(scene.seconds, chaotic ? 0.4 : 1.);
    scene.horizon = std::min(scene.horizon, scene.seconds);
    for (const char* who : {"document", "pintle", "exact"}) {
      const auto engine = engines::find_contender(who)->make(scene, 10);
      const measures::Outcome outcome = measures::run(scene, *engine, 1. / 60);
      const std::string prefix = scene.name + ',' + who + ',';
      // Those of what is nothing but a limit come and go with rounding.
      if (scene.joints[0].kind < scenes::Kind::angle) figures[prefix + "rows"] = outcome.rows;
      for (const scenes::Error error : scene.errors) figures[prefix + name(error)] = outcome[error];
      const scenes::Isometry3d& pose = outcome.end.back().pose;
      for (int i = 0; i < 3; ++i) {
        figures[prefix + "end position " + "xyz"[i]] = pose.translation()[i];
        figures[prefix + "end axis " + "xyz"[i]] = pose.linear()(i, 0);
      }
    }
  }
  return figures;
}

Figures read() {
  Figures figures;
  std::ifstream file(path());
  for (std::string line; std::getline(file, line);) {
    const size_t comma = line.rfind(',');
    if (comma == std::string::npos || line[0] == '#') continue;
    figures[line.substr(0, comma)] = std::stod(line.substr(comma + 1));
  }
  return figures;
}

void write(const Figures& figures) {
  std::ofstream file(path());
  file << "# By: bash tests/scenes/update.sh\n";
  file.precision(9);
  for (const auto& [name, value] : figures) file << name << ',' << value << '\n';
}

double tolerance() { return is_single() ? 1e-3 : 1e-6; }

std::vector<std::string> differences(const Figures& stored, const Figures& measured) {
  std::vector<std::string> lines;
  char text[160];
  for (const auto& [name, value] : measured) {
    const auto was = stored.find(name);
    if (was == stored.end()) {
      std::snprintf(text, sizeof text, "%s: new, %.9g", name.c_str(), value);
      lines.push_back(text);
      continue;
    }
    const double scale = std::max({std::abs(value), std::abs(was->second), 1e-3});
    // Written so that NaN differs; a lost run is infinite, and equal to a lost run.
    if (value == was->second || std::abs(value - was->second) <= tolerance() * scale) continue;
    std::snprintf(text, sizeof text, "%s: was %.9g, is %.9g", name.c_str(), was->second, value);
    lines.push_back(text);
  }
  for (const auto& [name, value] : stored) {
    if (measured.count(name) > 0) continue;
    std::snprintf(text, sizeof text, "%s: was %.9g, is gone", name.c_str(), value);
    lines.push_back(text);
  }
  return lines;
}

}  // namespace figures
