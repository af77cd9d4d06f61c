// Debug drawing: a joint that takes the place of a stock one draws the lines that that one draws, and
// Bullet's debugDrawWorld draws the Pintle joints of a world that has a JointDrawing.
#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <BulletDynamics/ConstraintSolver/btUniversalConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <gtest/gtest.h>
#include <pintle/joints/angular_limit.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/draw_joints.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/universal_joint.h>

#include <algorithm>
#include <cctype>
#include <sstream>
#include <stdexcept>
#include <string>

#include "drawing.h"
#include "joint_kinds.h"
#include "support.h"

namespace draw_joints_test {

using drawing::Line;
using drawing::Recorder;
using support::scalar;
using support::vec;

constexpr int frames_mode = btIDebugDraw::DBG_DrawConstraints;
constexpr int limits_mode = btIDebugDraw::DBG_DrawConstraintLimits;
// Every mode in which Bullet draws joints or nothing, beside each other and beside one that draws bodies.
constexpr int modes[] = {btIDebugDraw::DBG_NoDebug, frames_mode, limits_mode,
                         frames_mode | limits_mode, btIDebugDraw::DBG_DrawAabb | frames_mode};

// Two boxes, or a box and one that does not move.
struct Poses {
  btTransform a = scenes::pose_at(vec(0, 0, 0));
  btTransform b = btTransform(btQuaternion(vec(0, 0, 1), 1), vec(1, 0, 0));
  double mass_b = 1;
};

// The lines that debugDrawWorld draws of a world with one joint, made by `add`.
template <class Add>
std::vector<Line> lines(int mode, Add add, const Poses& poses = {}) {
  scenes::World world(0);
  btRigidBody& a = world.add_box(1, vec(0.5, 0.2, 0.1), poses.a);
  btRigidBody& b = world.add_box(poses.mass_b, vec(0.5, 0.2, 0.1), poses.b);
  add(world, a, b);
  Recorder recorder(mode);
  world.bullet().setDebugDrawer(&recorder);
  const pintle::JointDrawing drawing(world.bullet());
  world.bullet().debugDrawWorld();
  return recorder.lines;
}

bool isSame(const Line& l, const Line& m) {
  // Bullet's cone is drawn with a pi of eight digits.
  const btScalar tolerance = support::is_double ? scalar(1e-6) : scalar(1e-5);
  const auto near = [&](const btVector3& x, const btVector3& y) {
    return (x - y).length() <= tolerance;
  };
  return near(l.color, m.color) &&
         ((near(l.from, m.from) && near(l.to, m.to)) || (near(l.from, m.to) && near(l.to, m.from)));
}

// As sets: each line of one is one of the other.
void expectSame(const std::vector<Line>& ours, std::vector<Line> stock) {
  EXPECT_EQ(ours.size(), stock.size());
  for (const Line& line : ours) {
    const auto found =
        std::find_if(stock.begin(), stock.end(), [&](const Line& l) { return isSame(l, line); });
    if (found == stock.end()) {
      ADD_FAILURE() << "not of stock: " << line.from.x() << ' ' << line.from.y() << ' '
                    << line.from.z() << " to " << line.to.x() << ' ' << line.to.y() << ' '
                    << line.to.z();
      return;
    }
    stock.erase(found);
  }
}

// Draws ours and stock's, made by the same `add(type, world, a, b)`, in every mode.
template <class Ours, class Stock, class Add>
void expectDrawnAsStock(Add add, const Poses& poses = {}) {
  for (const int mode : modes) {
    SCOPED_TRACE(testing::Message() << "mode " << mode);
    const auto stock = lines(
        mode, [&](auto&... all) { add(std::common_type<Stock>(), all...); }, poses);
    if (mode & frames_mode) {
      EXPECT_GE(stock.size(), 6u);
    }
    expectSame(lines(
                   mode, [&](auto&... all) { add(std::common_type<Ours>(), all...); }, poses),
               stock);
  }
}

const btTransform frame_a(btQuaternion(vec(0.6, 0, 0.8), scalar(0.7)), vec(0.5, 0.1, 0));
const btTransform frame_b(btQuaternion(vec(0, 1, 0), scalar(-0.4)), vec(-0.5, 0, 0.2));

// Poses of b in which frame b is where a rotation of its own takes it, and a way off.
Poses apart(const btQuaternion& b_against_a, const btVector3& offset, double mass_b = 1) {
  Poses poses;
  poses.a = btTransform(btQuaternion(vec(0, 0.6, 0.8), scalar(0.3)), vec(0.1, 0.2, 0.3));
  poses.b = poses.a * frame_a * btTransform(b_against_a, offset) * frame_b.inverse();
  poses.mass_b = mass_b;
  return poses;
}

// --- the lines of stock --------------------------------------------------------------------------

TEST(DrawJoints, AHingeDrawsTheLinesOfStocks) {
  const double limits[][2] = {{-1, 0.5}, {1, -1}, {0.3, 0.3}, {0, 2}, {-3, 3}};
  for (const auto& limit : limits) {
    SCOPED_TRACE(testing::Message() << "limit " << limit[0]);
    const auto add = [&](auto type, auto& world, auto& a, auto& b) {
      using Hinge = typename decltype(type)::type;
      auto& hinge = world.template add_joint<Hinge>(a, b, frame_a, frame_b);
      hinge.setLimit(scalar(limit[0]), scalar(limit[1]));
      hinge.setDbgDrawSize(scalar(0.7));
    };
    expectDrawnAsStock<pintle::QuaternionHinge, btHingeConstraint>(add);
    expectDrawnAsStock<pintle::QuaternionHinge, btHingeConstraint>(
        add, apart({vec(0, 1, 0), scalar(0.3)}, vec(0.1, 0, 0), 0));
  }
}

TEST(DrawJoints, ABallDrawsTheLinesOfStocks) {
  expectDrawnAsStock<pintle::BallJoint, btPoint2PointConstraint>(
      [](auto type, auto& world, auto& a, auto& b) {
        world.template add_joint<typename decltype(type)::type>(a, b, vec(0.5, 0, 0),
                                                                vec(-0.5, 0.1, 0));
      });
}

TEST(DrawJoints, ASliderDrawsTheLinesOfStocks) {
  const double angles[][2] = {{0, 0}, {-0.6, 0.4}, {0.2, 3}};
  for (const bool reference_a : {true, false}) {
    for (const auto& angle : angles) {
      SCOPED_TRACE(testing::Message() << "frame a " << reference_a << ", angle " << angle[1]);
      expectDrawnAsStock<pintle::SliderJoint, btSliderConstraint>(
          [&](auto type, auto& world, auto& a, auto& b) {
            auto& slider = world.template add_joint<typename decltype(type)::type>(
                a, b, frame_a, frame_b, reference_a);
            slider.setLowerLinLimit(scalar(-0.5));
            slider.setUpperLinLimit(2);
            slider.setLowerAngLimit(scalar(angle[0]));
            slider.setUpperAngLimit(scalar(angle[1]));
            slider.setDbgDrawSize(scalar(0.7));
          },
          apart({vec(0.6, 0.8, 0), scalar(0.3)}, vec(0.4, 0.1, 0)));
    }
  }
}

// Bullet's cone and its twist as they stand, without a step.
void look(btConeTwistConstraint& joint) {
  const btRigidBody &a = joint.getRigidBodyA(), &b = joint.getRigidBodyB();
  joint.calcAngleInfo2(a.getCenterOfMassTransform(), b.getCenterOfMassTransform(),
                       a.getInvInertiaTensorWorld(), b.getInvInertiaTensorWorld());
}

TEST(DrawJoints, AConeTwistJointDrawsTheLinesOfStocks) {
  const btQuaternion swing(vec(0, 0.6, 0.8), scalar(0.3)), none = btQuaternion::getIdentity();
  // The twist of a against b: of b against a the other way round.
  const btQuaternion twist(vec(1, 0, 0), scalar(-0.4));
  // Where b moves stock's range of the twist goes back by the twist, which is not that of frame b.
  const Poses poses[] = {apart(none, vec(0, 0, 0)), apart(swing, vec(0.1, 0, 0)),
                         apart(none, vec(0, 0.1, 0), 0), apart(swing * twist, vec(0, 0, 0), 0)};
  const double spans[][3] = {{0.5, 0.5, 0.3},  {0.4, 1.2, 2},   {1.1, 0.3, 0}, {0.6, 0.01, 0.5},
                             {0.01, 0.6, 0.5}, {0.02, 0.01, 1}, {2.5, 1.8, 3}};
  for (const Poses& pose : poses) {
    for (const auto& span : spans) {
      SCOPED_TRACE(testing::Message()
                   << "pose " << &pose - poses << ", spans " << span[0] << ' ' << span[1]);
      expectDrawnAsStock<pintle::ConeTwistJoint, btConeTwistConstraint>(
          [&](auto type, auto& world, auto& a, auto& b) {
            auto& joint =
                world.template add_joint<typename decltype(type)::type>(a, b, frame_a, frame_b);
            joint.setLimit(scalar(span[0]), scalar(span[1]), scalar(span[2]), scalar(0.9));
            joint.setDbgDrawSize(scalar(0.7));
            // Pintle's has looked where it was made.
            if (std::is_same_v<decltype(joint), btConeTwistConstraint&>) look(joint);
          },
          pose);
    }
  }
}

TEST(DrawJoints, AUniversalJointDrawsTheLinesOfStocks) {
  // Of angle 2, and of angle 1.
  const double limits[][4] = {{-0.5, 0.8, -1, 2}, {-1.5, 1.5, -3, 3}, {-0.5, 0.8, 1, -1},
                              {0.5, -0.5, -1, 1}, {0, 0, -1, 1},      {-0.4, 0.4, 0, 0}};
  for (const auto& limit : limits) {
    SCOPED_TRACE(testing::Message() << "limit " << limit[0] << ", " << limit[2]);
    expectDrawnAsStock<pintle::UniversalJoint, btUniversalConstraint>(
        [&](auto type, auto& world, auto& a, auto& b) {
          auto& joint = world.template add_joint<typename decltype(type)::type>(
              a, b, vec(0.5, 0.1, 0), vec(0, 0.6, 0.8), vec(1, 0, 0));
          joint.setLowerLimit(scalar(limit[0]), scalar(limit[2]));
          joint.setUpperLimit(scalar(limit[1]), scalar(limit[3]));
          joint.setDbgDrawSize(scalar(0.7));
          // Bullet's draws where it was last asked to look.
          a.setCenterOfMassTransform(
              btTransform(btQuaternion(vec(0, 0.6, 0.8), scalar(0.5)), vec(0, 0, 1)));
          b.setCenterOfMassTransform(
              btTransform(btQuaternion(vec(1, 0, 0), scalar(0.3)), vec(1, 0, 1)));
          joint.calculateTransforms();
        });
  }
}

TEST(DrawJoints, AFixedJointDrawsTheLinesOfStocks) {
  for (const auto& poses : {apart(btQuaternion::getIdentity(), vec(0, 0, 0)),
                            apart({vec(0.6, 0.8, 0), scalar(0.3)}, vec(0.4, 0.1, 0))})
    expectDrawnAsStock<pintle::FixedJoint, btFixedConstraint>(
        [](auto type, auto& world, auto& a, auto& b) {
          world.template add_joint<typename decltype(type)::type>(a, b, frame_a, frame_b)
              .setDbgDrawSize(scalar(0.7));
        },
        poses);
}

// --- what Bullet's cannot draw -------------------------------------------------------------------

TEST(DrawJoints, LimitsOfSeveralTurnsAreDrawnAsFreeOnes) {
  const auto hinge = [](double low, double high) {
    return lines(limits_mode, [=](auto& world, auto& a, auto& b) {
      world.template add_joint<pintle::QuaternionHinge>(a, b, frame_a, frame_b)
          .setLimit(scalar(low), scalar(high));
    });
  };
  EXPECT_FALSE(hinge(1, -1).empty());
  expectSame(hinge(-20, 20), hinge(1, -1));
  // The patch of a sphere has room for two turns in Bullet's drawer.
  const auto universal = [](double low, double high) {
    return lines(limits_mode, [=](auto& world, auto& a, auto& b) {
      auto& joint = world.template add_joint<pintle::UniversalJoint>(a, b, frame_a, frame_b);
      joint.setLimit(5, scalar(low), scalar(high));
      joint.setLimit(4, scalar(-0.5), scalar(0.5));
    });
  };
  EXPECT_FALSE(universal(1, -1).empty());
  expectSame(universal(-200, 200), universal(1, -1));
}

// Stock's range turns with the size of the twist, whichever way round it is, and where b moves, too. That of drawJoint does not.
TEST(DrawJoints, TheRangeOfATwistStaysWhereItIsInFrameB) {
  const auto drawn = [](double twist, double mass_b) {
    Poses poses = apart(btQuaternion(vec(1, 0, 0), scalar(twist)), vec(0, 0, 0), mass_b);
    const btTransform back = poses.b.inverse();
    scenes::World world(0);
    btRigidBody& a = world.add_box(1, vec(0.5, 0.2, 0.1), back * poses.a);
    btRigidBody& b = world.add_box(mass_b, vec(0.5, 0.2, 0.1), back * poses.b);
    pintle::ConeTwistJoint joint(a, b, frame_a, frame_b);
    joint.setLimit(scalar(0.5), scalar(0.7), scalar(0.6));
    Recorder recorder(limits_mode);
    joint.drawJoint(recorder);
    return recorder.lines;
  };
  const auto straight = drawn(0, 1);
  EXPECT_GT(straight.size(), 40u);
  for (const double twist : {-0.4, 0.4})
    for (const double mass_b : {0, 1}) expectSame(drawn(twist, mass_b), straight);
}

TEST(DrawJoints, AConeOfASpanOfZeroIsFiniteByDrawJoint) {
  scenes::World world(0);
  btRigidBody& a = world.add_box(1, vec(0.5, 0.2, 0.1), scenes::pose_at(vec(0, 0, 0)));
  pintle::ConeTwistJoint joint(a, frame_a);
  for (const double span : {0., 0.5}) {
    joint.setLimit(scalar(span), 0, 0);
    EXPECT_GE(drawing::linesOf(joint, limits_mode), span > 0 ? 32 : 1);
  }
}

TEST(DrawJoints, EveryKindDrawsSomethingFiniteAndNothingUnasked) {
  for (const kinds::Kind& kind : kinds::all()) {
    SCOPED_TRACE(kind.name);
    for (int variant = 0; variant < kind.variants; ++variant) {
      const auto add = [&](scenes::World& world, btRigidBody& a, btRigidBody& b) {
        world.take_joint(kind.make(a, b, scenes::pose_at(vec(0.5, 0, 0)),
                                   scenes::pose_at(vec(-0.5, 0, 0)), variant));
      };
      for (const int mode : {0, frames_mode, limits_mode, frames_mode | limits_mode}) {
        const auto drawn = lines(mode, add);
        EXPECT_TRUE(mode != btIDebugDraw::DBG_NoDebug || drawn.empty());
        EXPECT_TRUE(!(mode & btIDebugDraw::DBG_DrawConstraints) || !drawn.empty());
        // Bullet's cone of a span of zero has points that are none.
        const bool is_bullets_cone = kind.name.find("ConeTwist") == 0;
        for (const Line& line : drawn) {
          if (is_bullets_cone) break;
          EXPECT_TRUE(support::is_finite(line.from));
          EXPECT_TRUE(support::is_finite(line.to));
        }
        // As in Bullet, a size of zero draws nothing.
        const auto add_small = [&](scenes::World& world, btRigidBody& a, btRigidBody& b) {
          add(world, a, b);
          world.bullet().getConstraint(0)->setDbgDrawSize(0);
        };
        EXPECT_EQ(lines(mode, add_small).size(), 0u);
      }
    }
  }
}

// --- who draws -----------------------------------------------------------------------------------

constexpr size_t joint_lines = 6;  // two frames

// A world with a joint that Bullet does not draw, and one drawer.
struct Scene {
  scenes::World world{0};
  btRigidBody& body = world.add_box(1, vec(1, 1, 1), scenes::pose_at(vec(0, 0, 0)));
  Recorder recorder{frames_mode};

