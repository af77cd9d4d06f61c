// Purpose: a table of what a world's energy and its exact solver do, for who asks why a scene shakes.
#pragma once

#include <pintle/precision.h>

#include <iosfwd>

class btDynamicsWorld;

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Writes comma-separated values: a line of names, and a line for each step.
///
/// | column | |
/// |---|---|
/// | `time` | s, since the log began |
/// | `kinetic` | J, of the rigid bodies: with which the step ends |
/// | `potential` | J, in their gravity: in the middle of the step, where that velocity belongs to the poses |
/// | `work`, `ledger`, `ledger_limit`, `residual`, `open`, `tier`, `not_converged`, `components` | see StepReport |
class StepLog {
 public:
  /// `world` and `out` must outlive it. Throws std::invalid_argument, with the reason, if the world's joints are not solved exactly.
  StepLog(const btDynamicsWorld& world, std::ostream& out);

  /// After each step of the world.
  void write();

 private:
  const btDynamicsWorld& m_world;
  std::ostream& m_out;
  double m_time = 0;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
