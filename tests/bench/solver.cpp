// The exact solver beside Bullet's, with its default settings: what joints lack, what energy does, and
// what a step takes. Times are those of whole steps, in runs that took turns, the shortest of them; read
// their ratios. Usage: solver [--page FOLDER] [chains|scaling|grid|crowd|motors|tangles]...
//   --page FOLDER   also the tables of plugin/docs/exact-solver.md, a file each (solver.sh)
//   solver costs   lists the scenes of linear.sh
//   solver count NAME stock|exact   runs one of them, for an instruction counter, and prints its joints and steps
//   solver time NAME   prints its joints, and by stock's solver and by the exact one the time of a step, us, and the mean gap, m
//   solver scene NAME stock|exact|least STEPS   runs one of crowd's, or chain, for the same (flops.sh), and prints its number of joints
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "processor_time.h"
#include "solver_bench.h"

// It stands where nobody calls it, so that it is not inlined: callgrind knows it by its name.
void solver_bench::timedStep(const std::function<void()>& step, Measured& to) {
  const double before = bench::processorTime();
  step();
  to.times.push_back(bench::processorTime() - before);
  const auto steps = double(to.times.size());
  to.microseconds_per_step += (to.times.back() - to.microseconds_per_step) / steps;
}

int main(int argc, char** argv) {
  using namespace solver_bench;
  if (argc == 2 && std::strcmp(argv[1], "costs") == 0) {
    listCosts();
    return 0;
  }
  if (argc == 4 && std::strcmp(argv[1], "count") == 0)
    return countCost(argv[2], std::strcmp(argv[3], "exact") == 0) ? 0 : 1;
  if (argc == 3 && std::strcmp(argv[1], "time") == 0) return timeCost(argv[2]) ? 0 : 1;
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