  explicit Scene(bool joint = true) {
    if (joint) world.add_joint<pintle::AngularLimit>(body, btTransform::getIdentity());
    bullet().setDebugDrawer(&recorder);
  }
  btDiscreteDynamicsWorld& bullet() { return world.bullet(); }
  template <class Call>
  size_t linesOf(Call call) {
    recorder.lines.clear();
    call();
    return recorder.lines.size();
  }
  size_t drawn() {
    return linesOf([&] { bullet().debugDrawWorld(); });
  }
};

TEST(JointDrawing, LastsAsLongAsItLivesAndPutsTheDrawerBack) {
  Scene scene;
  EXPECT_EQ(scene.drawn(), 0u);  // by Bullet
  {
    const pintle::JointDrawing drawing(scene.bullet());
    EXPECT_EQ(scene.drawn(), joint_lines);
    EXPECT_EQ(scene.drawn(), joint_lines);
  }
  EXPECT_EQ(scene.bullet().getDebugDrawer(), &scene.recorder);
  EXPECT_EQ(scene.drawn(), 0u);
  // A drawer that was set since stays.
  Recorder other(frames_mode);
  {
    const pintle::JointDrawing drawing(scene.bullet());
    scene.bullet().setDebugDrawer(&other);
  }
  EXPECT_EQ(scene.bullet().getDebugDrawer(), &other);
}

TEST(JointDrawing, DrawsEachJointOnceWhoeverElseDrawsOrFlushes) {
  Scene scene;
  const pintle::JointDrawing drawing(scene.bullet());
  btDiscreteDynamicsWorld& world = scene.bullet();
  const auto draw_twice = [&] {
    world.debugDrawWorld();
    pintle::drawJoints(world);
  };
  EXPECT_EQ(scene.linesOf(draw_twice), joint_lines);
  const auto flush = [&] {
    world.getDebugDrawer()->flushLines();
    world.debugDrawWorld();
    world.getDebugDrawer()->flushLines();
  };
  EXPECT_EQ(scene.linesOf(flush), joint_lines);
  const auto step = [&] { scene.world.step(1.0 / 60); };
  EXPECT_EQ(scene.linesOf(step), 0u);
}

TEST(JointDrawing, DrawsTheJointsThatAreThereAndBulletsOwnBesideThem) {
  Scene scene(false);
  const pintle::JointDrawing drawing(scene.bullet());
  btDiscreteDynamicsWorld& world = scene.bullet();
  EXPECT_EQ(scene.drawn(), 0u);
  pintle::AngularLimit joint(scene.body, btTransform::getIdentity());
  world.addConstraint(&joint);
  EXPECT_EQ(scene.drawn(), joint_lines);
  btPoint2PointConstraint stock(scene.body, vec(0, 0, 0));
  world.addConstraint(&stock);
  EXPECT_EQ(scene.drawn(), 2 * joint_lines);
  world.removeConstraint(&joint);
  EXPECT_EQ(scene.drawn(), joint_lines);
  world.removeConstraint(&stock);
  EXPECT_EQ(scene.drawn(), 0u);
}

TEST(JointDrawing, WorksWithAMultiBodyWorld) {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btMultiBodyConstraintSolver solver;
  btMultiBodyDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  const auto body = support::body(1, vec(1, 1, 1), scenes::pose_at(vec(0, 0, 0)));
  pintle::AngularLimit joint(*body, btTransform::getIdentity());
  world.addConstraint(&joint);
  Recorder recorder(frames_mode);
  world.setDebugDrawer(&recorder);
  const pintle::JointDrawing drawing(world);
  world.debugDrawWorld();
  EXPECT_EQ(recorder.lines.size(), joint_lines);
  world.removeConstraint(&joint);
}

TEST(JointDrawing, NeedsADrawerAndIsOneOfAWorld) {
  scenes::World none(0);
  EXPECT_THROW(pintle::JointDrawing drawing(none.bullet()), std::invalid_argument);
  none.bullet().debugDrawWorld();
  Scene scene;
  const pintle::JointDrawing drawing(scene.bullet());
  const btIDebugDraw* const drawer = scene.bullet().getDebugDrawer();
  EXPECT_THROW(pintle::JointDrawing second(scene.bullet()), std::invalid_argument);
  EXPECT_EQ(scene.bullet().getDebugDrawer(), drawer);
  EXPECT_EQ(scene.drawn(), joint_lines);
}

TEST(JointDrawing, DebugModeAndColoursAreThoseOfTheDrawerThatWasSet) {
  Scene scene;
  const pintle::JointDrawing drawing(scene.bullet());
  btIDebugDraw& drawer = *scene.bullet().getDebugDrawer();
  drawer.setDebugMode(limits_mode);
  EXPECT_EQ(scene.recorder.getDebugMode(), limits_mode);
  EXPECT_GT(scene.drawn(), joint_lines);  // a free circle
  scene.recorder.setDebugMode(btIDebugDraw::DBG_DrawText);
  EXPECT_EQ(drawer.getDebugMode(), btIDebugDraw::DBG_DrawText);
  EXPECT_EQ(scene.drawn(), 0u);
}

// Writes down what it is told, every method of btIDebugDraw.
class Log : public btIDebugDraw {
 public:
  std::ostringstream text;

