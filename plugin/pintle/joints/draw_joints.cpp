#include <pintle/joints/draw_joints.h>

#include <pintle/joints/drawing.h>
#include <pintle/joints/standalone_joint.h>

#include <BulletDynamics/Dynamics/btDynamicsWorld.h>

#include <stdexcept>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

void draw(btDynamicsWorld& world, btIDebugDraw& drawer) {
  if (!(drawsFrames(drawer) || drawsLimits(drawer))) return;
  for (int i = 0; i < world.getNumConstraints(); ++i) {
    btTypedConstraint& constraint = *world.getConstraint(i);
    // Bullet draws its own types, and what derives from them; of gears nothing.
    const btTypedConstraintType type = constraint.getConstraintType();
    if (type != StandaloneJoint::type && type != GEAR_CONSTRAINT_TYPE) continue;
    auto* joint = dynamic_cast<Joint*>(&constraint);
    if (joint != nullptr && constraint.getDbgDrawSize() > 0) joint->drawJoint(drawer);
  }
}

}  // namespace

// Hands everything on. What it leaves out, the base would draw by lines in the place of the drawer's own.
class JointDrawing::Drawer : public btIDebugDraw {
 public:
  Drawer(btDynamicsWorld& world, btIDebugDraw& to) : m_world(world), m_to(to) {}

  btIDebugDraw& to() const { return m_to; }

  // debugDrawWorld asks for the colours when it begins, and flushes the lines when all constraints are drawn.
  // Who flushes lines of his own before or after gets no joints again.
  DefaultColors getDefaultColors() const override {
    m_begun = true;
    return m_to.getDefaultColors();
  }
  void flushLines() override {
    if (m_begun) draw(m_world, m_to);
    m_begun = false;
    m_to.flushLines();
  }
#if BT_BULLET_VERSION >= 287
  void clearLines() override { m_to.clearLines(); }
#endif

  void setDefaultColors(const DefaultColors& colors) override { m_to.setDefaultColors(colors); }
  void setDebugMode(int mode) override { m_to.setDebugMode(mode); }
  int getDebugMode() const override { return m_to.getDebugMode(); }
  void reportErrorWarning(const char* warning) override { m_to.reportErrorWarning(warning); }
  void draw3dText(const btVector3& location, const char* text) override {
    m_to.draw3dText(location, text);
  }

  void drawLine(const btVector3& from, const btVector3& to, const btVector3& color) override {
    m_to.drawLine(from, to, color);
  }
  void drawLine(const btVector3& from, const btVector3& to, const btVector3& from_color,
                const btVector3& to_color) override {
    m_to.drawLine(from, to, from_color, to_color);
  }
  void drawSphere(btScalar radius, const btTransform& transform, const btVector3& color) override {
    m_to.drawSphere(radius, transform, color);
  }
  void drawSphere(const btVector3& p, btScalar radius, const btVector3& color) override {
    m_to.drawSphere(p, radius, color);
  }
  void drawTriangle(const btVector3& v0, const btVector3& v1, const btVector3& v2,
                    const btVector3& n0, const btVector3& n1, const btVector3& n2,
                    const btVector3& color, btScalar alpha) override {
    m_to.drawTriangle(v0, v1, v2, n0, n1, n2, color, alpha);
  }
  void drawTriangle(const btVector3& v0, const btVector3& v1, const btVector3& v2,
                    const btVector3& color, btScalar alpha) override {
    m_to.drawTriangle(v0, v1, v2, color, alpha);
  }
  void drawContactPoint(const btVector3& point_on_b, const btVector3& normal_on_b,
                        btScalar distance, int life_time, const btVector3& color) override {
    m_to.drawContactPoint(point_on_b, normal_on_b, distance, life_time, color);
  }
  void drawAabb(const btVector3& from, const btVector3& to, const btVector3& color) override {
    m_to.drawAabb(from, to, color);
  }
  void drawTransform(const btTransform& transform, btScalar size) override {
    m_to.drawTransform(transform, size);
  }
  void drawArc(const btVector3& center, const btVector3& normal, const btVector3& axis,
               btScalar radius_a, btScalar radius_b, btScalar min_angle, btScalar max_angle,
               const btVector3& color, bool sector, btScalar step_degrees) override {
    m_to.drawArc(center, normal, axis, radius_a, radius_b, min_angle, max_angle, color, sector,
                 step_degrees);
  }
  void drawSpherePatch(const btVector3& center, const btVector3& up, const btVector3& axis,
                       btScalar radius, btScalar min_th, btScalar max_th, btScalar min_ps,
                       btScalar max_ps, const btVector3& color, btScalar step_degrees,
                       bool draw_center) override {
    m_to.drawSpherePatch(center, up, axis, radius, min_th, max_th, min_ps, max_ps, color,
                         step_degrees, draw_center);
  }
  void drawBox(const btVector3& min, const btVector3& max, const btVector3& color) override {
    m_to.drawBox(min, max, color);
  }
  void drawBox(const btVector3& min, const btVector3& max, const btTransform& transform,
               const btVector3& color) override {
    m_to.drawBox(min, max, transform, color);
  }
  void drawCapsule(btScalar radius, btScalar half_height, int up_axis, const btTransform& transform,
                   const btVector3& color) override {
    m_to.drawCapsule(radius, half_height, up_axis, transform, color);
  }
  void drawCylinder(btScalar radius, btScalar half_height, int up_axis,
                    const btTransform& transform, const btVector3& color) override {
    m_to.drawCylinder(radius, half_height, up_axis, transform, color);
  }
  void drawCone(btScalar radius, btScalar height, int up_axis, const btTransform& transform,
                const btVector3& color) override {
    m_to.drawCone(radius, height, up_axis, transform, color);
  }
  void drawPlane(const btVector3& normal, btScalar constant, const btTransform& transform,
                 const btVector3& color) override {
    m_to.drawPlane(normal, constant, transform, color);
  }

 private:
  btDynamicsWorld& m_world;
  btIDebugDraw& m_to;
  mutable bool m_begun = false;
};

JointDrawing::JointDrawing(btDynamicsWorld& world) : m_world(world) {
  btIDebugDraw* const drawer = world.getDebugDrawer();
  if (drawer == nullptr)
    throw std::invalid_argument("JointDrawing: the world has no debug drawer, set it first");
  if (dynamic_cast<Drawer*>(drawer) != nullptr)
    throw std::invalid_argument("JointDrawing: the world has one, which draws its joints");
  m_drawer = std::make_unique<Drawer>(world, *drawer);
  world.setDebugDrawer(m_drawer.get());
}

JointDrawing::~JointDrawing() {
  if (m_world.getDebugDrawer() == m_drawer.get()) m_world.setDebugDrawer(&m_drawer->to());
}

void drawJoints(btDynamicsWorld& world) {
  btIDebugDraw* const drawer = world.getDebugDrawer();
  if (drawer != nullptr && dynamic_cast<JointDrawing::Drawer*>(drawer) == nullptr)
    draw(world, *drawer);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
