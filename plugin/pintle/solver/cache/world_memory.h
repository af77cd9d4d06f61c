// Purpose: what the solvers of a world keep from step to step. Those of a pool share it, for any of them may solve an island.
#pragma once

#include <pintle/solver/cache/component_memory.h>
#include <pintle/solver/step_report.h>
#include <pintle/upgrade/upgraded_joints.h>

#include <memory>
#include <mutex>
#include <unordered_map>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// May be used by several threads at once.
class WorldMemory {
 public:
  /// What no island has used in the last step is forgotten: its joints sleep, or are gone.
  void beginStep();
  /// Of a component, by its first joint. Bullet's own pool does not tell its solvers when a step begins: one begins when a component
  /// comes again.
  std::unique_ptr<ComponentMemory>& slot(const btTypedConstraint* first_joint);
  /// Joints in the place of stock ones.
  UpgradedJoints& upgradedJoints() { return m_upgraded; }
  /// Where steps are of second order.
  MotionsOfBody& motionsOf(const btRigidBody& body);
  /// Of this step, from one of its islands.
  void add(const StepReport& island);
  StepReport report() const;
  /// Components.
  int size() const;
  size_t bytes() const;

 private:
  struct Slot {
    std::unique_ptr<ComponentMemory> memory;
    long step = -1;  ///< in which it was used
  };
  void beginStep(long kept_for);

  mutable std::mutex m_mutex;
  std::unordered_map<const btTypedConstraint*, Slot> m_slots;
  std::unordered_map<const btRigidBody*, MotionsOfBody> m_motions;
  long m_step = 0;
  UpgradedJoints m_upgraded{SolvedBy::exact_solver};
  StepReport m_report;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
