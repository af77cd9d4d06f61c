// Purpose: contacts that are deep push bodies out of each other by moving poses (Bullet's split impulses), together with the joints:
//   J w = 0 of the rows that act,   p and J_c w - (what the contact asks for) complementary, p >= 0
// so that joints do not pull back what contacts push.
#pragma once

#include <pintle/solver/block_gauss_seidel.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// `push`: of all bodies of the island, m/s and rad/s over this step. By the factor with which the velocities were found.
void findPush(const Island& island, const std::vector<BlockOfJoints>& blocks,
              std::vector<ContactRow>& contacts, const SolverOptions& options, int most,
              std::vector<Vector6d>& push);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