  DefaultColors getDefaultColors() const override { return m_colors; }
  void setDefaultColors(const DefaultColors& c) override { m_colors = c; }
  void drawLine(const btVector3& a, const btVector3& b, const btVector3& c) override {
    write("line", a, b, c);
  }
  void drawLine(const btVector3& a, const btVector3& b, const btVector3& c,
                const btVector3& d) override {
    write("line of two colours", a, b, c, d);
  }
  void drawSphere(btScalar r, const btTransform& t, const btVector3& c) override {
    write("turned sphere", r, t, c);
  }
  void drawSphere(const btVector3& p, btScalar r, const btVector3& c) override {
    write("sphere", p, r, c);
  }
  void drawTriangle(const btVector3& a, const btVector3& b, const btVector3& c, const btVector3& l,
                    const btVector3& m, const btVector3& n, const btVector3& color,
                    btScalar alpha) override {
    write("smooth triangle", a, b, c, l, m, n, color, alpha);
  }
  void drawTriangle(const btVector3& a, const btVector3& b, const btVector3& c,
                    const btVector3& color, btScalar alpha) override {
    write("triangle", a, b, c, color, alpha);
  }
  void drawContactPoint(const btVector3& p, const btVector3& n, btScalar d, int life,
                        const btVector3& c) override {
    write("contact", p, n, d, life, c);
  }
  void reportErrorWarning(const char* warning) override { write("warning", warning); }
  void draw3dText(const btVector3& p, const char* what) override { write("text", p, what); }
  void setDebugMode(int mode) override { write("mode", m_mode = mode); }
  int getDebugMode() const override { return m_mode; }
  void drawAabb(const btVector3& a, const btVector3& b, const btVector3& c) override {
    write("aabb", a, b, c);
  }
  void drawTransform(const btTransform& t, btScalar size) override { write("transform", t, size); }
  void drawArc(const btVector3& p, const btVector3& n, const btVector3& a, btScalar r, btScalar s,
               btScalar low, btScalar high, const btVector3& c, bool sector,
               btScalar step) override {
    write("arc", p, n, a, r, s, low, high, c, sector, step);
  }
  void drawSpherePatch(const btVector3& p, const btVector3& u, const btVector3& a, btScalar r,
                       btScalar low, btScalar high, btScalar left, btScalar right,
                       const btVector3& c, btScalar step, bool center) override {
    write("patch", p, u, a, r, low, high, left, right, c, step, center);
  }
  void drawBox(const btVector3& a, const btVector3& b, const btVector3& c) override {
    write("box", a, b, c);
  }
  void drawBox(const btVector3& a, const btVector3& b, const btTransform& t,
               const btVector3& c) override {
    write("turned box", a, b, t, c);
  }
  void drawCapsule(btScalar r, btScalar h, int up, const btTransform& t,
                   const btVector3& c) override {
    write("capsule", r, h, up, t, c);
  }
  void drawCylinder(btScalar r, btScalar h, int up, const btTransform& t,
                    const btVector3& c) override {
    write("cylinder", r, h, up, t, c);
  }
  void drawCone(btScalar r, btScalar h, int up, const btTransform& t, const btVector3& c) override {
    write("cone", r, h, up, t, c);
  }
  void drawPlane(const btVector3& n, btScalar d, const btTransform& t,
                 const btVector3& c) override {
    write("plane", n, d, t, c);
  }
#if BT_BULLET_VERSION >= 287
  void clearLines() override { write("clear"); }
#endif
  void flushLines() override { write("flush"); }

