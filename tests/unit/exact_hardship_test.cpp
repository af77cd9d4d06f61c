// What ExactJointSolver can bear: joints that repeat or contradict each other, what is no number, strokes, violent motion, planes.
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/distance_joint.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/two_point_hinge.h>
#include <pintle/solver/exact_joint_solver.h>

#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <gtest/gtest.h>
#include <scenes/angles.h>
#include <scenes/world.h>

#include "exact_support.h"
#include "support.h"

namespace exact_hardship_test {
namespace {

using pintle::BallJoint;
using pintle::DistanceJoint;
using pintle::FixedJoint;
using pintle::QuaternionHinge;
using scenes::World;
using support::Random;
using support::scalar;
using support::vec;
using namespace exact_support;

TEST(ExactJointSolver, JointsOfStaticBodiesAreHarmless) {
  World world(9.81, 10, exact);
  btRigidBody& a = world.add_box(0, vec(0.1, 0.1, 0.1), at(0, 0, 0));
  btRigidBody& b = world.add_box(0, vec(0.1, 0.1, 0.1), at(0, 0, -1));
  btRigidBody& c = world.add_box(1, vec(0.1, 0.1, 0.1), at(0, 0, -2));
  world.add_joint<BallJoint>(a, b, vec(0, 0, -0.5), vec(0, 0, 0.5));
  world.add_joint<btFixedConstraint>(a, b, at(0, 0, -0.5), at(0, 0, 0.5));
  world.add_joint<BallJoint>(b, c, vec(0, 0, -0.5), vec(0, 0, 0.5));
  for (int i = 0; i < 60; ++i) world.step(1. / 60);
  EXPECT_NEAR(double(c.getCenterOfMassPosition().z()), -2, 1e-5);
}

// A hinge starts apart, and the factors of its body keep it from closing. Poses go where they may, and no further from step to step: in the
// end a body of 1 m is about where it was.
TEST(ExactJointSolver, WhatFactorsKeepApartDoesNotRunAway) {
  Random random(11);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    World world(9.81, 10, exact);
    const btVector3 x = random.vector(0.1);
    btRigidBody& body =
        world.add_box(1, vec(0.5, 0.1, 0.1), at(x, btQuaternion(random.unit(), scalar(0.5))));
    const auto factor = [&] { return random.uniform(0, 1) < 0.5 ? 0 : 1; };
    const auto factors = [&] {
      const int along_x = factor(), along_y = factor();
      return vec(along_x, along_y, factor());
    };
    body.setLinearFactor(factors());
    body.setAngularFactor(factors());
    body.setLinearVelocity(random.vector(3) * body.getLinearFactor());
    body.setAngularVelocity(random.vector(5) * body.getAngularFactor());
    auto& hinge = world.add_joint<QuaternionHinge>(body, at(-0.5, 0, 0));
    const auto gap = [&] {
      return double((body.getCenterOfMassTransform() * hinge.getFrameOffsetA().getOrigin() -
                     hinge.getFrameOffsetB().getOrigin())
                        .length());
    };
    const double start = gap();
    for (int i = 0; i < 120; ++i) world.step(1. / 60);
    EXPECT_LT(gap(), start + 1);
  }
}

TEST(ExactJointSolver, NanStaysWhereItIs) {
  World world(9.81, 10, exact);
  std::vector<btRigidBody*> links;
  for (int i = 0; i < 5; ++i) {
    links.push_back(&world.add_box(1, vec(0.5, 0.1, 0.1), at(i + 0.5, 0, 0)));
    if (i == 0)
      world.add_joint<BallJoint>(*links[0], vec(-0.5, 0, 0));
    else
      world.add_joint<btPoint2PointConstraint>(*links[size_t(i) - 1], *links[size_t(i)],
                                               vec(0.5, 0, 0), vec(-0.5, 0, 0));
  }
  world.step(1. / 60);
  links[4]->setLinearVelocity(btVector3(support::nan_value, 0, 0));
  for (int i = 0; i < 10; ++i) world.step(1. / 60);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(support::is_finite(*links[size_t(i)])) << i;
}

// Four joints where one would do.
TEST(ExactJointSolver, JointsThatSayTheSameShareTheLoad) {
  World world(9.81, 10, exact);
  btRigidBody& body = world.add_box(2, vec(0.5, 0.1, 0.1), at(0.5, 0, 0));
  constexpr int count = 4;
  btJointFeedback feedback[count];
  for (btJointFeedback& of : feedback) {
    auto& joint = world.add_joint<FixedJoint>(body, at(-0.5, 0, 0));
    joint.setJointFeedback(&of);
    joint.enableFeedback(true);
  }
  for (int i = 0; i < 60; ++i) world.step(1. / 60);
  for (const btJointFeedback& of : feedback) {
    EXPECT_NEAR(double(of.m_appliedForceBodyA.z()), 2 * 9.81 / count, 1e-3);
    EXPECT_NEAR(double(of.m_appliedTorqueBodyA.length()), 0, 1e-3) << "about the centre, at rest";
  }
  EXPECT_NEAR(double(body.getCenterOfMassPosition().z()), 0, 1e-5);
}

// Two points of a hinge's axis, three rows each: where they hold one of them says nothing new, and off it next to
// nothing. Held exactly that would turn the bodies by up to 1e9 rad/s.
TEST(ExactJointSolver, AJointThatSaysNearlyTheSameTwiceThrowsNobody) {
  for (const double degrees : {60., 90., 120., 150.}) {
    for (const btVector3& axis : {vec(1, 0, 0), vec(0, 1, 0), vec(0.6, 0.8, 0)}) {
      World world(0, 10, exact);
      btTransform pose(btQuaternion(axis, btScalar(scenes::radians(degrees))));
      pose.setOrigin(vec(0.5, 0, 0) + pose * vec(0.5, 0, 0));
      btRigidBody& a = world.add_box(1, vec(0.5, 0.1, 0.1), at(0, 0, 0));
      btRigidBody& b = world.add_box(1, vec(0.5, 0.1, 0.1), pose);
      world.add_joint<pintle::TwoPointHinge>(a, b, at(0.5, 0, 0), at(-0.5, 0, 0)).setSixRows(true);
      a.setAngularVelocity(vec(0.3, -0.2, 1));
      for (int i = 0; i < 300; ++i) {
        world.step(1. / 60);
        ASSERT_LT(a.getAngularVelocity().length(), 20) << degrees << ' ' << axis.x();
        ASSERT_LT(b.getAngularVelocity().length(), 20) << degrees << ' ' << axis.x();
      }
    }
  }
}

// A planar loop of hinges has three rows too many.
TEST(ExactJointSolver, LoopsHold) {
  World world(0, 10, exact);
  std::vector<btRigidBody*> links;
  constexpr int count = 12;
  const double side = 2 * std::tan(scenes::pi / count);
  const auto corner = [&](int i) {
    const double angle = 2 * scenes::pi * i / count, radius = std::hypot(1, side / 2);
    return Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), 0);
  };
  const Eigen::Vector3d z(0, 0, 1);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d a = corner(i), b = corner(i + 1), x = (b - a).normalized();
    links.push_back(
        &world.add_box(1, vec(side / 2, 0.1, 0.1), scenes::frame_along((a + b) / 2, x, z)));
  }
  for (int i = 0; i < count; ++i) {
    const btTransform frame = scenes::frame_along(corner(i + 1), Eigen::Vector3d(1, 0, 0), z);
    world.join<QuaternionHinge>(*links[size_t(i)], *links[size_t((i + 1) % count)], frame);
  }
  // It collapses and spins.
  links[0]->setLinearVelocity(vec(0, 3, 0));
  links[6]->setLinearVelocity(vec(-1, -3, 0));
  double energy = 0;
  for (const btRigidBody* link : links) energy += scenes::energy(*link, 0);
  double gap = 0;
  for (int step = 0; step < 600; ++step) {
    world.step(1. / 120);
    for (int i = 0; i < count; ++i) {
      const btTransform& a = links[size_t(i)]->getCenterOfMassTransform();
      const btTransform& b = links[size_t((i + 1) % count)]->getCenterOfMassTransform();
      gap = std::max(gap, double((a(vec(side / 2, 0, 0)) - b(vec(-side / 2, 0, 0))).length()));
    }
  }
  double end = 0;
  for (const btRigidBody* link : links) end += scenes::energy(*link, 0);
  EXPECT_LT(gap, 1e-3);
  EXPECT_LT(end, 1.01 * energy);
  EXPECT_GT(end, 0.1 * energy);
}

