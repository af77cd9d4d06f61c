// A ball joint of Pintle's is one of Bullet's: what clients do to one, through whatever pointer they hold it.
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <gtest/gtest.h>
#include <pintle/joints/ball_joint.h>

#include <functional>
#include <memory>
#include <string>

#include "support.h"

namespace derived_ball_test {
namespace {

using pintle::BallJoint;
using support::infinite;
using support::nan_value;
using support::scalar;
using support::SolverRows;
using support::vec;

constexpr double dt = 1. / 60;

struct Pair {
  std::unique_ptr<btRigidBody> a = support::body(1, vec(1, 2, 3), scenes::pose_at(vec(0, 0, 0)));
  std::unique_ptr<btRigidBody> b = support::body(2, vec(2, 1, 2), scenes::pose_at(vec(1, 0.1, 0)));
  BallJoint ball{*a, *b, vec(0.5, 0, 0), vec(-0.5, 0, 0)};
  btPoint2PointConstraint& stock() { return ball; }
};

TEST(DerivedBall, IsABallOfBulletsAtTheSameAddress) {
  Pair pair;
  btTypedConstraint* const constraint = &pair.ball;
  EXPECT_EQ(constraint->getConstraintType(), POINT2POINT_CONSTRAINT_TYPE);
  void* const handle = &pair.ball;
  EXPECT_EQ(static_cast<btPoint2PointConstraint*>(handle), &pair.stock());
}

TEST(DerivedBall, WhatAnyPointerWritesHoldsInTheNextStep) {
  const std::function<void(btPoint2PointConstraint&)> changes[] = {
      [](auto& ball) { ball.setPivotA(vec(0.4, 0.1, 0)); },
      [](auto& ball) { ball.setPivotB(vec(-0.4, 0.1, 0)); },
      [](auto& ball) { ball.m_setting.m_damping = scalar(0.5); },
      [](auto& ball) { ball.m_setting.m_impulseClamp = 2; },
      [](auto& ball) { ball.setParam(BT_CONSTRAINT_ERP, scalar(0.7)); },
      [](auto& ball) { ball.setParam(BT_CONSTRAINT_CFM, scalar(0.1)); },
  };
  for (const auto& change : changes) {
    Pair before, changed;
    SolverRows::ofStep(before.ball);
    const SolverRows rows = SolverRows::ofStep(before.ball);
    change(before.stock());
    change(changed.stock());
    const SolverRows now = SolverRows::ofStep(before.ball);
    EXPECT_NE(now, rows);
    EXPECT_EQ(now, SolverRows::ofStep(changed.ball));
  }
}

// A drag by the mouse, as Bullet's examples do it through a pointer to Bullet's class.
TEST(DerivedBall, IsDraggedByBulletsPointer) {
  scenes::World world;
  btRigidBody& body = world.add_box(1, vec(0.2, 0.2, 0.2), scenes::pose_at(vec(0, 0, 0)));
  btTypedConstraint& picked = world.add_joint<BallJoint>(body, vec(0, 0, 0));
  ASSERT_EQ(picked.getConstraintType(), POINT2POINT_CONSTRAINT_TYPE);
  auto& stock = static_cast<btPoint2PointConstraint&>(picked);
  stock.m_setting.m_impulseClamp = 30;
  for (int i = 0; i < 120; ++i) {
    stock.setPivotB(vec(std::min(1., i / 60.), 0, 0));
    world.step(dt);
  }
  EXPECT_LT(double((body.getCenterOfMassPosition() - vec(1, 0, 0)).length()), 0.01);
}

TEST(DerivedBall, OfWhatIsNotANumberTheLastGoodOneStays) {
  struct Bad {
    const char* name;
    std::function<void(btPoint2PointConstraint&, btScalar)> write;
  };
  const Bad all[] = {
      {"pivotA",
       [](auto& ball, btScalar x) {
         ball.setPivotA({scalar(0.5), x, 0});
       }},
      {"pivotB",
       [](auto& ball, btScalar x) {
         ball.setPivotB({scalar(-0.5), 0, x});
       }},
      {"damping", [](auto& ball, btScalar x) { ball.m_setting.m_damping = x; }},
      {"impulse clamp", [](auto& ball, btScalar x) { ball.m_setting.m_impulseClamp = x; }},
      {"ERP", [](auto& ball, btScalar x) { ball.setParam(BT_CONSTRAINT_ERP, x); }},
      {"CFM", [](auto& ball, btScalar x) { ball.setParam(BT_CONSTRAINT_CFM, x); }},
  };
  for (const Bad& bad : all) {
    for (const btScalar value : {nan_value, infinite, -infinite}) {
      if (bad.name == std::string("impulse clamp") && !std::isnan(value))
        continue;  // none, as in Bullet
      SCOPED_TRACE(testing::Message() << bad.name << " = " << value);
      Pair pair, twin;
      for (Pair* of : {&pair, &twin}) {
        of->ball.setParam(BT_CONSTRAINT_ERP, scalar(0.3));
        of->ball.setParam(BT_CONSTRAINT_CFM, scalar(0.1));
        SolverRows::ofStep(of->ball);
      }
      bad.write(pair.ball, value);
      EXPECT_EQ(SolverRows::ofStep(pair.ball), SolverRows::ofStep(twin.ball));
      const std::string why = pair.ball.whyIgnored();
      EXPECT_NE(why.find("BallJoint"), std::string::npos) << why;
      EXPECT_NE(why.find(bad.name), std::string::npos) << why;
      bad.write(pair.ball, 0);
      EXPECT_EQ(pair.ball.whyIgnored(), "");
      EXPECT_EQ(SolverRows::ofStep(pair.ball).announced(), 3);
    }
  }
}

TEST(DerivedBall, HoldsNothingBeforeItHasPivots) {
  Pair pair;
  BallJoint ball(*pair.a, *pair.b, vec(0, nan_value, 0), vec(0, 0, 0));
  EXPECT_EQ(SolverRows::ofStep(ball).announced(), 0);
  ball.setPivotA(vec(0, 0, 0));
  EXPECT_EQ(SolverRows::ofStep(ball).announced(), 3);
}

TEST(DerivedBall, TakesADampingBelowZero) {
  Pair pair;
  pair.ball.m_setting.m_damping = -1;
  EXPECT_TRUE(SolverRows::ofStep(pair.ball).finite());
  EXPECT_NE(pair.ball.whyIgnored().find("damping"), std::string::npos);
}

// Bullet leaves what was never set as the memory was.
TEST(DerivedBall, ParametersThatAreNotSetAreZero) {
  Pair pair;
  EXPECT_EQ(pair.stock().getParam(BT_CONSTRAINT_ERP), 0);
  EXPECT_EQ(pair.stock().getParam(BT_CONSTRAINT_CFM), 0);
  EXPECT_EQ(pair.stock().getFlags(), 0);
}

}  // namespace
}  // namespace derived_ball_test
