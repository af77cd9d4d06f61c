// A gear of Pintle's is one of Bullet's: what clients do to one, through whatever pointer they hold it.
#include <BulletDynamics/ConstraintSolver/btGearConstraint.h>
#include <gtest/gtest.h>
#include <pintle/joints/draw_joints.h>
#include <pintle/joints/gear_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>

#include <functional>
#include <memory>
#include <string>

#include "drawing.h"
#include "support.h"

namespace derived_gear_test {
namespace {

using pintle::GearCoordinate;
using pintle::GearJoint;
using pintle::QuaternionHinge;
using support::infinite;
using support::nan_value;
using support::refusal;
using support::scalar;
using support::SolverRows;
using support::vec;

struct Pair {
  std::unique_ptr<btRigidBody> a =
      support::body(1, vec(1, 2, 3), btTransform(btQuaternion(vec(0, 1, 0), scalar(0.3))));
  std::unique_ptr<btRigidBody> b = support::body(
      2, vec(2, 1, 2), btTransform(btQuaternion(vec(1, 0, 0), scalar(0.7)), vec(1, 0.1, 0)));
  GearJoint gear{*a, *b, vec(0, 0, 1), vec(0, 0.6, 0.8), scalar(2.5)};
  btGearConstraint& stock() { return gear; }

