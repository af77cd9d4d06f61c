// Purpose: tells whether a world's joints are solved exactly. Bullet ignores solvers without a word.
#pragma once

#include <pintle/precision.h>

#include <string>

class btDynamicsWorld;

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Whether all joints of the world are solved by an ExactJointSolver, an ExactMultiBodyJointSolver, or a btConstraintSolverPoolMt
/// of these.
bool usesExactSolver(const btDynamicsWorld& world);

/// Why they are not, and what would be right, for a message to who sets up the world; empty if they are.
std::string whyNotExact(const btDynamicsWorld& world);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
