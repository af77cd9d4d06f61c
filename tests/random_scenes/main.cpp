// Plays random scenes, and prints those of which joints feed energy, or that do not hold.
// Usage: random_scenes COUNT [FIRST [all]]  scenes FIRST (1 unless given) to FIRST + COUNT - 1; all: prints every one
//        random_scenes show SEED [WHAT] one scene, step by step; WHAT: `soft_stops` or `heavy_load_on_ropes` (random_scene.h), or all
//                                       its joints are of the kind of that number
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <string>

#include "random_joints.h"
#include "random_scene.h"

namespace {

using random_scenes::Outcome;

struct Counts {
  unsigned scenes = 0, failed = 0, by_velocities = 0, by_poses = 0, jumps = 0, infinite = 0;
  unsigned open_starts = 0, lifted = 0, turned = 0;
  long steps = 0, not_converged = 0;
  double most_lift = 0;  ///< of what an open start may lift

  void add(const Outcome& out) {
    ++scenes;
    failed += !out.isSound();
    steps += out.steps;
    not_converged += out.not_converged;
    infinite += !out.finite;
    open_starts += out.lift > 0;
    if (!out.finite) return;
    const bool by_velocity = out.by_velocities > out.mayGainByVelocities();
    by_velocities += by_velocity;
    by_poses += !by_velocity && out.gain > out.mayGain();
    jumps += out.jump > Outcome::most_jump;
    turned += out.by_turns > Outcome::share * out.peak;
    const double lift = out.gain - Outcome::share * out.peak;
    if (out.lift > 0 && lift > 0) {
      ++lifted;
      if (out.isPassive()) most_lift = std::max(most_lift, lift / out.lift);
    }
  }
};

void print(const random_scenes::Scene& scene, const Outcome& out) {
  const auto part = [&](double energy) { return 100 * energy / out.peak; };
  std::cout << random_scenes::describe(scene) << "\n    ";
  if (out.finite)
    std::cout << "gains " << part(out.gain) << " % of " << out.peak << " J, by velocities alone "
              << part(out.by_velocities) << " %, and may lift " << part(out.lift)
              << " %; turning poses adds " << part(out.by_turns) << " %";
  else
    std::cout << "is not finite after " << out.steps << " steps";
  std::cout << "; open " << out.open << ", moved " << out.jump << ", " << out.not_converged
            << " of " << out.steps << " steps did not converge" << std::endl;
}

void print(const Counts& n) {
  std::cout << n.failed << " of " << n.scenes << " scenes fail: " << n.by_velocities
            << " gain by velocities, " << n.by_poses << " by moving poses, " << n.jumps
            << " move a body by more than " << Outcome::most_jump << " m in a step, " << n.infinite
            << " are not finite\n"
            << n.open_starts << " start open, or in each other: " << n.lifted
            << " of them gain by closing, at most " << 100 * n.most_lift << " % of what they may\n"
            << "turning poses adds more than " << 100 * Outcome::share << " % in " << n.turned
            << "; " << n.not_converged << " of " << n.steps << " steps did not converge\n";
}

random_scenes::Scene sceneOf(unsigned seed, const std::string& what) {
  if (what == "soft_stops") return random_scenes::withSoftStops(seed);
  if (what == "heavy_load_on_ropes") return random_scenes::withHeavyLoadOnRopes(seed);
  random_scenes::Scene scene = random_scenes::makeScene(seed);
  if (!what.empty())
    scene.kind = std::clamp(std::atoi(what.c_str()), 0, random_scenes::kindCount() - 1);
  return scene;
}

}  // namespace

int main(int argc, char** argv) {
  if ((argc == 3 || argc == 4) && std::strcmp(argv[1], "show") == 0) {
    const random_scenes::Scene scene =
        sceneOf(unsigned(std::atol(argv[2])), argc == 4 ? argv[3] : "");
    std::cout << random_scenes::describe(scene) << '\n';
    random_scenes::play(scene, &std::cout);
    return 0;
  }
  if (argc < 2 || argc > 4) {
    std::cerr << "usage: random_scenes COUNT [FIRST [all]] | random_scenes show SEED [WHAT]\n";
    return 2;
  }
  const unsigned count = unsigned(std::atol(argv[1])),
                 first = argc > 2 ? unsigned(std::atol(argv[2])) : 1;
  Counts counts;
  for (unsigned seed = first; seed < first + count; ++seed) {
    const random_scenes::Scene scene = random_scenes::makeScene(seed);
    const Outcome out = random_scenes::play(scene);
    counts.add(out);
    if (!out.isSound() || argc > 3) print(scene, out);
  }
  print(counts);
  return counts.failed > 0;
}
