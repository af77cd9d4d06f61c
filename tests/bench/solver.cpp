// The exact solver beside Bullet's, with its default settings: what joints lack, what energy does, and
// what a step takes. Times are those of whole steps, in runs that took turns, the shortest of them; read
// their ratios. Usage: solver [--page FOLDER] [chains|scaling|grid|crowd|motors|tangles]...
//   --page FOLDER   also the tables of plugin/docs/exact-solver.md, a file each (solver.sh)
//   solver steps chain|tree JOINTS stock|exact STEPS   runs one of scaling's, for an instruction counter (linear.sh)
//   solver scene NAME stock|exact|least STEPS   runs one of crowd's, or chain, for the same (flops.sh), and prints its number of joints
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "solver_bench.h"

int main(int argc, char** argv) {
  using namespace solver_bench;
  if (argc == 6 && std::strcmp(argv[1], "steps") == 0) {
    step(argv[2], std::atoi(argv[3]), std::strcmp(argv[4], "exact") == 0, std::atoi(argv[5]));
    return 0;
  }
  if (argc == 5 && std::strcmp(argv[1], "scene") == 0) {
    std::printf("%d\n", stepScene(argv[2], argv[3], std::atoi(argv[4])));
    return 0;
  }
  const struct {
    const char* name;
    void (*run)();
  } parts[] = {{"chains", chains}, {"scaling", scaling}, {"grid", grid},
               {"crowd", crowd},   {"motors", motors},   {"tangles", tangles}};
  const bool has_page = argc > 2 && std::strcmp(argv[1], "--page") == 0;
  const int first = has_page ? 3 : 1;
  std::printf("%s precision\n", sizeof(btScalar) == sizeof(double) ? "double" : "single");
  for (const auto& part : parts) {
    bool wanted = argc == first;
    for (int i = first; i < argc; ++i) wanted = wanted || std::strcmp(argv[i], part.name) == 0;
    if (wanted) part.run();
  }
  if (!has_page) return 0;
  for (const bench::PageTable* table : {&holds, &moves, &wild, &cost, &nets})
    if (!table->write(argv[2])) {
      std::fprintf(stderr, "solver: cannot write to %s\n", argv[2]);
      return 1;
    }
  return 0;
}
