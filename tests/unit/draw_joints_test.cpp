// Debug drawing: a joint that takes the place of a stock one draws the lines that that one draws, and
// one call draws the Pintle joints of a world.
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <gtest/gtest.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/draw_joints.h>
#include <pintle/joints/quaternion_hinge.h>

#include "drawing.h"
#include "joint_kinds.h"
#include "support.h"

namespace draw_joints_test {

using drawing::Line;
using drawing::Recorder;
using support::scalar;
using support::vec;

constexpr int modes[] = {
    btIDebugDraw::DBG_NoDebug, btIDebugDraw::DBG_DrawConstraints,
    btIDebugDraw::DBG_DrawConstraintLimits,
    btIDebugDraw::DBG_DrawConstraints | btIDebugDraw::DBG_DrawConstraintLimits};

// The lines of a world with one joint, made by `add`, drawn by Bullet or by us.
template <class Add, class Draw>
std::vector<Line> lines(int mode, Add add, Draw draw) {
  scenes::World world(0);
  btRigidBody& a = world.add_box(1, vec(0.5, 0.2, 0.1), scenes::pose_at(vec(0, 0, 0)));
  btRigidBody& b = world.add_box(1, vec(0.5, 0.2, 0.1),
                                 btTransform(btQuaternion(vec(0, 0, 1), 1), vec(1, 0, 0)));
  add(world, a, b);
  Recorder recorder(mode);
  world.bullet().setDebugDrawer(&recorder);
  draw(world.bullet());
  return recorder.lines;
}

void expectSame(const std::vector<Line>& ours, const std::vector<Line>& stock) {
  ASSERT_EQ(ours.size(), stock.size());
  for (size_t i = 0; i < ours.size(); ++i) {
    EXPECT_LE(double((ours[i].from - stock[i].from).length()), 1e-5) << i;
    EXPECT_LE(double((ours[i].to - stock[i].to).length()), 1e-5) << i;
  }
}

const auto by_bullet = [](btDiscreteDynamicsWorld& world) { world.debugDrawWorld(); };
const auto by_us = [](btDiscreteDynamicsWorld& world) { pintle::drawJoints(world); };

TEST(DrawJoints, AHingeDrawsTheLinesOfStocks) {
  const double limits[][2] = {{-1, 0.5}, {1, -1}, {0.3, 0.3}, {0, 2}};
  for (const int mode : modes) {
    for (const auto& limit : limits) {
      SCOPED_TRACE(testing::Message() << "mode " << mode << ", limit " << limit[0]);
      const auto add = [&](auto type, auto& world, auto& a, auto& b) {
        using Hinge = typename decltype(type)::type;
        auto& hinge = world.template add_joint<Hinge>(a, b, vec(0.5, 0, 0), vec(-0.5, 0, 0),
                                                      vec(0, 0, 1), vec(0, 0, 1));
        hinge.setLimit(scalar(limit[0]), scalar(limit[1]));
        hinge.setDbgDrawSize(scalar(0.7));
      };
      const auto stock = [&](auto&... all) { add(std::common_type<btHingeConstraint>(), all...); };
      const auto ours = [&](auto&... all) {
        add(std::common_type<pintle::QuaternionHinge>(), all...);
      };
      expectSame(lines(mode, ours, by_us), lines(mode, stock, by_bullet));
    }
  }
}

TEST(DrawJoints, ABallDrawsTheLinesOfStocks) {
  for (const int mode : modes) {
    // Bullet's world looks at no joint without these.
    if (mode == btIDebugDraw::DBG_NoDebug) continue;
    const auto stock = [](auto& world, auto& a, auto& b) {
      world.template add_joint<btPoint2PointConstraint>(a, b, vec(0.5, 0, 0), vec(-0.5, 0.1, 0));
    };
    const auto ours = [](auto& world, auto& a, auto& b) {
      world.template add_joint<pintle::BallJoint>(a, b, vec(0.5, 0, 0), vec(-0.5, 0.1, 0));
    };
    expectSame(lines(mode, ours, by_us), lines(mode, stock, by_bullet));
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
      for (const int mode : modes) {
        const auto drawn = lines(mode, add, by_us);
        EXPECT_TRUE(mode != btIDebugDraw::DBG_NoDebug || drawn.empty());
        EXPECT_TRUE(!(mode & btIDebugDraw::DBG_DrawConstraints) || !drawn.empty());
        for (const Line& line : drawn) {
          EXPECT_TRUE(support::is_finite(line.from));
          EXPECT_TRUE(support::is_finite(line.to));
        }
        // As in Bullet, a size of zero draws nothing.
        const auto add_small = [&](scenes::World& world, btRigidBody& a, btRigidBody& b) {
          add(world, a, b);
          world.bullet().getConstraint(0)->setDbgDrawSize(0);
        };
        EXPECT_EQ(lines(mode, add_small, by_us).size(), 0u);
      }
    }
  }
}

TEST(DrawJoints, AWorldWithoutADrawerOrWithStockJointsOnlyIsLeftAlone) {
  scenes::World world(0);
  btRigidBody& a = world.add_box(1, vec(1, 1, 1), scenes::pose_at(vec(0, 0, 0)));
  world.add_joint<pintle::BallJoint>(a, vec(0, 0, 0));
  pintle::drawJoints(world.bullet());
  scenes::World stock(0);
  btRigidBody& b = stock.add_box(1, vec(1, 1, 1), scenes::pose_at(vec(0, 0, 0)));
  stock.add_joint<btPoint2PointConstraint>(b, vec(0, 0, 0));
  Recorder recorder;
  stock.bullet().setDebugDrawer(&recorder);
  pintle::drawJoints(stock.bullet());
  EXPECT_TRUE(recorder.lines.empty());
}

}  // namespace draw_joints_test
