// Random scenes of joints without motors and springs: whatever they are, their energy must not grow. A scene follows from its
// seed alone.
#pragma once

#include <iosfwd>
#include <string>

namespace random_scenes {

enum class Shape { chain, tree, loop, cable, net, star };

/// What a seed makes. Printed, it says all that matters.
struct Scene {
  unsigned seed;
  Shape shape;
  int kind;  ///< of its joints; -1: each its own
  int bodies;
  double hz;
  double mass_decades;  ///< masses from 10^-x to 10^x kg
  double load;          ///< times the mass of the last body
  double speed;         ///< m/s and rad/s
  double erp, cfm;
  bool contacts, friction;
  double threshold;  ///< N s at which joints break; 0: never
  bool locks;        ///< some factors of bodies are 0
  bool kinematic;    ///< what does not move is kinematic, not static
  double overlap;    ///< m by which bodies start away from where their joints hold them
};
Scene makeScene(unsigned seed);
std::string describe(const Scene& scene);

struct Outcome {
  double gain = 0;  ///< J: the most that energy rose above its start
  double peak = 0;  ///< J: the largest kinetic energy
  double open = 0;  ///< m or rad: the most that an equality was open, where all starts closed
  double jump = 0;  ///< m: the most that a body was moved in a step beside its velocity
  int steps = 0, not_converged = 0;
  bool finite = true;
};
/// Two seconds of it, at most 300 steps. `log`: a line a step, of energies and of what the solver did.
Outcome play(const Scene& scene, std::ostream* log = nullptr);

}  // namespace random_scenes
