// Purpose: what joints may take and give. A component keeps in mind what they did to its energy in the tier of the start's rows,
// which is exact for motions that the steps resolve and feeds those that they do not; where they would have given more than a
// share of its kinetic energy, the step is solved by the discrete gradient, which cannot give.
#pragma once

#include <pintle/solver/island.h>
#include <pintle/solver/iterate.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct EnergyLedger {
  double given = 0;  ///< J: by the joints, so far
  double peak = 0;   ///< J: the largest recent kinetic energy

  double with_forces = 0;  ///< J: the kinetic energy to which forces alone would lead

  void begin(const Island& island, const Component& component, double share);
  bool mayGive(double work, double share) const { return given + work <= share * peak; }
  /// More than rounding, of what never gives: the discrete gradient, from the velocities that forces lead to.
  bool isMuch(double work, double share) const { return !(work <= share * largest()); }
  double largest() const { return std::fmax(peak, with_forces); }
  void book(double work, double share) { given = std::fmax(-share * peak, given + work); }
};

/// J: kinetic energy from one velocity to another.
double gainOf(const IslandBody& body, const Vector6d& from, const Vector6d& to);
/// J: what joints gave to the velocities of the iterate, without motors, springs and friction: all that bodies have gained but for
/// their forces.
double workOfJoints(const Island& island, const Component& component, const Iterate& at);
/// What all impulses gave, those of contacts, too, to the velocities that forces lead to: KE(v) - KE(v*). Without motors, springs
/// and friction again.
double gainOverForces(const Island& island, const Component& component, const Iterate& at);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