 private:
  template <class... T>
  void write(const char* name, const T&... what) {
    text << name;
    (put(what), ...);
    text << '\n';
  }
  template <class T>
  void put(const T& what) {
    text << ' ' << what;
  }
  void put(const btVector3& v) { text << ' ' << v.x() << ' ' << v.y() << ' ' << v.z(); }
  void put(const btTransform& t) {
    for (int i = 0; i < 3; ++i) put(t.getBasis()[i]);
    put(t.getOrigin());
  }

  int m_mode = 0;
  DefaultColors m_colors;
};

// Everything that a drawer may be told, with arguments that all differ.
void tellAll(btIDebugDraw& to) {
  double n = 0;
  const auto s = [&] { return scalar(n += 0.25); };
  const auto v = [&] {
    const btScalar x = s(), y = s();
    return btVector3(x, y, s());
  };
  const auto t = [&] {
    const btVector3 x = v(), y = v(), z = v();
    return btTransform(btMatrix3x3(x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]), v());
  };
  const btVector3 a = v(), b = v(), c = v(), d = v(), e = v(), f = v(), color = v();
  const btTransform pose = t();
  const btScalar r = s(), q = s(), low = s(), high = s(), left = s(), right = s(), step = s();
  to.setDebugMode(5);
#if BT_BULLET_VERSION >= 287
  to.clearLines();
#endif
  to.drawLine(a, b, color);
  to.drawLine(a, b, c, color);
  to.drawSphere(r, pose, color);
  to.drawSphere(a, r, color);
  to.drawTriangle(a, b, c, d, e, f, color, r);
  to.drawTriangle(a, b, c, color, r);
  to.drawContactPoint(a, b, r, 7, color);
  to.reportErrorWarning("a warning");
  to.draw3dText(a, "a text");
  to.drawAabb(a, b, color);
  to.drawTransform(pose, r);
  to.drawArc(a, b, c, r, q, low, high, color, true, step);
  to.drawSpherePatch(a, b, c, r, low, high, left, right, color, step, false);
  to.drawBox(a, b, color);
  to.drawBox(a, b, pose, color);
  to.drawCapsule(r, q, 2, pose, color);
  to.drawCylinder(r, q, 1, pose, color);
  to.drawCone(r, q, 2, pose, color);
  to.drawPlane(a, r, pose, color);
  to.flushLines();
}

