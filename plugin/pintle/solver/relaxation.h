// Purpose: the last resort, where Newton's iteration has found no step that joints may take: joints and contacts in velocity alone,
// by projected Gauss-Seidel along the rows of the start, as Bullet's solver does. From no impulses each change of one lowers
//   1/2 lambda . K lambda + lambda . (J v* - target),   K = J M^-1 J^T
// which is what the kinetic energy has gained beside lambda . target: passive after any number of passes.
#pragma once

#include <pintle/solver/contacts.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Velocities and impulses of the parts, of contacts, and of all bodies of the island.
void relax(const Island& island, std::vector<ContactPart>& parts, std::vector<ContactRow>& contacts,
           int passes, std::vector<Vector6d>& velocities);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
