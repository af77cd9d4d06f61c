// Purpose: a solver for Bullet's worlds of which joints cannot create energy, and which holds them to the last digits.
#pragma once

#include <pintle/solver/joint_solver.h>
#include <pintle/solver/uses_exact_solver.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

class PassiveJointSolver : public JointSolver<btSequentialImpulseConstraintSolver> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
