// Random machines among contacts: motors and servos of any strength, linked bodies that collide, kinematic bodies that push jointed ones,
// restitution, limits in loops. They are played on Bullet's solver, too, which is the yardstick where something drives. A scene follows
// from its seed alone.
#pragma once

#include <iosfwd>
#include <string>

#include "../unit/either_world.h"

namespace random_scenes {

enum class Family {
  motors,    ///< against static, kinematic and dynamic bodies
  linked,    ///< bodies that overlap where they are joined, and collide there
  jammed,    ///< motors whose last link is wedged between static bodies
  pushed,    ///< by a kinematic body
  bouncing,  ///< restitution of up to 0.9
  elastic,   ///< restitution of 1
  loops,     ///< four-bars and rings of hinges with limits
};
constexpr int family_count = 7;
const char* nameOf(Family family);
std::ostream& operator<<(std::ostream& out, Family family);

/// The scene of a seed. Printed, it says all that matters.
struct DrivenScene {
  unsigned seed;
  Family family;
  double hz;
  int iterations;
  bool motors;      ///< joints have motors
  bool servos;      ///< they hold an angle or position
  double strength;  ///< N m s or N s: the most that a motor applies in a step
  int bodies;       ///< that joints hold
  double restitution, friction;

  /// A motor or a kinematic body may do work.
  bool isDriven() const { return motors || family == Family::pushed; }
};
/// The family is that of the seed's remainder by their number.
DrivenScene makeDriven(unsigned seed);
std::string describe(const DrivenScene& scene);

struct DrivenOutcome {
  double depth = 0;  ///< m: the deepest contact, of pairs that did not overlap at the start
  double gain =
      0;  ///< J: the most that velocities added to the energy above the start (energy_book.h)
  double peak = 0;     ///< J: the largest kinetic energy
  double fastest = 0;  ///< m/s
  bool finite = true;
};
/// Two seconds of it, at most 300 steps. `log`: a line a step.
DrivenOutcome play(const DrivenScene& scene, const support::Contender& contender,
                   std::ostream* log = nullptr);

/// The fault of a contender on the exact solver in a scene; empty: none. Without drives it must be passive; elastic, it
/// may gain as much as Bullet's. With drives no contact may be much deeper than Bullet's, and linked bodies that collide may have no
/// energy of another order.
std::string faultOf(const DrivenScene& scene, const DrivenOutcome& of_stock,
                    const DrivenOutcome& out);

}  // namespace random_scenes
