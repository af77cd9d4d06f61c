// Purpose: debug drawing of all Pintle joints of a world. Bullet draws its own types only.
#pragma once

#include <pintle/precision.h>

class btDynamicsWorld;

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Draws every Pintle joint of the world by the world's debug drawer, as its debug mode asks
/// (btIDebugDraw::DBG_DrawConstraints, DBG_DrawConstraintLimits); call it after debugDrawWorld().
/// Nothing if the world has no drawer.
void drawJoints(btDynamicsWorld& world);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
