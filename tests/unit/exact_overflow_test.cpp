// Steps of the exact solver that lead to numbers which the build's precision does not hold.
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/solver/exact_joint_solver.h>
#include <pintle/solver/exact_multi_body_joint_solver.h>

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyPoint2Point.h>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "books.h"
#include "physics_support.h"
#include "support.h"

namespace exact_overflow_test {
namespace {

using physics::rounding;
using support::Books;
using support::scalar;
using support::vec;

constexpr btScalar largest = std::numeric_limits<btScalar>::max();
constexpr double dt = 1. / 60;

/// A heavy body that flies along x takes a tiny one with it, by a point that is not its centre: that turns about y, faster than Bullet's
/// numbers go.
struct Takes {
  Takes(support::Bodies& bodies, const btVector3& at, bool collides = false)
      : start(at),
        heavy(bodies.add(1000, vec(0.1, 0.1, 0.1), at, collides)),
        tiny(bodies.add(1, vec(0.001, 0.001, 0.001), at + vec(0, 0, 1))) {
    auto made =
        std::make_unique<pintle::BallJoint>(heavy, tiny, vec(0, 0, 1.001), vec(0, 0, 0.001));
    joint = made.get();
    joint->enableFeedback(true);
    joint->setJointFeedback(&feedback);
    bodies.join(std::move(made));
    heavy.setAngularFactor(vec(0, 0, 0));
  }
  void fly() { heavy.setLinearVelocity(btVector3(largest / 100, 0, 0)); }
  /// Back to where they were, at rest.
  void stop() {
    for (btRigidBody* body : {&heavy, &tiny}) {
      const btTransform pose(btQuaternion::getIdentity(),
                             body == &heavy ? start : start + vec(0, 0, 1));
      body->setWorldTransform(pose);
      body->setInterpolationWorldTransform(pose);
      body->setLinearVelocity(vec(0, 0, 0));
      body->setAngularVelocity(vec(0, 0, 0));
      body->clearForces();
    }
  }

