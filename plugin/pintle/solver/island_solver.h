// Purpose: solves the joints and the contacts of an island. Bullet's solvers hand it their bodies and rows (joint_solver.h).
#pragma once

#include <pintle/solver/component_memory.h>
#include <pintle/solver/island_builder.h>
#include <pintle/solver/pose_correction.h>
#include <pintle/solver/solver_options.h>
#include <pintle/solver/step_report.h>

#include <memory>
#include <unordered_map>

namespace pintle {
inline namespace PINTLE_PRECISION {

class IslandSolver {
 public:
  /// Once a step of the world: what no island has used in the last one is forgotten. Its joints sleep, or are gone.
  void beginStep();
  const StepReport& report() const { return m_report; }
  /// Components of which something is kept for the next step.
  int remembered() const { return int(m_memory.size()); }

  // Then, for each island, in this order:
  void begin(const btContactSolverInfo& info);
  /// A joint, with the numbers of its bodies among Bullet's.
  void addJoint(btTypedConstraint& joint, const SolverBodies& bodies, int body_a, int body_b) {
    m_builder.add(joint, bodies, body_a, body_b);
  }
  /// After the last one. Returns whether there are any that hold a body.
  bool endJoints();
  /// Contacts, or friction, which is bounded by the contacts and comes after them.
  void addContacts(btConstraintArray& rows, const SolverBodies& bodies, bool are_friction);
  /// Bodies get their velocities and contacts their impulses.
  void solve(const btContactSolverInfo& info, SolverBodies& bodies);
  /// At the end of the step, what velocities cannot do.
  void movePoses() const;

  SolverOptions options;

 private:
  using Components = std::vector<const Component*>;

  ComponentMemory& begin(const Component& component);
  void solveAll();
  void solveAlone(const Component& component);
  bool solveByChord(const Component& component);
  void solveInVelocity(const Components& those, std::vector<ContactRow>& rows);
  double gainInVelocity(const Components& those, const std::vector<ContactRow>& rows);
  void finish(const Component& component, ComponentMemory& kept);
  std::vector<char> findTouched() const;
  void count(const SolveReport& done, int components);
  std::unique_ptr<ComponentMemory>& slotOf(const Component& component) {
    return m_memory[m_island.joints[size_t(component.first_joint)].constraint];
  }
  ComponentMemory& memoryOf(const Component& component) { return *slotOf(component); }

  StepReport m_report;
  Island m_island;
  IslandBuilder m_builder{m_island, options};
  std::vector<Component> m_components;
  std::vector<ContactRow> m_contacts;
  int m_sweeps = 0;  ///< of contacts
  std::unordered_map<const btTypedConstraint*, std::unique_ptr<ComponentMemory>> m_memory;
  std::vector<Vector6d> m_velocities;  ///< with which bodies end the step
  std::vector<PoseChange> m_pose_changes;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