  void turnB(double angle) {
    const btVector3 axis = b->getCenterOfMassTransform().getBasis() * gear.getAxisB();
    btTransform pose = b->getCenterOfMassTransform();
    pose.setBasis(btMatrix3x3(btQuaternion(axis.normalized(), scalar(angle))) * pose.getBasis());
    b->setCenterOfMassTransform(pose);
  }
};

TEST(DerivedGear, IsAGearOfBulletsAtTheSameAddress) {
  Pair pair;
  btTypedConstraint* const constraint = &pair.gear;
  EXPECT_EQ(constraint->getConstraintType(), GEAR_CONSTRAINT_TYPE);
  void* const handle = &pair.gear;
  EXPECT_EQ(static_cast<btGearConstraint*>(handle), &pair.stock());
}

// Before anything is off: the direction of its row, its softness and bounds.
TEST(DerivedGear, HasBulletsRow) {
  Pair pair;
  btGearConstraint stock(*pair.a, *pair.b, vec(0, 0, 1), vec(0, 0.6, 0.8), scalar(2.5));
  const SolverRows ours = SolverRows::ofStep(pair.gear), bullets = SolverRows::ofStep(stock);
  ASSERT_EQ(ours.announced(), 1);
  ASSERT_EQ(bullets.announced(), 1);
  for (const int first : {3, 9})  // angular
    for (int i = first; i < first + 3; ++i) EXPECT_EQ(ours[0].fields[i], bullets[0].fields[i]) << i;
  for (const int first : {0, 6})  // linear, which Bullet leaves
    for (int i = first; i < first + 3; ++i) EXPECT_EQ(ours[0].fields[i], 0) << i;
  EXPECT_EQ(ours[0].rhs(), 0);
  EXPECT_EQ(ours[0].cfm(), 0);
  EXPECT_EQ(ours[0].lower(), -SIMD_INFINITY);
  EXPECT_EQ(ours[0].upper(), SIMD_INFINITY);
}

TEST(DerivedGear, WhatAnyPointerWritesHoldsInTheNextStep) {
  const std::function<void(btGearConstraint&)> changes[] = {
      [](auto& gear) {
        btVector3 axis = vec(0.6, 0, 0.8);
        gear.setAxisA(axis);
      },
      [](auto& gear) {
        btVector3 axis = vec(1, 0, 0);
        gear.setAxisB(axis);
      },
      [](auto& gear) { gear.setRatio(-1); },
  };
  for (const auto& change : changes) {
    Pair before, changed;
    SolverRows::ofStep(before.gear);
    const SolverRows rows = SolverRows::ofStep(before.gear);
    change(before.stock());
    change(changed.stock());
    const SolverRows now = SolverRows::ofStep(before.gear);
    EXPECT_NE(now, rows);
    EXPECT_EQ(now, SolverRows::ofStep(changed.gear));
    btGearConstraint stock(*before.a, *before.b, before.gear.getAxisA(), before.gear.getAxisB(),
                           before.gear.getRatio());
    const SolverRows bullets = SolverRows::ofStep(stock);
    for (const int first : {3, 9})
      for (int i = first; i < first + 3; ++i)
        EXPECT_EQ(now[0].fields[i], bullets[0].fields[i]) << i;
  }
}

// An axis of any length counts as many times, as its row turns.
TEST(DerivedGear, CountsALongAxisAsManyTimes) {
  Pair pair;
  btVector3 axis = vec(0, 3, 4);
  pair.stock().setAxisB(axis);
  EXPECT_EQ(double(pair.gear.getCoordinateB()), 0);
  pair.turnB(0.1);
  EXPECT_NEAR(double(pair.gear.getCoordinateB()), 0.5, 1e-6);
  EXPECT_NEAR(double(pair.gear.getError()), 2.5 * 0.5, 1e-5);
}

TEST(DerivedGear, OfWhatIsNotANumberTheLastGoodOneStays) {
  struct Bad {
    const char* name;
    std::function<void(btGearConstraint&, btScalar)> write;
  };
  const Bad all[] = {
      {"axisA",
       [](auto& gear, btScalar x) {
         btVector3 axis(0, x, 1);
         gear.setAxisA(axis);
       }},
      {"axisB",
       [](auto& gear, btScalar x) {
         btVector3 axis(x, scalar(0.6), scalar(0.8));
         gear.setAxisB(axis);
       }},
      {"ratio", [](auto& gear, btScalar x) { gear.setRatio(x); }},
  };
  for (const Bad& bad : all) {
    for (const btScalar value : {nan_value, infinite, -infinite}) {
      SCOPED_TRACE(testing::Message() << bad.name << " = " << value);
      Pair pair, twin;
      for (Pair* of : {&pair, &twin}) {
        SolverRows::ofStep(of->gear);
        of->turnB(0.1);
      }
      bad.write(pair.gear, value);
      EXPECT_EQ(SolverRows::ofStep(pair.gear), SolverRows::ofStep(twin.gear));
      EXPECT_LT(SolverRows::ofStep(pair.gear)[0].rhs(), 0);  // 0.1 rad off
      const std::string why = pair.gear.whyIgnored();
      EXPECT_NE(why.find("GearJoint"), std::string::npos) << why;
      EXPECT_NE(why.find(bad.name), std::string::npos) << why;
      bad.write(pair.gear, 0);
      EXPECT_EQ(pair.gear.whyIgnored(), "");
      EXPECT_EQ(SolverRows::ofStep(pair.gear).announced(), 1);
    }
  }
}

TEST(DerivedGear, HoldsNothingBeforeItHasAxesAndARatio) {
  Pair pair;
  GearJoint gear(*pair.a, *pair.b, vec(0, nan_value, 0), vec(0, 0, 1), nan_value);
  EXPECT_EQ(SolverRows::ofStep(gear).announced(), 0);
  gear.setRatio(1);
  btVector3 axis = vec(1, 0, 0);
  gear.setAxisA(axis);
  EXPECT_EQ(SolverRows::ofStep(gear).announced(), 1);
}

TEST(DerivedGear, RefusesWhatIsNotFiniteOfItsOwn) {
  Pair pair;
  QuaternionHinge of_a(*pair.a, btTransform::getIdentity(), true),
      of_b(*pair.b, btTransform::getIdentity(), true);
  EXPECT_NE(refusal([&] { GearJoint(of_a, of_b, nan_value); }).find("GearJoint: ratio"),
            std::string::npos);
  of_b.getBFrame().getOrigin().setX(infinite);
  EXPECT_NE(refusal([&] { GearJoint(of_a, of_b, 1); }).find("GearJoint: frames of a hinge"),
            std::string::npos);
}

// The joints that it was made of may end before it does.
TEST(DerivedGear, OutlivesItsJoints) {
  Pair pair;
  std::unique_ptr<GearJoint> gear;
  {
    QuaternionHinge of_a(*pair.a, btTransform::getIdentity(), true),
        of_b(*pair.b, btTransform::getIdentity(), true);
    gear = std::make_unique<GearJoint>(of_a, of_b, 1);
  }
  EXPECT_TRUE(SolverRows::ofStep(*gear).finite());
  EXPECT_EQ(&gear->getRigidBodyA(), pair.a.get());
}

// Signs are those of the joints' own angles and positions.
TEST(DerivedGear, MeasuresAsItsJointsDo) {
  const btTransform frame(btQuaternion(vec(0.6, 0, 0.8), 1), vec(0.1, 0.2, 0));
  for (const bool reference_a : {false, true}) {
    Pair pair;
    const auto move = [&](const btTransform& by) {
      pair.b->setCenterOfMassTransform(pair.a->getCenterOfMassTransform() * frame * by *
                                       frame.inverse());
    };
    QuaternionHinge hinge(*pair.a, *pair.b, frame, frame, reference_a);
    pintle::SliderJoint slider(*pair.a, *pair.b, frame, frame, reference_a);
    move(btTransform(btQuaternion(vec(0, 0, 1), scalar(-0.3))));
    GearJoint wheel(hinge, hinge, 1);
    EXPECT_NEAR(double(wheel.getCoordinateA()), double(hinge.getHingeAngle()), 1e-6);
    move(btTransform(btQuaternion(vec(0, 0, 1), scalar(0.2))));
    EXPECT_NEAR(double(wheel.getCoordinateA()), double(hinge.getHingeAngle()), 1e-6);
    EXPECT_EQ(double(wheel.getCoordinateA()) < 0, !reference_a);
    move(btTransform(btQuaternion(vec(1, 0, 0), scalar(0.2)), vec(0.3, 0, 0)));
    GearJoint screw(GearCoordinate::angleOf(slider), slider, 1);
    EXPECT_NEAR(double(screw.getCoordinateA()), 0.2, 1e-6);
    EXPECT_NEAR(double(screw.getCoordinateB()), reference_a ? 0.3 : -0.3, 1e-6);
    EXPECT_NEAR(double(screw.getCoordinateB()), double(slider.getLinearPos()), 1e-6);
  }
}

// Another axis takes the place of the coordinate of a joint.
TEST(DerivedGear, AnAxisThatIsSetMakesItOneOfABody) {
  Pair pair;
  QuaternionHinge of_a(*pair.a, btTransform::getIdentity(), true),
      of_b(*pair.b, btTransform::getIdentity(), true);
  GearJoint gear(of_a, of_b, 1);
  btVector3 axis = vec(0, 0, 2);
  gear.setAxisB(axis);
  EXPECT_EQ(double(gear.getCoordinateB()), 0);
  const SolverRows rows = SolverRows::ofStep(gear);
  const btVector3 now = pair.b->getCenterOfMassTransform().getBasis() * axis;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(rows[0].fields[9 + i], now[i]);
  EXPECT_EQ(rows[0].rhs(), 0);
}

TEST(DerivedGear, DrawsItsAxes) {
  scenes::World world(0);
  btRigidBody &a = world.add_box(1, vec(1, 1, 1), scenes::pose_at(vec(0, 0, 0))),
              &b = world.add_box(1, vec(1, 1, 1), scenes::pose_at(vec(3, 0, 0)));
  world.add_joint<GearJoint>(a, b, vec(0, 0, 1), vec(0, 1, 0)).setDbgDrawSize(2);
  drawing::Recorder drawer(btIDebugDraw::DBG_DrawConstraints);
  world.bullet().setDebugDrawer(&drawer);
  world.bullet().debugDrawWorld();
  EXPECT_TRUE(drawer.lines.empty());  // Bullet draws none
  pintle::drawJoints(world.bullet());
  const auto has = [&](const btVector3& from, const btVector3& to) {
    for (const auto& line : drawer.lines)
      if ((line.from - from).length() < scalar(1e-5) && (line.to - to).length() < scalar(1e-5))
        return true;
    return false;
  };
  EXPECT_TRUE(has(vec(0, 0, -2), vec(0, 0, 2)));
  EXPECT_TRUE(has(vec(3, -2, 0), vec(3, 2, 0)));
  world.bullet().setDebugDrawer(nullptr);
}

}  // namespace
}  // namespace derived_gear_test
