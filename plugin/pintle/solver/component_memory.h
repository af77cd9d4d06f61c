// Purpose: what a solver keeps of a component of joints from step to step: the order and memory of its equations, the impulses and
// changes of velocity with which the next step begins, and its energies.
#pragma once

#include <pintle/solver/energy_ledger.h>
#include <pintle/solver/newton.h>

#include <memory>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct ComponentMemory {
  std::vector<btTypedConstraint*> constraints;
  std::vector<std::array<int, 2>> bodies;  ///< of each, counted from the component's first
  Fronts fronts;
  JointMatrix K;
  bool is_used = false;        ///< in this step
  bool is_K_of_start = false;  ///< K is that of the chord, with which the step was solved
  Workspace work;
  EnergyLedger ledger;
  double work_done = 0;  ///< J: by its joints, in this step

  /// Where Newton's iteration begins: velocities and impulses of work.now.
  void begin(const Island& island, const Component& component);
  /// Springs of soft rows pull by what they are stretched.
  void stretchSprings(Island& island, const Component& component);
  /// work.stiffness: of the first tier, what is added to the inertia so that bodies swing no faster than is stable.
  void findStiffness(const Island& island, const Component& component, double stable_swing);
  /// The step as it has ended.
  void keep(const Island& island, const Component& component);
  /// The next step begins anew.
  void forget();

 private:
  struct Stretch {
    double length = 0, energy = 0;
  };

  /// Of joint c, the rows that it had in the last step, too: all, or its equalities, which come first.
  int knownRows(int c, const IslandJoint& joint) const;

  std::vector<int> m_rows;                         ///< of each joint, in the last step
  std::vector<double> m_lambda;                    ///< of each row of it
  std::vector<Stretch> m_stretch, m_last_stretch;  ///< of each row's spring
  std::vector<Vector6d> m_change;                  ///< of each body's velocity
};

/// Makes `memory` that of these joints, if it is not: symbolic work, which allocates.
void remember(const Island& island, const Component& component,
              std::unique_ptr<ComponentMemory>& memory);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
