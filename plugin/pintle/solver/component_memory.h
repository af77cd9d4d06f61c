// Purpose: what a solver keeps of a component of joints from step to step: the order and memory of its equations, the impulses and
// the forecast of velocities with which the next step begins, and its energies.
#pragma once

#include <pintle/solver/energy_ledger.h>
#include <pintle/solver/half_forces.h>
#include <pintle/solver/joint_matrix.h>
#include <pintle/solver/velocity_forecast.h>
#include <pintle/solver/workspace.h>

#include <memory>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct ComponentMemory {
  std::vector<btTypedConstraint*> constraints;
  std::vector<std::array<int, 2>> bodies;  ///< of each, counted from the component's first
  std::vector<char> in_loop;               ///< each joint
  std::vector<int> sizes;                  ///< of each: rows
  JointMatrix::Locks locks;                ///< of each body
  JointMatrix K;
  bool has_factor = false;       ///< K is that of the step, and has a factor or can have one
  bool needed_no_solve = false;  ///< impulses are those with which it began
  bool ends_apart = false;       ///< its velocities are not those of its way (end_velocities.h)
  bool is_even = false;          ///< its joints neither give nor take in this step
  bool holds_end = false;        ///< its velocities hold its rows at the end of the step
  /// At most one solve led from what was foreseen to the end of the step, or contacts made it needless to foresee that.
  bool is_foreseen = false;
  bool arrives = true;      ///< its joints hold where its velocities lead
  double residual = 0;      ///< m and rad: how far they miss their goals there
  bool is_settled = false;  ///< contacts and rows with bounds
  bool overflows = false;   ///< it is left to forces alone in this step
  Workspace work;
  VelocityForecast forecast;
  HalfForces forces;
  EnergyLedger ledger;
  double work_done = 0;  ///< J: by its joints, in this step

  /// Where the solve begins: velocities and impulses of `work`.
  void begin(const Island& island, const Component& component);
  /// Bullet's gyroscopic term is that of the velocity with which the last step ended. A turn is by that of its way, and what the term
  /// follows it, too: else momentum would be lost in each step, and not only once.
  void followTurns(Island& island, const Component& component) const;
  /// Springs of soft rows pull by what they are stretched.
  void stretchSprings(Island& island, const Component& component);
  /// Impulses with which the next step begins, while K and work.y are those of the solve.
  void keepImpulses(const Island& island, const Component& component, bool has_contacts,
                    double least_pivot);
  /// The same where velocities have been balanced: those that lead to them, along the rows of the last factor.
  void followVelocities(const Island& island, const Component& component, double least_pivot);
  /// The step as it has ended.
  void keep(const Island& island, const Component& component);
  /// The next step begins anew, with memory of its own.
  void reset();

  size_t bytes() const {
    return sizeof(*this) + K.bytes() + work.bytes() +
           bytesOf(constraints, bodies, in_loop, sizes, locks, m_rows, m_borne, m_lambda, m_at_end,
                   m_load, m_stretch, m_last_stretch) +
           forecast.bytes() + forces.bytes();
  }

 private:
  struct Stretch {
    double length = 0, energy = 0;
  };

  /// Of joint c, the rows that it had in the last step, too: all, or its equalities, which come first.
  int knownRows(int c, const IslandJoint& joint) const;
  /// A^-1 M v of body i: what K's matrix of that body leaves of a velocity.
  Vector6d leftOf(const IslandBody& body, int i, const Vector6d& v);
  /// work.x = -K^-1 J change.
  void findImpulses(const std::vector<Vector6d>& change);
  void findWhatOthersAsk(const Island& island, const Component& component, bool with_contacts);

  std::vector<int> m_rows;  ///< of each joint, in the last step
  std::vector<double>
      m_borne;  ///< of each row of this step, where contacts ask for more than m_lambda
  std::vector<double> m_lambda, m_at_end, m_load;  ///< of each row of it
  std::vector<Stretch> m_stretch, m_last_stretch;  ///< of each row's spring
};

/// Makes `memory` that of these joints, if it is not: symbolic work, which allocates.
void remember(const Island& island, const Component& component,
              std::unique_ptr<ComponentMemory>& memory);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
