// Purpose: the joints of Pintle's that stand for the stock ones of a world, from step to step.
#pragma once

#include <pintle/upgrade/upgraded_joint.h>

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Nobody tells that a constraint has died, and its address may be that of another one: one that was not solved in the last step, or
/// that is another object, starts anew. May be used by several threads at once.
class UpgradedJoints {
 public:
  explicit UpgradedJoints(SolvedBy solver = SolvedBy::iterations) : m_solver(solver) {}
  /// A step of the world begins. (A solver that is not told takes it that one does where a constraint comes again.)
  void beginStep();
  /// The joints in the place of these constraints; null where there is none.
  void find(btTypedConstraint* const* constraints, int count, std::vector<UpgradedJoint*>& to);
  /// Joint::whyIgnored of the one in the place of this constraint, or of a joint of Pintle's. Empty for others, too.
  std::string whyIgnored(const btTypedConstraint& constraint);
  std::size_t size() const;
  std::size_t bytes() const;

 private:
  struct Entry {
    std::unique_ptr<UpgradedJoint> joint;
    long step = -1;  ///< in which it was used
  };
  UpgradedJoint& joint(const StockClass& of, btTypedConstraint& stock);
  void beginStep(long kept_for);

  const SolvedBy m_solver;
  mutable std::mutex m_mutex;
  std::unordered_map<const btTypedConstraint*, Entry> m_all;
  long m_step = 0;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
