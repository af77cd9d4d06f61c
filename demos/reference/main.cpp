// Writes the stored solutions again: of the scenes that are named, or of all that need one.

#include <cstdio>
#include <cstring>
#include <string>

#include "../scenes/catalog.h"
#include "stored.h"

int main(int argc, char** argv) {
  const auto named = [&](const std::string& scene) {
    if (argc == 1) return true;
    for (int i = 1; i < argc; ++i) {
      if (scene == argv[i]) return true;
    }
    return false;
  };
  for (const scenes::Scene& scene : scenes::catalog()) {
    if (!scene.has(scenes::Error::trajectory) || scene.closed_form || !named(scene.name)) continue;
    std::printf("%s...\n", scene.name.c_str());
    std::fflush(stdout);
    // What spins fast needs the smaller steps.
    reference::store(scene, scene.name == "top" ? 5e-5 : 2e-4);
  }
}
