// What programs do with bodies and joints of the exact solver: they move, hold and drag them, break them, take them away.
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/solver/exact_joint_solver.h>

#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "books.h"
#include "cables.h"
#include "exact_support.h"
#include "physics_support.h"
#include "support.h"

namespace exact_programs_test {
namespace {

using physics::rounding;
using support::Books;
using support::largestGapOf;
using support::scalar;
using support::vec;
using namespace exact_support;

// Its owner turns the post; the arm hangs on it and keeps to its limit.
TEST(ExactEnergy, ALimitHoldsAgainstABodyThatItsOwnerMoves) {
  Books books(60);
  btRigidBody& post = books.add(0, vec(0.1, 0.1, 1), at(vec(0, 0, 0)));
  post.setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
  btRigidBody& arm = books.add(1, vec(0.5, 0.1, 0.1), at(vec(0.5, 0, 0)));
  auto made = std::make_unique<pintle::QuaternionHinge>(arm, post, vec(-0.5, 0, 0), vec(0, 0, 0),
                                                        vec(0, 0, 1), vec(0, 0, 1));
  pintle::QuaternionHinge& hinge = *made;
  hinge.setLimit(scalar(-0.3), scalar(0.3));
  books.join(std::move(made));
  double beyond = -1, turned = 0;
  for (int i = 0; i < 240; ++i) {
    books.step();
    turned += 1.5 / 60;
    post.setWorldTransform(btTransform(btQuaternion(vec(0, 0, 1), scalar(turned))));
    if (i > 0)  // Bullet knows how fast it turns when it has turned
      beyond = std::max(beyond, std::abs(double(hinge.getHingeAngle())) - 0.3);
  }
  EXPECT_GT(beyond, -0.01);  // it is driven against the limit
  EXPECT_LE(beyond, rounding(1e-4, 1e-8));
}

// A kinematic body may have a mass: its owner moves it all the same, and nobody else does.
TEST(ExactEnergy, AKinematicBodyWithAMassIsMovedByItsOwnerAlone) {
  Books books(60);
  btRigidBody& post = books.add(1, vec(0.1, 0.1, 0.1), at(vec(0, 0, 0)));
  post.setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
  btRigidBody& arm = books.add(1, vec(0.5, 0.1, 0.1), at(vec(0.5, 0, 0)));
  books.join(std::make_unique<pintle::BallJoint>(post, arm, vec(0, 0, 0), vec(-0.5, 0, 0)));
  double gap = 0;
  for (int i = 0; i < 240; ++i) {
    books.step();
    gap = std::max(gap, books.largestGap());
  }
  EXPECT_LE(gap, rounding(1e-5, 1e-8));
  EXPECT_EQ(post.getWorldTransform().getOrigin(), vec(0, 0, 0));
}

// Bodies of a game in a plane: rows across it, that they follow by rounding alone, do nothing.
TEST(ExactEnergy, RowsThatNothingFollowsDoNothing) {
  Books books(60);
  btRigidBody* bodies[2];
  for (int i = 0; i < 2; ++i) {
    bodies[i] = &books.add(1, vec(0.5, 0.1, 0.1), at(vec(i, 0, 0)));
    bodies[i]->setLinearFactor(vec(1, 1, 0));
    bodies[i]->setAngularFactor(vec(0, 0, 1));
  }
  const btTransform across(btQuaternion(vec(0, 1, 0), scalar(physics::radians(90))));
  auto hinge = std::make_unique<pintle::QuaternionHinge>(
      *bodies[0], *bodies[1], btTransform(across.getBasis(), vec(0.5, 0, 0)),
      btTransform(across.getBasis(), vec(-0.5, 0, 0.01)));
  hinge->setLimit(scalar(0.1), scalar(0.1));
  hinge->setLimitSpring(3, scalar(0.5));
  books.join(std::move(hinge));
  bodies[1]->setAngularVelocity(vec(0, 0, 3));
  for (int i = 0; i < 300; ++i) books.step();
  EXPECT_LT(bodies[1]->getAngularVelocity().length(), 4);
}

// It stores what it was given, and nothing once it is gone.
TEST(ExactEnergy, ASoftJointThatBreaksIsSolvedAsAnyOther) {
  Books books(60);
  btRigidBody& hung = books.add(5, vec(0.1, 0.1, 0.5), at(vec(0, 0, -0.5)));
  auto ball = std::make_unique<pintle::BallJoint>(hung, vec(0, 0, 0.5));
  ball->setParam(BT_CONSTRAINT_CFM, scalar(0.01));
  ball->setBreakingImpulseThreshold(scalar(0.5));
  pintle::BallJoint& joint = *ball;
  books.join(std::move(ball));
  books.step();
  EXPECT_FALSE(joint.isEnabled());
  EXPECT_EQ(books.solver.lastStep().one_by_one, 0);
}

// Two limits, a motor and a spring about and along three axes: no joint of Bullet's has more rows.
TEST(ExactEnergy, AStockJointOf24RowsIsSolved) {
  Books books(60);
  btRigidBody& arm = books.add(1, vec(0.5, 0.1, 0.1), at(vec(0.5, 0, 0)));
  auto made = std::make_unique<btGeneric6DofSpring2Constraint>(arm, at(vec(-0.5, 0, 0)));
  for (int axis = 0; axis < 6; ++axis) {
    made->setLimit(axis, scalar(-0.1), scalar(0.1));
    made->enableMotor(axis, true);
    made->setMaxMotorForce(axis, 1);
    made->enableSpring(axis, true);
    made->setStiffness(axis, 10);
  }
  btTypedConstraint::btConstraintInfo1 size;
  made->getInfo1(&size);
  EXPECT_EQ(size.m_numConstraintRows, 24);
  books.join(std::move(made));
  for (int i = 0; i < 120; ++i) books.step();
  EXPECT_TRUE(support::is_finite(arm));
  EXPECT_NEAR(arm.getCenterOfMassPosition().z(), 0, 0.2);
}

// Of joints that are gone nothing is kept.
TEST(ExactEnergy, WhatIsGoneIsForgotten) {
  Books books(60);
  btRigidBody& first = books.add(1, vec(0.1, 0.1, 0.5), at(vec(0, 0, -0.5)));
  for (int i = 0; i < 100; ++i) {
    books.join(std::make_unique<pintle::BallJoint>(first, vec(0, 0, 0.5)));
    books.step();
    EXPECT_EQ(books.solver.lastStep().components, 1);
    EXPECT_LE(books.solver.getNumRemembered(), 2);
    books.removeLastJoint();
  }
}

// 0.98 N s: a body of 6 kg at 60 Hz.
template <class Joint>
void expectToBreakByItsLoad() {
  for (const double part : {0.9, 1.1}) {
    for (const double hz : {30., 60., 120., 240.}) {
      Books books(hz);
      btRigidBody& post = books.add(0, vec(0.1, 0.1, 0.1), at(vec(0, 0, 0)));
      btRigidBody& load = books.add(6, vec(0.1, 0.1, 0.1), at(vec(0, 0, -1)));
      support::joinAt<Joint>(books, post, load, vec(0, 0, 0));
      books.joints[0]->setBreakingImpulseThreshold(scalar(part * 6 * 9.81 / hz));
      for (int i = 0; i < int(hz); ++i) books.step();
      EXPECT_EQ(books.joints[0]->isEnabled(), part > 1) << part << " of the load, " << hz << " Hz";
    }
  }
}
TEST(ExactEnergy, AThresholdIsComparedWithTheLoad) {
  expectToBreakByItsLoad<pintle::BallJoint>();
  expectToBreakByItsLoad<pintle::QuaternionHinge>();
  expectToBreakByItsLoad<btPoint2PointConstraint>();
  expectToBreakByItsLoad<btHingeConstraint>();
}

// By 0.5 m a frame, as a mouse does: stock's lags by 2 m.
TEST(ExactEnergy, ABodyThatIsDraggedFollows) {
  Books books(60);
  btRigidBody& body = books.add(1, vec(0.3, 0.3, 0.3), at(vec(0, 0, 0)));
  auto ball = std::make_unique<pintle::BallJoint>(body, vec(0, 0, 0));
  pintle::BallJoint& drag = *ball;
  books.join(std::move(ball));
  double lag = 0, spin = 0;
  for (int i = 0; i < 120; ++i) {
    const btVector3 to = vec(3 * std::cos(i * 0.5 / 3) - 3, 3 * std::sin(i * 0.5 / 3), 0);
    drag.setPivotB(to);
    books.step();
    lag = std::max(lag, double((body.getCenterOfMassPosition() - to).length()));
    spin = std::max(spin, double(body.getAngularVelocity().length()));
  }
  EXPECT_LE(lag, 2.05);
  EXPECT_LE(spin, rounding(1e-3, 1e-9));
}

TEST(ExactEnergy, ABodyThatOnlyTurnsIsHeld) {
  Books books(60);
  btRigidBody& post = books.add(0, vec(0.1, 0.1, 0.1), at(vec(0, 0, 0)));
  btRigidBody& wheel = books.add(1, vec(0.3, 0.3, 0.1), at(vec(0, 0, 0)));
  wheel.setLinearFactor(vec(0, 0, 0));
  books.join(std::make_unique<pintle::QuaternionHinge>(post, wheel, vec(0, 0, 0), vec(0, 0, 0),
                                                       vec(0, 0, 1), vec(0, 0, 1)));
  wheel.setAngularVelocity(vec(2, 1, 10));
  for (int i = 0; i < 300; ++i) books.step();
  EXPECT_NEAR(double(wheel.getCenterOfMassTransform().getBasis().getColumn(2).z()), 1,
              rounding(1e-5, 1e-12));
  EXPECT_NEAR(double(wheel.getAngularVelocity().z()), 10, rounding(1e-3, 1e-6));
}

// Its joint has no row: it is in no component.
TEST(ExactEnergy, ABodyWhoseJointHoldsNothingIsFree) {
  Books books(60);
  btRigidBody& post = books.add(0, vec(0.1, 0.1, 0.1), at(vec(0, 0, 0)));
  btRigidBody& held = books.add(1, vec(0.1, 0.1, 0.1), at(vec(0.5, 0, 0)));
  btRigidBody& free = books.add(1, vec(0.1, 0.1, 0.1), at(vec(1, 0, 0)));
  books.join(std::make_unique<pintle::BallJoint>(post, held, vec(0, 0, 0), vec(-0.5, 0, 0)));
  auto loose = std::make_unique<btGeneric6DofSpring2Constraint>(held, free, at(vec(0, 0, 0)),
                                                                at(vec(0, 0, 0)));
  for (int i = 0; i < 6; ++i) loose->setLimit(i, 1, -1);
  books.join(std::move(loose));
  for (int i = 0; i < 30; ++i) books.step();
  EXPECT_NEAR(double(free.getLinearVelocity().z()), -9.81 / 2, 1e-4);
  EXPECT_EQ(free.getLinearVelocity().x(), 0);
  EXPECT_TRUE(free.getAngularVelocity().isZero());
}

// A stock joint is asked for its rows at the start alone; three of them are a ball, whose end is known.
TEST(ExactEnergy, StockHingesHoldTheirPivots) {
  Books books(60);
  btRigidBody& post = books.add(0, vec(0.1, 0.1, 0.1), at(vec(0, 0, 0)));
  btRigidBody* last = &post;
  for (int i = 0; i < 4; ++i) {
    btRigidBody& link = books.add(1, vec(0.25, 0.05, 0.05), at(vec(0.5 * i + 0.25, 0, 0)));
    books.join(std::make_unique<btHingeConstraint>(*last, link,
                                                   i > 0 ? vec(0.25, 0, 0) : vec(0, 0, 0),
                                                   vec(-0.25, 0, 0), vec(0, 1, 0), vec(0, 1, 0)));
    last = &link;
  }
  double gap = 0;
  for (int i = 0; i < 120; ++i) {
    books.step();
    gap = std::max(gap, largestGapOf<btHingeConstraint>(books));
  }
  EXPECT_LE(gap, rounding(1e-5, 1e-8));
}

}  // namespace
}  // namespace exact_programs_test
