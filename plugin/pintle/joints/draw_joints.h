// Purpose: debug drawing of the joints that Bullet does not draw: those of Pintle's that do not derive from one of its own.
#pragma once

#include <pintle/precision.h>

#include <memory>

class btDynamicsWorld;

namespace pintle {
inline namespace PINTLE_PRECISION {

/// While it lives, the world's debugDrawWorld() draws the world's Pintle joints that it does not draw by itself as it draws Bullet's own:
/// those that are in the world then, each once, in the debug modes btIDebugDraw::DBG_DrawConstraints
/// (frames) and DBG_DrawConstraintLimits. One line after world.setDebugDrawer(&drawer):
///
///   pintle::JointDrawing drawing(world);
///
/// The lines are those of the stock joints in the same pose, but for limits that these do not have or draw
/// wrong: one of a turn or more is drawn as a free one, a free slide has no line, and the range of a twist
/// stays where it is in frame b.
///
/// It sets a drawer of its own in the world. That one hands everything on to the one that was there (every
/// draw..., text, colours, debug mode, clearLines, flushLines), and draws the joints when debugDrawWorld()
/// flushes the lines. getDebugDrawer() then is not the drawer that was set: do not cast it. The destructor
/// puts the old one back, unless another one has been set since, which draws no joints. Both the world and
/// its drawer outlive this.
class JointDrawing {
 public:
  /// Throws std::invalid_argument if the world has no drawer, or has a JointDrawing.
  explicit JointDrawing(btDynamicsWorld& world);
  ~JointDrawing();
  JointDrawing(const JointDrawing&) = delete;
  JointDrawing& operator=(const JointDrawing&) = delete;

 private:
  class Drawer;
  friend void drawJoints(btDynamicsWorld& world);

  btDynamicsWorld& m_world;
  std::unique_ptr<Drawer> m_drawer;
};

/// Draws the same joints now, by the world's debug drawer, as its debug mode asks: for who
/// draws without debugDrawWorld(), or after it. Nothing if the world has no drawer, or if a JointDrawing
/// draws the joints.
void drawJoints(btDynamicsWorld& world);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
