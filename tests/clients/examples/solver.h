// Included before everything else of Bullet's examples: what makes their solvers, by the environment's PINTLE_EXAMPLES_SOLVER.
#pragma once

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

namespace examples {

/// Contenders: "stock", the example's own solver; "upgraded", stock joints upgraded on Bullet's iterations; "exact", upgraded and exact.
bool isContender(const char* name);

btSequentialImpulseConstraintSolver* makeSolver();
/// In the place of btNNCGConstraintSolver.
btSequentialImpulseConstraintSolver* makeNncgSolver();
/// The question of an example that may have a solver that is not iterated: that one has no upgraded form.
inline bool usesMlcp() { return isContender("stock"); }

}  // namespace examples
