// Plays random scenes, and prints those of which joints feed energy, or that do not hold.
// Usage: random_scenes COUNT [FIRST [all]]  scenes FIRST (1 unless given) to FIRST + COUNT - 1; all: prints every one
//        random_scenes show SEED        one scene, step by step
#include <cstdlib>
#include <cstring>
#include <iostream>

#include "random_scene.h"

int main(int argc, char** argv) {
  if (argc == 3 && std::strcmp(argv[1], "show") == 0) {
    const random_scenes::Scene scene = random_scenes::makeScene(unsigned(std::atol(argv[2])));
    std::cout << random_scenes::describe(scene) << '\n';
    random_scenes::play(scene, &std::cout);
    return 0;
  }
  if (argc < 2 || argc > 4) {
    std::cerr << "usage: random_scenes COUNT [FIRST [all]] | random_scenes show SEED\n";
    return 2;
  }
  const unsigned count = unsigned(std::atol(argv[1])),
                 first = argc > 2 ? unsigned(std::atol(argv[2])) : 1;
  unsigned failed = 0;
  long steps = 0, not_converged = 0;
  double worst = 0;
  for (unsigned seed = first; seed < first + count; ++seed) {
    const random_scenes::Scene scene = random_scenes::makeScene(seed);
    const random_scenes::Outcome out = random_scenes::play(scene);
    steps += out.steps;
    not_converged += out.not_converged;
    const double gain = out.gain / out.peak;
    const bool gains = !out.finite || gain > 0.01 || out.jump > 10;
    if (out.finite) worst = std::max(worst, gain);
    failed += gains;
    if (gains || argc > 3) {
      std::cout << random_scenes::describe(scene) << "\n    ";
      if (out.finite)
        std::cout << "gains " << 100 * gain << " % of " << out.peak << " J";
      else
        std::cout << "is not finite after " << out.steps << " steps";
      std::cout << ", open " << out.open << ", moved " << out.jump << ", " << out.not_converged
                << " of " << out.steps << " steps did not converge" << std::endl;
    }
  }
  std::cout << failed << " of " << count << " scenes fail; the worst gain is " << 100 * worst
            << " %; " << not_converged << " of " << steps << " steps did not converge\n";
  return failed > 0;
}
