// Purpose: tells whether a world's joints are solved exactly. Bullet ignores solvers without a word.
#pragma once

#include <pintle/precision.h>
#include <pintle/solver/step_report.h>

#include <string>

class btDynamicsWorld;

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Whether all joints of the world are solved by an ExactJointSolver, an ExactMultiBodyJointSolver, or a btConstraintSolverPoolMt
/// of these.
bool usesExactSolver(const btDynamicsWorld& world);

/// Why they are not, and what would be right, for a message to who sets up the world; empty if they are.
std::string whyNotExact(const btDynamicsWorld& world);

/// What its exact solvers did in the last step. Throws std::invalid_argument, with that reason, if it has none.
StepReport lastStep(const btDynamicsWorld& world);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