// A body without joints strikes one link of a chain: the others, which nothing touches, take their part,
// and it keeps what the contact gave it.
TEST(ExactJointSolver, AStrokeIsSharedByTheWholeChain) {
  World world(0, 10, exact);
  std::vector<btRigidBody*> bodies;
  constexpr int links = 9;
  for (int i = 0; i < links; ++i) {
    bodies.push_back(&world.add_box(1, vec(0.45, 0.1, 0.1), at(i, 0, 0), true));
    if (i > 0)
      world.add_joint<BallJoint>(*bodies[size_t(i) - 1], *bodies[size_t(i)], vec(0.5, 0, 0),
                                 vec(-0.5, 0, 0));
  }
  bodies.push_back(&world.add_box(5, vec(0.2, 0.2, 0.2), at(links / 2, 0, 0.5), true));
  bodies.back()->setLinearVelocity(vec(0, 0, -5));
  const auto momentum = [&] {
    Eigen::Vector3d sum(0, 0, 0);
    for (const btRigidBody* body : bodies)
      sum += scenes::to_eigen(body->getLinearVelocity()) / double(body->getInvMass());
    return sum;
  };
  const Eigen::Vector3d before = momentum();
  for (int step = 0; step < 30; ++step) {
    world.step(1. / 60);
    ASSERT_LT((momentum() - before).norm(), support::is_double ? 1e-10 : 1e-3) << step;
    for (int i = 1; i < links; ++i)
      ASSERT_LT((scenes::point_in_world(*bodies[size_t(i) - 1], {0.5, 0, 0}) -
                 scenes::point_in_world(*bodies[size_t(i)], {-0.5, 0, 0}))
                    .norm(),
                1e-2)
          << step;
  }
  EXPECT_GT(bodies.back()->getLinearVelocity().z(), -4.5) << "it has struck";
  EXPECT_NE(bodies.front()->getLinearVelocity().z(), 0) << "what it does not touch moves";
}

