#include <pintle/joints/draw_joints.h>

#include <pintle/joints/drawing.h>
#include <pintle/joints/joint.h>

#include <BulletDynamics/Dynamics/btDynamicsWorld.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

void drawJoints(btDynamicsWorld& world) {
  btIDebugDraw* drawer = world.getDebugDrawer();
  if (drawer == nullptr || !(drawsFrames(*drawer) || drawsLimits(*drawer))) return;
  for (int i = 0; i < world.getNumConstraints(); ++i) {
    auto* joint = dynamic_cast<Joint*>(world.getConstraint(i));
    if (joint != nullptr && joint->getDbgDrawSize() > 0) joint->drawJoint(*drawer);
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