  btVector3 start;
  btRigidBody &heavy, &tiny;
  pintle::BallJoint* joint;
  btJointFeedback feedback;
};

void expectNothingActs(const btTypedConstraint& joint) {
  EXPECT_EQ(joint.getAppliedImpulse(), 0);
  const btJointFeedback* const feedback = joint.getJointFeedback();
  ASSERT_NE(feedback, nullptr);
  for (const btVector3* of : {&feedback->m_appliedForceBodyA, &feedback->m_appliedTorqueBodyA,
                              &feedback->m_appliedForceBodyB, &feedback->m_appliedTorqueBodyB})
    EXPECT_TRUE(of->isZero());
}

// v + g dt, and the pose that it leads to.
void expectForcesAlone(const btRigidBody& body, const btVector3& from, const btVector3& v) {
  const btVector3 end = v + vec(0, 0, -support::gravity * dt);
  const btVector3 now = body.getLinearVelocity();
  EXPECT_TRUE(body.getAngularVelocity().isZero());
  const btVector3 x = body.getCenterOfMassPosition(), to = from + scalar(dt) * end;
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(double(now[k]), double(end[k]), 1e-6 * (1 + std::abs(double(end[k])))) << k;
    EXPECT_NEAR(double(x[k]), double(to[k]), 1e-6 * (1 + std::abs(double(to[k])))) << k;
  }
}

TEST(Overflow, LeavesBodiesToForcesAndTheNextStepsAsTheyWere) {
  Books books(60);
  Takes takes(books, vec(0, 0, 0));
  for (int i = 0; i < 5; ++i) books.step();  // there is something to begin with
  for (int again = 0; again < 2; ++again) {
    SCOPED_TRACE(again);
    takes.stop();
    takes.fly();
    books.step();
    expectForcesAlone(takes.heavy, takes.start, btVector3(largest / 100, 0, 0));
    expectForcesAlone(takes.tiny, takes.start + vec(0, 0, 1), vec(0, 0, 0));
    expectNothingActs(*takes.joint);
    EXPECT_EQ(books.solver.lastStep().not_converged, 1);
    EXPECT_EQ(books.solver.lastStep().overflowed, 1);

    takes.stop();
    takes.heavy.setLinearVelocity(vec(1, 0, 0));
    for (int i = 0; i < 60; ++i) {
      books.step();
      ASSERT_EQ(books.solver.lastStep().overflowed, 0) << i;
      ASSERT_EQ(books.solver.lastStep().not_converged, 0) << i;
      ASSERT_LE(books.largestGap(), rounding(1e-5, 1e-8)) << i;
      ASSERT_LE(std::abs(books.solver.lastStep().ledger), 1000) << i;
    }
  }
}

// It is new to the step as any other one is: what it had before tells nothing.
TEST(Overflow, LeavesTheNextStepsAsThoseOfANewWorld) {
  const auto run = [](bool overflows) {
    Books books(60);
    Takes takes(books, vec(0, 0, 0));
    if (overflows) {
      takes.fly();
      books.step();
      EXPECT_EQ(books.solver.lastStep().overflowed, 1);
    }
    takes.stop();
    takes.heavy.setLinearVelocity(vec(1, 2, 0));
    for (int i = 0; i < 30; ++i) books.step();
    return takes.tiny.getCenterOfMassTransform();
  };
  EXPECT_EQ(run(false), run(true));
}

// A body near the largest position there is, which its joint takes beyond.
TEST(Overflow, IsOfPosesToo) {
  Books books(60);
  const auto along = [](double part) { return btVector3(scalar(part) * largest, 0, 0); };
  btRigidBody& heavy = books.add(1000, vec(0.1, 0.1, 0.1), along(0.995));
  btRigidBody& light = books.add(1, vec(0.1, 0.1, 0.1), along(0.998));
  auto made = std::make_unique<pintle::BallJoint>(heavy, light, vec(0, 0, 0), vec(0, 0, 0));
  made->setFormulation(pintle::Formulation::document);
  made->setParam(BT_CONSTRAINT_ERP, 0);
  btJointFeedback feedback;
  made->enableFeedback(true);
  made->setJointFeedback(&feedback);
  books.join(std::move(made));
  heavy.setLinearVelocity(along(0.2));
  books.step();
  expectForcesAlone(heavy, along(0.995), along(0.2));
  expectForcesAlone(light, along(0.998), vec(0, 0, 0));
  expectNothingActs(*books.joints[0]);
  EXPECT_EQ(books.solver.lastStep().overflowed, 1);
  EXPECT_EQ(books.solver.lastStep().not_converged, 1);
}

// A pendulum, whose bob the heavy body touches, and a box that lies on the bob: forces alone move them. One that nothing touches holds.
TEST(Overflow, LeavesAllThatContactsJoin) {
  Books books(60);
  books.world.getSolverInfo().m_minimumSolverBatchSize = 128;  // all islands at once
  Takes takes(books, vec(0, 0, 0), true);
  const auto hang = [&](const btVector3& at) -> btRigidBody& {
    btRigidBody& bob = books.add(1, vec(0.1, 0.1, 0.1), at, true);
    auto ball = std::make_unique<pintle::BallJoint>(bob, vec(-0.5, 0, 0));
    ball->enableFeedback(true);
    books.join(std::move(ball));
    return bob;
  };
  btRigidBody& bob = hang(vec(0, 0, -0.199));
  btRigidBody& box = books.add(1, vec(0.1, 0.1, 0.1), vec(-0.15, 0, -0.397), true);
  btRigidBody& other = hang(vec(0, 10, 0));
  btJointFeedback of_bob, of_other;
  books.joints[1]->setJointFeedback(&of_bob);
  books.joints[2]->setJointFeedback(&of_other);
  takes.fly();
  books.step();
  expectForcesAlone(takes.heavy, takes.start, btVector3(largest / 100, 0, 0));
  expectForcesAlone(takes.tiny, takes.start + vec(0, 0, 1), vec(0, 0, 0));
  expectForcesAlone(bob, vec(0, 0, -0.199), vec(0, 0, 0));
  expectForcesAlone(box, vec(-0.15, 0, -0.397), vec(0, 0, 0));
  expectNothingActs(*takes.joint);
  expectNothingActs(*books.joints[1]);
  int points = 0;
  for (int i = 0; i < books.dispatcher.getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *books.dispatcher.getManifoldByIndexInternal(i);
    for (int k = 0; k < manifold.getNumContacts(); ++k, ++points) {
      EXPECT_EQ(manifold.getContactPoint(k).m_appliedImpulse, 0);
      EXPECT_EQ(manifold.getContactPoint(k).m_appliedImpulseLateral1, 0);
    }
  }
  EXPECT_GT(points, 4) << "they touch";
  EXPECT_EQ(books.solver.lastStep().overflowed, 2);
  EXPECT_EQ(books.solver.lastStep().not_converged, 2);
  // It is held, and turns.
  EXPECT_GT(double(of_other.m_appliedForceBodyA.length()), 0.1);
  EXPECT_GT(double(other.getAngularVelocity().length()), 0.01);
  EXPECT_LE(
      double((other.getCenterOfMassTransform() * vec(-0.5, 0, 0) - vec(-0.5, 10, 0)).length()),
      rounding(1e-5, 1e-8));
}

// Readings of an axis are those of a step in which nothing acts.
TEST(Overflow, LeavesNoImpulseOfAMotor) {
  Books books(60);
  btRigidBody& heavy = books.add(1000, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
  btRigidBody& tiny = books.add(1, vec(0.001, 0.001, 0.001), vec(0, 0, 1));
  heavy.setAngularFactor(vec(0, 0, 0));
  const btVector3 y = vec(0, 1, 0);
  auto made = std::make_unique<pintle::QuaternionHinge>(heavy, tiny, vec(0, 0, 1.001),
                                                        vec(0, 0, 0.001), y, y);
  made->enableAngularMotor(true, 1, scalar(1e-3));
  pintle::QuaternionHinge& hinge = *made;
  books.join(std::move(made));
  books.step();
  EXPECT_NE(hinge.getMotorImpulse(), 0);
  heavy.setLinearVelocity(btVector3(largest / 50, 0, 0));  // whose force is beyond
  books.step();
  EXPECT_EQ(books.solver.lastStep().overflowed, 1);
  EXPECT_EQ(hinge.getMotorImpulse(), 0);
  EXPECT_EQ(hinge.getAppliedImpulse(), 0);
}

// The rows of a multibody see no number that is not finite: an arm that holds the tiny body turns on.
TEST(Overflow, LeavesMultiBodiesFinite) {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  pintle::ExactMultiBodyJointSolver solver;
  btMultiBodyDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  support::Bodies bodies(world);
  Takes takes(bodies, vec(0, 0, 0));
  btMultiBody arm(1, 0, vec(0, 0, 0), true, false);
  arm.setupRevolute(0, 1, vec(0.1, 0.1, 0.1), -1, btQuaternion::getIdentity(), vec(0, 1, 0),
                    vec(0, 0, 0), vec(0.5, 0, 0), true);
  arm.setBasePos(vec(-1, 0, 1));
  arm.finalizeMultiDof();
  arm.setCanSleep(false);
  world.addMultiBody(&arm);
  btMultiBodyPoint2Point holds(&arm, 0, &takes.tiny, vec(0.5, 0, 0), vec(0, 0, 0));
  world.addMultiBodyConstraint(&holds);
  takes.fly();
  world.stepSimulation(scalar(dt), 0, scalar(dt));
  EXPECT_TRUE(std::isfinite(arm.getJointVel(0)));
  EXPECT_TRUE(std::isfinite(arm.getJointPos(0)));
  EXPECT_TRUE(support::is_finite(takes.heavy));
  EXPECT_TRUE(support::is_finite(takes.tiny));
  EXPECT_EQ(solver.lastStep().overflowed, 1);
  expectNothingActs(*takes.joint);
  world.removeMultiBodyConstraint(&holds);
  world.removeMultiBody(&arm);
}

}  // namespace
}  // namespace exact_overflow_test