TEST(JointDrawing, HandsEverythingOn) {
  Log direct, wrapped;
  tellAll(direct);
  const std::string told = direct.text.str();
  EXPECT_EQ(std::count(told.begin(), told.end(), '\n'), BT_BULLET_VERSION >= 287 ? 22 : 21);
  Scene scene;
  scene.bullet().setDebugDrawer(&wrapped);
  const pintle::JointDrawing drawing(scene.bullet());
  btIDebugDraw& drawer = *scene.bullet().getDebugDrawer();
  tellAll(drawer);
  EXPECT_EQ(wrapped.text.str(), direct.text.str());
  btIDebugDraw::DefaultColors colors;
  colors.m_aabb = vec(3, 4, 5);
  drawer.setDefaultColors(colors);
  EXPECT_EQ(wrapped.getDefaultColors().m_aabb, colors.m_aabb);
  EXPECT_EQ(drawer.getDefaultColors().m_aabb, colors.m_aabb);
}

TEST(JointDrawing, AJointIsDrawnByWhatTheDrawerHasOfItsOwn) {
  Log log;
  Scene scene;
  scene.bullet().setDebugDrawer(&log);
  const pintle::JointDrawing drawing(scene.bullet());
  log.setDebugMode(frames_mode);
  log.text.str("");
  scene.bullet().debugDrawWorld();
  std::istringstream text(log.text.str());
  std::string words, all;
  while (text >> words)
    if (std::isalpha(static_cast<unsigned char>(words[0]))) all += words + ' ';
  const std::string clear = BT_BULLET_VERSION >= 287 ? "clear " : "";
  EXPECT_EQ(all, clear + "transform transform flush ");
}

