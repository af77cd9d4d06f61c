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

  void begin(double kinetic, double dt) {
    // It is forgotten within a second or so.
    peak = std::fmax(peak * (1 - dt), kinetic);
  }
  bool mayGive(double work, double share) const { return given + work <= share * peak; }
  void book(double work, double share) { given = std::fmax(-share * peak, given + work); }
};

double kineticEnergyOfStart(const Island& island, const Component& component);
/// J: what joints gave to the velocities of the iterate, without motors, springs and friction.
double workOfJoints(const Island& island, const Component& component, const Iterate& at);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
