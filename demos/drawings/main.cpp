// Writes the joints' drawings, as SVG, into a folder (bash demos/run.sh drawings).
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "joints.h"

int main(int argc, char** argv) {
  std::filesystem::path folder;
  CLI::App app("Draws the joints, an SVG file each.");
  app.add_option("folder", folder, "Where to")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    std::filesystem::create_directories(folder);
    for (const drawings::Drawing& drawing : drawings::drawings()) {
      std::ofstream file(folder / (drawing.name + ".svg"), std::ios::binary);
      file << drawing.svg;
      if (!file.flush())
        throw std::runtime_error("cannot write " + (folder / drawing.name).string());
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