TEST(DrawJoints, OneCallDrawsThemWithoutBulletsWorld) {
  Scene scene;
  EXPECT_EQ(scene.linesOf([&] { pintle::drawJoints(scene.bullet()); }), joint_lines);
}

// The joints that derive from Bullet's, which need no JointDrawing.
TEST(DrawJoints, BulletDrawsWhatDerivesFromItsOwn) {
  Scene scene(false);
  scene.world.add_joint<pintle::BallJoint>(scene.body, vec(0, 0, 0));
  scene.world.add_joint<pintle::QuaternionHinge>(scene.body, btTransform::getIdentity());
  EXPECT_EQ(scene.drawn(), 2 * joint_lines);
  const auto drawn_by_pintle = [&] { pintle::drawJoints(scene.bullet()); };
  EXPECT_EQ(scene.linesOf(drawn_by_pintle), 0u);
  const pintle::JointDrawing drawing(scene.bullet());
  EXPECT_EQ(scene.drawn(), 2 * joint_lines);
}

TEST(DrawJoints, AWorldWithoutADrawerOrWithStockJointsOnlyIsLeftAlone) {
  scenes::World world(0);
  btRigidBody& a = world.add_box(1, vec(1, 1, 1), scenes::pose_at(vec(0, 0, 0)));
  world.add_joint<pintle::BallJoint>(a, vec(0, 0, 0));
  pintle::drawJoints(world.bullet());
  Scene stock(false);
  stock.world.add_joint<btPoint2PointConstraint>(stock.body, vec(0, 0, 0));
  EXPECT_EQ(stock.linesOf([&] { pintle::drawJoints(stock.bullet()); }), 0u);
}

}  // namespace draw_joints_test
