// Random scenes of joints without drives, of which springs store nothing at the start: whatever they are, their energy must not grow.
// A scene follows from its seed alone.
#pragma once

#include <iosfwd>
#include <string>

#include "random_joints.h"

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
  bool rubs;         ///< joints have friction
  double threshold;  ///< N s at which joints break; 0: never
  bool locks;        ///< some factors of bodies are 0
  bool kinematic;    ///< what does not move is kinematic, not static
  double overlap;    ///< m by which bodies start away from where their joints hold them
  // Joints may have their own, and not those of the world.
  bool has_own;
  double own_erp, own_cfm, own_stop_erp, own_stop_cfm;
  Variant variant;  ///< of its joints
};
Scene makeScene(unsigned seed);
/// The same, with stops that give.
Scene withSoftStops(unsigned seed);
/// A tree or a chain of light bodies on ropes, under 10^5 times their mass, at 30 Hz.
Scene withHeavyLoadOnRopes(unsigned seed);
std::string describe(const Scene& scene);

struct Outcome {
  double gain = 0;  ///< J: the most that energy rose above its start, kinetic and of height
  /// J: of it what moving poses does not explain. (Where velocities belong to poses, these move by more or less than velocities lead: over time
  /// that is neither given nor taken.)
  double by_velocities = 0;
  double peak = 0;  ///< J: the largest kinetic energy
  /// J: what a start may lift that is open, or whose bodies are in each other: all its weight by all of that. Moving poses closes
  /// it, and velocities cannot pay where nothing moves yet.
  double lift = 0;
  double open = 0;  ///< m or rad: the most that an equality was open, where all starts closed
  double jump = 0;  ///< m: the most that a body was moved in a step beside its velocity
  int steps = 0, not_converged = 0;
  bool finite = true;

  static constexpr double share = 0.01;  ///< of `peak`
  static constexpr double most_jump = 10;
  double mayGain() const { return share * peak + lift; }
  double mayGainByVelocities() const { return share * peak; }
  bool isPassive() const {
    return finite && gain <= mayGain() && by_velocities <= mayGainByVelocities();
  }
  bool isSound() const { return isPassive() && jump <= most_jump; }
};
/// Two seconds of it, at most 300 steps, and none after the last joint has broken. `log`: a line a step, of energies and of what the solver did.
Outcome play(const Scene& scene, std::ostream* log = nullptr);

}  // namespace random_scenes
