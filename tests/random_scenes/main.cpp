// Plays random scenes, and prints those whose joints add energy, or that do not hold.
// Usage: random_scenes COUNT [FIRST [all]]  scenes FIRST (1 unless given) to FIRST + COUNT - 1; all: prints every one
//        random_scenes show SEED [WHAT] one scene, step by step; WHAT: `soft_stops` or `heavy_load_on_ropes` (random_scene.h), or all
//                                       its joints are of the kind of that number; or `driven`
//        random_scenes driven COUNT [FIRST [all]]  the same of machines among contacts (driven_scene.h), against Bullet's solver
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <iterator>
#include <string>

#include "../unit/either_world.h"
#include "driven_scene.h"
#include "random_joints.h"
#include "random_scene.h"

namespace {

using random_scenes::Outcome;

struct Counts {
  unsigned scenes = 0, failed = 0, by_velocities = 0, by_poses = 0, jumps = 0, infinite = 0;
  unsigned open_starts = 0, lifted = 0;
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
              << part(out.by_velocities) << " %, and may lift " << part(out.lift) << " %";
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
            << n.not_converged << " of " << n.steps << " steps did not converge\n";
}

random_scenes::Scene sceneOf(unsigned seed, const std::string& what) {
  if (what == "soft_stops") return random_scenes::withSoftStops(seed);
  if (what == "heavy_load_on_ropes") return random_scenes::withHeavyLoadOnRopes(seed);
  random_scenes::Scene scene = random_scenes::makeScene(seed);
  if (!what.empty())
    scene.kind = std::clamp(std::atoi(what.c_str()), 0, random_scenes::kindCount() - 1);
  return scene;
}

// The scenes of a family that each contender fails.
struct DrivenCounts {
  unsigned scenes = 0, failed[std::size(support::on_exact)] = {};
};

int playDriven(unsigned first, unsigned count, bool all) {
  DrivenCounts counts[random_scenes::family_count];
  bool sound = true;
  for (unsigned seed = first; seed < first + count; ++seed) {
    const random_scenes::DrivenScene scene = random_scenes::makeDriven(seed);
    const random_scenes::DrivenOutcome of_stock = random_scenes::play(scene, support::stock);
    DrivenCounts& of_family = counts[int(scene.family)];
    ++of_family.scenes;
    for (size_t i = 0; i < std::size(support::on_exact); ++i) {
      const support::Contender& contender = support::on_exact[i];
      const random_scenes::DrivenOutcome out = random_scenes::play(scene, contender);
      const std::string fault = random_scenes::faultOf(scene, of_stock, out);
      of_family.failed[i] += !fault.empty();
      sound = sound && fault.empty();
      if (fault.empty() && !all) continue;
      std::cout << random_scenes::describe(scene) << "\n    " << contender.name << ": "
                << (fault.empty() ? "is sound" : fault) << "; depth " << out.depth << " (Bullet's "
                << of_stock.depth << "), gain " << out.gain << " of " << out.peak << " J (Bullet's "
                << of_stock.gain << " of " << of_stock.peak << "), fastest " << out.fastest
                << " m/s (Bullet's " << of_stock.fastest << ')' << std::endl;
    }
  }
  for (int i = 0; i < random_scenes::family_count; ++i) {
    std::cout << random_scenes::nameOf(random_scenes::Family(i)) << ": of " << counts[i].scenes
              << " scenes fail";
    for (size_t k = 0; k < std::size(support::on_exact); ++k)
      std::cout << (k > 0 ? ", " : " ") << counts[i].failed[k] << " of "
                << support::on_exact[k].name;
    std::cout << '\n';
  }
  return !sound;
}

void showDriven(unsigned seed) {
  const random_scenes::DrivenScene scene = random_scenes::makeDriven(seed);
  std::cout << random_scenes::describe(scene) << '\n';
  const auto show = [&](const support::Contender& contender) {
    std::cout << contender.name << '\n';
    random_scenes::play(scene, contender, &std::cout);
  };
  show(support::stock);
  for (const support::Contender& contender : support::on_exact) show(contender);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4 && std::strcmp(argv[1], "show") == 0 && std::strcmp(argv[3], "driven") == 0) {
    showDriven(unsigned(std::atol(argv[2])));
    return 0;
  }
  if (argc >= 3 && argc <= 5 && std::strcmp(argv[1], "driven") == 0)
    return playDriven(argc > 3 ? unsigned(std::atol(argv[3])) : 1, unsigned(std::atol(argv[2])),
                      argc > 4);
  if ((argc == 3 || argc == 4) && std::strcmp(argv[1], "show") == 0) {
    const random_scenes::Scene scene =
        sceneOf(unsigned(std::atol(argv[2])), argc == 4 ? argv[3] : "");
    std::cout << random_scenes::describe(scene) << '\n';
    random_scenes::play(scene, &std::cout);
    return 0;
  }
  if (argc < 2 || argc > 4) {
    std::cerr
        << "usage: random_scenes [driven] COUNT [FIRST [all]] | random_scenes show SEED [WHAT]\n";
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