TEST(ExactJointSolver, ViolentMotionStaysBounded) {
  Random random(7);
  for (const double speed : {10., 100., 1000., 10000.}) {
    World world(9.81, 10, exact);
    std::vector<btRigidBody*> links;
    double energy = 0;
    for (int i = 0; i < 8; ++i) {
      links.push_back(&world.add_box(i % 3 == 0 ? 20 : 1, vec(0.5, 0.1, 0.1), at(i + 0.5, 0, 0)));
      if (i > 0)
        world.add_joint<BallJoint>(*links[size_t(i) - 1], *links[size_t(i)], vec(0.5, 0, 0),
                                   vec(-0.5, 0, 0));
      links.back()->setAngularVelocity(random.vector(speed));
      links.back()->setLinearVelocity(random.vector(speed / 10));
      energy += scenes::energy(*links.back(), 0);
    }
    for (int step = 0; step < 300; ++step) {
      world.step(1. / 60);
      double kinetic = 0;
      for (const btRigidBody* link : links) {
        ASSERT_TRUE(support::is_finite(*link)) << speed << ", step " << step;
        kinetic += scenes::energy(*link, 0);
      }
      // What they fall adds to it.
      const double fall = 9.81 * (step + 1) / 60, mass = 3 * 20 + 5;
      ASSERT_LT(kinetic, 2 * (energy + mass * fall * fall / 2)) << speed << ", step " << step;
    }
  }
}

