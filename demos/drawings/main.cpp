// Writes the joints' drawings, as SVG, into a folder (bash demos/run.sh drawings).
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "joints.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
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
