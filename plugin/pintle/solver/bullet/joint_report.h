// Purpose: what a step tells its joints: impulses, loads, and which have broken.
#pragma once

#include <pintle/solver/system/workspace.h>

class btTypedConstraint;

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Disables joints of the component that bear more than their threshold, and takes their rows out of the island. Returns whether
/// there were any: the step is then to be solved again.
bool breakOverloaded(Island& island, const Component& component, const Workspace& end);

/// Impulses as Bullet and Pintle's joints hand them out.
void report(const Island& island, const Component& component, const Workspace& end);

/// Tells them that nothing has acted.
void reportNothing(const Island& island, const Component& component);

/// The applied impulse and the feedback of a joint: none.
void clearImpulses(btTypedConstraint& joint);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