// A pair that whirls further in a step than Bullet turns bodies, as it flies. It may lose speed, and flies on.
TEST(ExactJointSolver, WhatTurnsTooFarToBeHeldIsSlowedDown) {
  for (const double speed : {40., 100., 1000.}) {
    World world(0, 10, exact);
    btRigidBody* bodies[2];
    for (int i = 0; i < 2; ++i) {
      bodies[i] = &world.add_box(1 + 2 * i, vec(0.5, 0.1, 0.1), at(i, 0, 0));
      bodies[i]->setAngularVelocity(vec(0, i == 0 ? speed : -0.3 * speed, 0.2 * speed));
      bodies[i]->setLinearVelocity(vec(3, 4, 12));
    }
    auto& joint =
        world.add_joint<BallJoint>(*bodies[0], *bodies[1], vec(0.5, 0, 0), vec(-0.5, 0, 0));
    const auto momentum = [&]() -> Eigen::Vector3d {
      return scenes::to_eigen(bodies[0]->getLinearVelocity()) +
             3 * scenes::to_eigen(bodies[1]->getLinearVelocity());
    };
    const Eigen::Vector3d start = momentum();
    for (int i = 0; i < 180; ++i) {
      const double before = scenes::energy(*bodies[0], 0) + scenes::energy(*bodies[1], 0);
      world.step(1. / 60);
      ASSERT_LT(scenes::energy(*bodies[0], 0) + scenes::energy(*bodies[1], 0), 1.2 * before)
          << speed << ' ' << i;
      ASSERT_LT((momentum() - start).norm(), (support::is_double ? 1e-9 : 1e-3) * start.norm())
          << speed << ' ' << i;
      if (i < 60) continue;
      const btVector3 a = bodies[0]->getCenterOfMassTransform()(joint.getPivotInA()),
                      b = bodies[1]->getCenterOfMassTransform()(joint.getPivotInB());
      ASSERT_LT(double((b - a).length()), 1e-3) << speed << ' ' << i;
    }
  }
}

// What a plane forbids a joint must not ask of what is left: two boxes in a plane, on joints that are
// askew to it.
TEST(ExactJointSolver, GamesInTwoDimensionsAreNotThrownByWhatThePlaneForbids) {
  World world(0, 10, exact);
  btRigidBody* bodies[2];
  for (int i = 0; i < 2; ++i) {
    bodies[i] = &world.add_box(1, vec(0.5, 0.1, 0.1), at(i, 0, 0));
    bodies[i]->setLinearFactor(vec(1, 1, 0));
    bodies[i]->setAngularFactor(vec(0, 0, 1));
  }
  // A cone whose axis is across the plane, but for rounding, and far outside of it and of its twist.
  const btQuaternion across(vec(0, 1, 0), SIMD_HALF_PI);
  const btVector3 off = vec(0.4, 0.9, 0.7);
  auto& joint = world.add_joint<pintle::ConeTwistJoint>(
      *bodies[0], *bodies[1], btTransform(across, vec(0.5, 0, 0)),
      btTransform(across, vec(-0.5, 0, 0.01)) *
          btTransform(btQuaternion(off.normalized(), off.length()).inverse()));
  joint.setLimit(1, scalar(1.5), scalar(0.3), scalar(0.8));
  for (int i = 0; i < 60; ++i) {
    world.step(1. / 60);
    for (const btRigidBody* body : bodies)
      EXPECT_LT(double(body->getAngularVelocity().length()), 8) << i;
  }
}

// A rod that is a centimetre too long stands on a rail, upright but for 3e-8 rad: less than poses are held to. Along that the cart could
// close it, if it went far enough.
TEST(ExactJointSolver, NothingGoesFarAlongWhatItsFactorsAllButForbid) {
  World world(0, 10, exact);
  btRigidBody &post = world.add_box(0, vec(0.1, 0.1, 0.1), at(0, 0, 0)),
              &cart = world.add_box(1, vec(0.1, 0.1, 0.1), at(3e-8, 0, 1));
  cart.setLinearFactor(vec(1, 0, 0));
  cart.setAngularFactor(vec(0, 0, 0));
  world.add_joint<DistanceJoint>(post, cart, vec(0, 0, 0), vec(0, 0, 0), scalar(0.99));
  for (int i = 0; i < 60; ++i) {
    world.step(1. / 60);
    EXPECT_LT(std::abs(double(cart.getCenterOfMassPosition().x())), 1e-6) << i;
  }
}

}  // namespace
}  // namespace exact_hardship_test
