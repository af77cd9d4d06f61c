// Purpose: what joints may give. A component books the work of its joints' impulses, and of poses that are moved against forces. The
// first tier is exact for motions that the steps resolve and feeds those that they do not: where it would give more than a share of
// the kinetic energy, the second tier follows. What that gives by moving poses is taken from the velocities.
//
// An impulse J^T lambda = M (v - v*) works along the mean velocity, at which the discrete gradient of the kinetic energy is (Gonzalez
// 1996); a pose that is moved by d, against the forces:
//   W = (v - v*) M (v + v_0) / 2 - (v* - v_0) M d / dt,   sum of W <= share * peak
#pragma once

#include <pintle/solver/constants.h>
#include <pintle/solver/system/workspace.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct EnergyLedger {
  double given = 0;  ///< J: by the joints, so far
  double peak =
      0;  ///< J: the largest recent kinetic energy that a step has left: not that of a blow which joints take at once
  double now = 0;          ///< J: the kinetic energy with which this step begins
  double rounding = 0;     ///< J: where joints gave more, what rounding of poses may have done
  double with_forces = 0;  ///< J: the kinetic energy to which forces alone would lead

  void begin(const Island& island, const Component& component, double share);
  /// J: what they may have given at the end of this step.
  double limit(double share) const {
    return share * std::fmax(peak, now) + rounding_of_work * with_forces;
  }
  /// J: what is beyond that.
  double excess(double work, double share) const { return given + work - limit(share); }
  double largest() const { return std::fmax(std::fmax(peak, now), with_forces); }
  /// `left`: the kinetic energy with which the step ends, J.
  void book(double work, double share, double left) {
    given = std::fmax(-share * peak, given + work);
    m_left = left;
  }

 private:
  double m_left = 0;  ///< J: the kinetic energy with which the last step ended
};

/// J: kinetic energy from one velocity to another.
double gainOf(const IslandBody& body, const Vector6d& from, const Vector6d& to);
/// J: of all bodies at v0 or v_free.
double kineticEnergy(const Island& island, const Component& component, Vector6d IslandBody::*v);
/// J: of all bodies at these velocities, which are those of the component.
double kineticEnergy(const Island& island, const Component& component,
                     const std::vector<Vector6d>& v);
/// J: what a limit takes that is met in this step, and may give back in the next one: until then it is not lost. `u`: of the row in the mean.
double keptForRebound(const Island& island, const Component& component, const IslandRow& row,
                      const Workspace& end, size_t r, double u);
/// The same of all rows.
double keptForRebounds(const Island& island, const Component& component, const Workspace& end);
/// J: what joints gave in the step, without motors, springs and friction: all that bodies have gained but by their forces.
double workOfJoints(const Island& island, const Component& component, const Workspace& end);
/// The same where contacts act, too: of the impulses of joints alone.
double workAmongContacts(const Island& island, const Component& component, const Workspace& end);
/// Joints neither add nor remove energy: only equalities act, and the step begins with velocities that satisfy them.
bool isEven(const Island& island, const Component& component, double tolerance,
            const Workspace& end);
/// J: what moving poses by `changes` does against the forces of the step.
double workOfPoses(const Island& island, const Component& component, const Vector6d* changes);
/// J: `excess`, or 0 where it is not more than what forces do while poses are rounded. That is in no book, until velocities, which take it,
/// or changes of poses, which give it, lead back: of a body at rest, the ledger forgets the first.
double beyondRounding(const Island& island, const Component& component, double excess,
                      EnergyLedger& ledger);
/// J: how much more joints gave with `work` than they may.
inline double excess(const Island& island, const Component& component, double work, double share,
                     EnergyLedger& ledger) {
  const double excess = ledger.excess(work, share);
  return excess > 0 ? beyondRounding(island, component, excess, ledger) : 0;
}
/// J: what all impulses gave, those of contacts, too, to the velocities that forces lead to: KE(v) - KE(v*). Without motors, springs
/// and friction again.
double gainOverForces(const Island& island, const Component& component, const Workspace& end);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
