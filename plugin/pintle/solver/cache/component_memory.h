// Purpose: what a solver keeps of a component of joints from step to step: the order and memory of its equations, the impulses and
// the forecast of velocities with which the next step begins, and its energies.
#pragma once

#include <pintle/solver/cache/half_forces.h>
#include <pintle/solver/cache/velocity_forecast.h>
#include <pintle/solver/energy/energy_ledger.h>
#include <pintle/solver/system/joint_matrix.h>
#include <pintle/solver/system/workspace.h>

#include <memory>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// How the velocities of a component were found, and which they are.
enum class Solution {
  even,  ///< in the first tier; those of the poses at the end (end_velocities.h), and joints neither give nor take
  at_end,       ///< in the first tier; those of the poses at the end
  of_way,       ///< in the first tier; those that lead to the end
  in_velocity,  ///< in the second tier
  one_by_one,   ///< in the third tier, without a factor
  overflows     ///< none: it is left to forces alone in this step
};

struct ComponentMemory {
  std::vector<btTypedConstraint*> constraints;
  std::vector<std::array<int, 2>> bodies;  ///< of each, counted from the component's first
  std::vector<char> in_loop;               ///< each joint
  std::vector<int> sizes;                  ///< of each: rows
  JointMatrix::Locks locks;                ///< of each body
  JointMatrix K;
  Solution solution = Solution::one_by_one;
  /// Solves that led from what was foreseen to the end of the step; 0: impulses are those with which it began. Contacts make it needless to
  /// foresee that, as if it were 1.
  int solves = 0;
  bool arrives = true;      ///< its joints hold where its velocities lead
  double residual = 0;      ///< m and rad: how far they miss their goals there
  bool is_settled = false;  ///< contacts and rows with bounds
  Workspace work;
  VelocityForecast forecast;
  HalfForces forces;
  EnergyLedger ledger;
  double work_done = 0;  ///< J: by its joints, in this step

  /// Its velocities lead to where its rows hold.
  bool holdsEnd() const { return solution <= Solution::of_way; }
  /// K is that of the step, and has a factor or can have one.
  bool hasFactor() const { return solution <= Solution::in_velocity; }

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
