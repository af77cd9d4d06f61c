// Writes the stored solutions again: of the scenes that are named, or of all that need one.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "../progress.h"
#include "../scenes/catalog.h"
#include "stored.h"

int main(int argc, char** argv) {
  std::vector<scenes::Scene> stored;
  std::vector<std::string> all, chosen;
  for (const scenes::Scene& scene : scenes::catalog()) {
    if (!scene.has(scenes::Error::trajectory) || scene.closed_form) continue;
    stored.push_back(scene);
    all.push_back(scene.name);
  }
  bool list = false;
  CLI::App app("Solves the stored reference solutions again.");
  app.add_option("scenes,--scene", chosen, "Only these scenes")->check(CLI::IsMember(all));
  app.add_flag("--list", list, "Name the scenes, and solve nothing");
  CLI11_PARSE(app, argc, argv);
  if (list) {
    for (const std::string& name : all) std::printf("%s\n", name.c_str());
    return 0;
  }
  if (chosen.empty()) chosen = all;
  Progress progress(double(chosen.size()));
  for (const scenes::Scene& scene : stored) {
    if (std::find(chosen.begin(), chosen.end(), scene.name) == chosen.end()) continue;
    progress.clear();
    std::printf("%s...\n", scene.name.c_str());
    std::fflush(stdout);
    // What spins fast needs the smaller steps.
    reference::store(scene, scene.name == "top" ? 5e-5 : 2e-4);
    progress.advance(1, scene.name);
  }
}
