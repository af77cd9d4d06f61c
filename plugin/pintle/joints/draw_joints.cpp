#include <pintle/joints/draw_joints.h>

#include <pintle/joints/joint.h>

#include <BulletDynamics/Dynamics/btDynamicsWorld.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

void drawJoints(btDynamicsWorld& world) {
  btIDebugDraw* drawer = world.getDebugDrawer();
  if (drawer == nullptr) return;
  for (int i = 0; i < world.getNumConstraints(); ++i) {
    const auto* joint = dynamic_cast<const Joint*>(world.getConstraint(i));
    if (joint != nullptr) joint->drawJoint(*drawer);
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
