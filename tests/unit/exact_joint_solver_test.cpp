// What ExactJointSolver promises beside its figures (exact_scenes_test.cpp): it takes Bullet's place in
// all that a world, a joint and a body can see of a solver.
#include <pintle/joints/angular_limit.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/distance_joint.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/two_point_hinge.h>
#include <pintle/body_pair.h>
#include <pintle/rows/row.h>
#include <pintle/solver/exact_joint_solver.h>

#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorldMt.h>
#include <gtest/gtest.h>
#include <scenes/angles.h>
#include <scenes/world.h>

#include <cstdlib>
#include <cstring>
#include <new>

#include "joint_kinds.h"
#include "support.h"

namespace {
long allocations = 0;
}

[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace {

using pintle::BallJoint;
using pintle::DistanceJoint;
using pintle::ExactJointSolver;
using pintle::FixedJoint;
using pintle::QuaternionHinge;
using scenes::World;
using support::Random;
using support::scalar;
using support::vec;

std::unique_ptr<btConstraintSolver> exact() { return std::make_unique<ExactJointSolver>(); }

btTransform at(double x, double y, double z) { return scenes::pose_at(vec(x, y, z)); }

void addFloor(World& world) { world.add_box(0, vec(50, 50, 1), at(0, 0, -1), true); }

// --- what Bullet's solver does, too ----------------------------------------------------------------

TEST(ExactJointSolver, WithoutJointsIsBullet) {
  const auto run = [](const scenes::SolverFactory& make_solver) {
    World world(9.81, 10, make_solver);
    addFloor(world);
    std::vector<btRigidBody*> boxes;
    for (int i = 0; i < 10; ++i)
      boxes.push_back(
          &world.add_box(1, vec(0.5, 0.5, 0.5), at(0.02 * i, 0, 0.55 + 1.01 * i), true));
    for (int i = 0; i < 200; ++i) world.step(1. / 60);
    std::vector<btScalar> numbers;
    for (const btRigidBody* box : boxes) {
      for (int k = 0; k < 3; ++k) {
        numbers.push_back(box->getCenterOfMassPosition()[k]);
        numbers.push_back(box->getLinearVelocity()[k]);
        for (int j = 0; j < 3; ++j)
          numbers.push_back(box->getCenterOfMassTransform().getBasis()[k][j]);
      }
    }
    return numbers;
  };
  EXPECT_EQ(run({}), run(exact));
}

// A weight hangs on a static body by two joints in line, at rest: what the upper bears is known.
struct Hanging {
  explicit Hanging(const scenes::SolverFactory& make_solver) : world(9.81, 10, make_solver) {
    top = &world.add_box(0, vec(0.1, 0.1, 0.1), at(0, 0, 0));
    upper = &world.add_box(2, vec(0.1, 0.1, 0.1), at(0, 0, -1));
    lower = &world.add_box(3, vec(0.1, 0.1, 0.1), at(0, 0, -2));
  }
  World world;
  btRigidBody *top, *upper, *lower;
};

TEST(ExactJointSolver, FeedbackIsTheLoadOfTheJoint) {
  Hanging hanging(exact);
  auto& a = hanging.world.add_joint<BallJoint>(*hanging.top, *hanging.upper, vec(0, 0, -0.5),
                                               vec(0, 0, 0.5));
  auto& b = hanging.world.add_joint<btPoint2PointConstraint>(*hanging.upper, *hanging.lower,
                                                             vec(0, 0, -0.5), vec(0, 0, 0.5));
  btJointFeedback of_a, of_b;
  a.setJointFeedback(&of_a);
  b.setJointFeedback(&of_b);
  a.enableFeedback(true);
  b.enableFeedback(true);
  for (int i = 0; i < 60; ++i) hanging.world.step(1. / 60);
  const double tolerance = support::is_double ? 1e-9 : 1e-3;
  EXPECT_NEAR(double(of_a.m_appliedForceBodyA.z()), -5 * 9.81, tolerance);
  EXPECT_NEAR(double(of_a.m_appliedForceBodyB.z()), 5 * 9.81, tolerance);
  EXPECT_NEAR(double(of_b.m_appliedForceBodyA.z()), -3 * 9.81, tolerance);
  EXPECT_NEAR(double(of_b.m_appliedForceBodyB.z()), 3 * 9.81, tolerance);
  // The last row's impulse: that along z.
  EXPECT_NEAR(std::abs(double(b.getAppliedImpulse())), 3 * 9.81 / 60, tolerance);
}

TEST(ExactJointSolver, JointsBreakAtTheirThreshold) {
  for (const double part : {0.9, 1.1}) {
    Hanging hanging(exact);
    auto& a = hanging.world.add_joint<BallJoint>(*hanging.top, *hanging.upper, vec(0, 0, -0.5),
                                                 vec(0, 0, 0.5));
    hanging.world.add_joint<BallJoint>(*hanging.upper, *hanging.lower, vec(0, 0, -0.5),
                                       vec(0, 0, 0.5));
    a.setBreakingImpulseThreshold(scalar(part * 5 * 9.81 / 60));
    for (int i = 0; i < 60; ++i) hanging.world.step(1. / 60);
    EXPECT_EQ(a.isEnabled(), part > 1) << part;
    EXPECT_EQ(hanging.upper->getCenterOfMassPosition().z() > -2, part > 1) << part;
  }
}

// What a motor would need to reach its speed at once is not a load: it has no more than its largest impulse, and what bears
// it is not to break by more.
TEST(ExactJointSolver, JointsBreakByLoadsWithinTheBoundsOfOthers) {
  const double most = 0.05, speed = 1000;  // N m s, rad/s
  for (const double part : {0.9, 1.1}) {
    World world(0, 10, exact);
    btRigidBody& frame = world.add_box(0, vec(0.1, 0.1, 0.1), at(0, 0, 0));
    btRigidBody& bearing = world.add_box(1, vec(0.1, 0.1, 0.1), at(0, 0, 0));
    btRigidBody& wheel = world.add_box(1, vec(0.1, 0.1, 0.1), at(0, 0, 0));
    auto& holds = world.add_joint<FixedJoint>(frame, bearing, at(0, 0, 0), at(0, 0, 0));
    holds.setBreakingImpulseThreshold(scalar(part * most));
    auto& hinge = world.add_joint<QuaternionHinge>(bearing, wheel, at(0, 0, 0), at(0, 0, 0));
    hinge.enableAngularMotor(true, scalar(speed), scalar(most));
    for (int i = 0; i < 10; ++i) world.step(1. / 60);
    EXPECT_EQ(holds.isEnabled(), part > 1) << part;
    EXPECT_GT(speed / double(wheel.getInvInertiaDiagLocal().z()), 10 * most)
        << "or it asks nothing";
  }
}

TEST(ExactJointSolver, IslandsFallAsleep) {
  Hanging hanging(exact);
  hanging.world.add_joint<BallJoint>(*hanging.top, *hanging.upper, vec(0, 0, -0.5), vec(0, 0, 0.5));
  hanging.world.add_joint<BallJoint>(*hanging.upper, *hanging.lower, vec(0, 0, -0.5),
                                     vec(0, 0, 0.5));
  hanging.upper->forceActivationState(ACTIVE_TAG);
  hanging.lower->forceActivationState(ACTIVE_TAG);
  for (int i = 0; i < 240; ++i) hanging.world.step(1. / 60);
  EXPECT_EQ(hanging.lower->getActivationState(), ISLAND_SLEEPING);
}

TEST(ExactJointSolver, SplitImpulseIsInTheEndOfTheStep) {
  // Two boxes that start within the ground, and are pushed out of it unequally.
  World world(9.81, 10, exact);
  addFloor(world);
  btRigidBody& a = world.add_box(1, vec(0.5, 0.5, 0.5), at(0, 0, 0.3), true);
  btRigidBody& b = world.add_box(1, vec(0.5, 0.5, 0.5), at(1.2, 0, 0.45), true);
  world.join<FixedJoint>(a, b, at(0.6, 0, 0.4));
  for (int i = 0; i < 30; ++i) {
    world.step(1. / 60);
    EXPECT_LT(
        (scenes::point_in_world(a, {0.6, 0, 0.1}) - scenes::point_in_world(b, {-0.6, 0, -0.05}))
            .norm(),
        1e-3)
        << i;
  }
}

// --- what it can bear ------------------------------------------------------------------------------

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

// --- rows with bounds --------------------------------------------------------------------------------

// A motor turns an arm that has ten times its mass fixed to its end.
struct Driven {
  Driven(double torque, double gravity) : world(gravity, 4, exact) {
    arm = &world.add_box(1, vec(0.5, 0.1, 0.1), at(0.5, 0, 0));
    btRigidBody& end = world.add_box(10, vec(0.1, 0.1, 0.1), at(1.1, 0, 0));
    hinge = &world.add_joint<QuaternionHinge>(*arm, vec(-0.5, 0, 0), vec(0, 1, 0));
    world.add_joint<FixedJoint>(*arm, end, at(0.5, 0, 0), at(-0.1, 0, 0));
    hinge->enableAngularMotor(true, scalar(speed), scalar(torque / 60));
    hinge->enableFeedback(true);
    // About the hinge: the boxes' own, and what they have off it.
    inertia = 1.04 / 12 + 0.25 + 10 * (0.08 / 12 + 1.1 * 1.1);
  }
  double turned() {
    const Eigen::Vector3d x = scenes::direction_in_world(*arm, {1, 0, 0});
    return std::abs(unwrap(std::atan2(x.z(), x.x())));
  }
  static constexpr double speed = 2;  // rad/s
  World world;
  btRigidBody* arm;
  QuaternionHinge* hinge;
  double inertia;
  scenes::Unwrap unwrap{0};
};

// In every step, whatever the load, the gravity and the end of the step ask of the joints.
TEST(ExactJointSolver, AStrongMotorTurnsByItsSpeed) {
  Driven driven(1e6, 9.81);
  for (int i = 1; i <= 300; ++i) {
    driven.world.step(1. / 60);
    ASSERT_NEAR(driven.turned(), Driven::speed * i / 60, 1e-4) << i;
  }
}

// Neither more nor less: it is at its bound in the first steps, and within it when the speed is reached.
TEST(ExactJointSolver, AWeakMotorGivesItsTorque) {
  const double torque = 10;
  Driven driven(torque, 0);
  const int steps = int(Driven::speed * driven.inertia / torque * 60);
  for (int i = 1; i <= 2 * steps; ++i) {
    driven.world.step(1. / 60);
    const double speed = std::abs(double(driven.arm->getAngularVelocity().y()));
    const double of = std::min(torque * i / 60 / driven.inertia, Driven::speed);
    ASSERT_NEAR(speed, of, 1e-3) << i;
    const double impulse = std::abs(double(driven.hinge->getAppliedImpulse()));
    ASSERT_NEAR(impulse, i < steps ? torque / 60 : std::min(impulse, torque / 60), 1e-6) << i;
  }
}

// Its bounds then take all rows of the AngularLimit out of the system. (A step turns by a sixth of a rad, and its chord is
// short by half a percent: the closed form is that of short steps.)
TEST(ExactJointSolver, AMotorAtItsBoundBesideAHingeThatSpinsGivesItsImpulse) {
  constexpr double radius = 0.5, speed = 10, impulse = 0.02;
  World world(0, 10, exact);
  btRigidBody& post = world.add_box(0, vec(0.1, 0.1, 0.1), at(0, 0, 0));
  btRigidBody& arm = world.add_box(1, vec(radius, 0.05, 0.05), at(radius, 0, 0));
  world.add_joint<QuaternionHinge>(post, arm, at(0, 0, 0), at(-radius, 0, 0));
  auto& motor = world.add_joint<pintle::AngularLimit>(post, arm, at(0, 0, 0), at(-radius, 0, 0));
  motor.enableAngularMotor(true, -100, scalar(impulse));
  arm.setAngularVelocity(vec(0, 0, speed));
  arm.setLinearVelocity(vec(0, radius * speed, 0));
  const double inertia = 1 / double(arm.getInvInertiaTensorWorld()[2][2]) + radius * radius;
  // It starts on the tangent, and goes on along chords: the first two steps take what lies between.
  double start = speed;
  for (int i = 1; i <= 60; ++i) {
    world.step(1. / 60);
    ASSERT_NEAR(double(motor.getMotorImpulse()), -impulse, 1e-6) << i;
    ASSERT_LT(double((arm.getCenterOfMassTransform() * vec(-radius, 0, 0)).length()), 1e-5) << i;
    const double now = double(arm.getAngularVelocity().z()),
                 expected = start - i * impulse / inertia;
    if (i == 2) {
      start += now - expected;
      ASSERT_NEAR(now, expected, 0.035 * expected);
    }
    if (i > 2) {
      ASSERT_NEAR(now, expected, 0.01 * expected) << i;
    }
  }
}

// --- softness --------------------------------------------------------------------------------------

// lambda of one step against a row of any softness: K (1 + cfm) lambda = -v, with K = 1 / m.
TEST(ExactJointSolver, SoftRowsAreExact) {
  for (const double cfm : {0., 0.5, 2., 100.}) {
    World world(0, 10, exact);
    btRigidBody& body = world.add_box(2, vec(0.1, 0.1, 0.1), at(0, 0, 0));
    auto& joint = world.add_joint<BallJoint>(body, vec(0, 0, 0));
    joint.setParam(BT_CONSTRAINT_CFM, scalar(cfm));
    body.setLinearVelocity(vec(1, 2, 3));
    world.step(1. / 60);
    const double left = cfm / (1 + cfm);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(double(body.getLinearVelocity()[k]), left * (k + 1), 1e-6) << cfm;
  }
}

// --- momentum and energy -----------------------------------------------------------------------------

// Two rods on a hinge at their ends that fly at each other, with limits on both sides.
struct ThrownPair {
  World world{0, 10, exact};
  btRigidBody& a = world.add_box(2, vec(0.2, 0.1, 0.05), at(0.3, 0, 0));
  btRigidBody& b = world.add_box(2, vec(0.2, 0.1, 0.05), at(0, -0.3, 0));
  QuaternionHinge& hinge =
      world.add_joint<QuaternionHinge>(a, b, at(-0.3, 0, 0), at(0, 0.3, 0), false);

  explicit ThrownPair(double speed) {
    for (btRigidBody* body : {&a, &b}) {
      const btVector3 w(0, 0, scalar(body == &a ? speed : -speed));
      body->setAngularVelocity(w);
      body->setLinearVelocity(w.cross(body->getCenterOfMassPosition()));
    }
  }
  double spin(const btRigidBody& body) const {
    return double(body.getAngularVelocity().z() / body.getInvInertiaTensorWorld()[2][2] +
                  body.getCenterOfMassPosition().cross(body.getLinearVelocity()).z() /
                      body.getInvMass());
  }
};

TEST(ExactJointSolver, AFreePairThatHitsItsLimitsKeepsItsAngularMomentum) {
  for (const double speed : {10., 30., 60.}) {
    ThrownPair pair(speed);
    pair.hinge.setLimit(scalar(-1.5), scalar(1.5), scalar(0.9), scalar(0.3), 1);
    const double one = std::abs(pair.spin(pair.a));
    double worst = 0;
    for (int i = 0; i < 120; ++i) {
      pair.world.step(1. / 60);
      worst = std::max(worst, std::abs(pair.spin(pair.a) + pair.spin(pair.b)));
    }
    EXPECT_LT(worst, 0.02 * one) << speed;
  }
}

// For a minute, at up to a radian a step against each other.
TEST(ExactJointSolver, AFreePairThatSpinsGainsNoEnergy) {
  for (const double speed : {5., 10., 20., 30.}) {
    ThrownPair pair(speed);
    const auto energy = [&] { return scenes::energy(pair.a, 0) + scenes::energy(pair.b, 0); };
    const double start = energy();
    double least = HUGE_VAL, most = 0, top = 0;
    for (int i = 0; i < 3600; ++i) {
      pair.world.step(1. / 60);
      least = std::min(least, energy() / start);
      most = std::max(most, energy() / start);
      top = std::max(
          top, std::abs(double(pair.a.getAngularVelocity().z() - pair.b.getAngularVelocity().z())));
    }
    // The chord's speed differs from the circle's by half of the turn of a step, squared.
    const double chord = std::pow(top / 60 / 2, 2);
    EXPECT_LT(most, 1 + chord) << speed;
    // Beyond that an end that would feed the spin is done without, which takes from it: in the first seconds, down
    // to where half a radian a step is left.
    EXPECT_GT(least, speed <= 10 ? 1 - chord : speed <= 20 ? 0.5 : 0.4) << speed;
  }
}

// A boom of two arms lies on the limits of its hinges, and its foot on the ground. What is iterated begins with what
// it had in the last step: so few iterations bear it.
template <class Hinge>
struct Boom {
  explicit Boom(const scenes::SolverFactory& make_solver) : world(9.81, 4, make_solver) {
    addFloor(world);
    btRigidBody* const bodies[] = {&world.add_box(50, vec(1, 1, 1), at(0, 0, 1), true),
                                   &world.add_box(1, vec(0.5, 0.1, 0.1), at(1.5, 0, 1.9), true),
                                   &world.add_box(1, vec(0.5, 0.1, 0.1), at(2.5, 0, 1.9), true)};
    for (int i = 0; i < 2; ++i) {
      btTransform frame = at(1 + i, 0, 1.9);
      frame.setRotation(
          btQuaternion(vec(1, 0, 0), scalar(-scenes::pi / 2)));  // z along the world's y
      hinges[i] = &world.join<Hinge>(*bodies[i], *bodies[i + 1], frame);
      hinges[i]->setLimit(scalar(-0.1), scalar(0.1));
    }
  }
  /// The furthest that they are beyond their limits in a second from now, rad.
  double furthest() {
    double most = 0;
    for (int step = 0; step < 60; ++step) {
      world.step(1. / 60);
      for (Hinge* hinge : hinges)
        most = std::max(most, std::abs(double(hinge->getHingeAngle())) - 0.1);
    }
    return most;
  }
  World world;
  Hinge* hinges[2];
};

TEST(ExactJointSolver, AmongContactsLimitsAreBorneOverTheSteps) {
  Boom<QuaternionHinge> boom(exact);
  for (int step = 0; step < 240; ++step) boom.world.step(1. / 60);
  EXPECT_LT(boom.furthest(), 1e-4);
}

TEST(ExactJointSolver, AmongContactsLimitsOfBulletsHingesAreBorneOverTheSteps) {
  Boom<btHingeConstraint> boom(exact), stock({});
  for (Boom<btHingeConstraint>* each : {&boom, &stock})
    for (int step = 0; step < 240; ++step) each->world.step(1. / 60);
  // In each of them: a limit that closes has no row of Bullet's in the next step. In single precision, what contacts leave may close
  // one once in a minute: then it falls for a step.
  for (int second = 0; second < 60; ++second)
    EXPECT_LT(boom.furthest(), stock.furthest() / (support::is_double ? 100 : 20)) << second;
}

// Of seven rows and more.
TEST(ExactJointSolver, AMotorAboutThreeAxesPressesOnALimit) {
  World world(0, 10, exact);
  btRigidBody& frame = world.add_box(0, vec(0.2, 0.3, 0.25), at(0, 0, 0));
  btRigidBody& limb = world.add_box(1, vec(0.3, 0.06, 0.08), at(0, 0, 0));
  auto& joint = world.add_joint<pintle::ConeTwistJoint>(limb, frame, at(0, 0, 0), at(0, 0, 0));
  joint.enableMotor(true);
  const btVector3 target = vec(0.5, 0.3, 0.2);
  joint.setMotorTargetInConstraintSpace(btQuaternion(target.normalized(), target.length()));
  for (int i = 0; i < 120; ++i) world.step(1. / 60);
  EXPECT_GT(double(joint.getTwist()), 0.505);
  joint.setLimit(1, 1, scalar(0.5));
  joint.setMotorVelocity(vec(3, 0, 0));
  joint.setMaxMotorImpulse(scalar(0.1));
  for (int i = 0; i < 120; ++i) world.step(1. / 60);
  EXPECT_NEAR(double(joint.getTwist()), 0.5, 1e-3);
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

// --- repeatability ---------------------------------------------------------------------------------

TEST(ExactJointSolver, InAPoolOfSolvers) {
  const auto run = [](bool pool) {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    ExactJointSolver alone;
    btConstraintSolver* solvers[] = {new ExactJointSolver, new ExactJointSolver};  // the pool's own
    btConstraintSolverPoolMt solver_pool(solvers, 2);
    btConstraintSolver* solver = pool ? static_cast<btConstraintSolver*>(&solver_pool) : &alone;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, solver, &configuration);
    btBoxShape shape(vec(0.5, 0.1, 0.1));
    btVector3 inertia;
    shape.calculateLocalInertia(1, inertia);
    std::vector<std::unique_ptr<btRigidBody>> bodies;
    std::vector<std::unique_ptr<btTypedConstraint>> joints;
    for (int chain = 0; chain < 3; ++chain) {
      for (int i = 0; i < 4 + chain; ++i) {
        btRigidBody::btRigidBodyConstructionInfo info(1, nullptr, &shape, inertia);
        info.m_startWorldTransform = at(i + 0.5, 5 * chain, 0);
        bodies.push_back(std::make_unique<btRigidBody>(info));
        world.addRigidBody(bodies.back().get());
        if (i == 0)
          joints.push_back(
              std::make_unique<QuaternionHinge>(*bodies.back(), vec(-0.5, 0, 0), vec(0, 1, 0)));
        else
          joints.push_back(std::make_unique<QuaternionHinge>(
              *bodies[bodies.size() - 2], *bodies.back(), vec(0.5, 0, 0), vec(-0.5, 0, 0),
              vec(0, 1, 0), vec(0, 1, 0)));
        world.addConstraint(joints.back().get(), true);
      }
    }
    for (int i = 0; i < 60; ++i) world.stepSimulation(scalar(1. / 60), 0);
    std::vector<btScalar> numbers;
    for (const auto& body : bodies)
      for (int k = 0; k < 3; ++k) numbers.push_back(body->getCenterOfMassPosition()[k]);
    for (const auto& joint : joints) world.removeConstraint(joint.get());
    for (const auto& body : bodies) world.removeRigidBody(body.get());
    return numbers;
  };
  EXPECT_EQ(run(false), run(true));
}

// A joint at a centre of mass is solved by Bullet in one iteration. Its damping is the part of the velocity that it
// takes away; a static body with a velocity is a conveyor.
TEST(ExactJointSolver, TakesAwayThePartOfTheVelocityThatBulletDoes) {
  const auto run = [](bool is_exact, double damping, double conveyor) {
    World world(0, 10, [&]() -> std::unique_ptr<btConstraintSolver> {
      if (!is_exact) return std::make_unique<btSequentialImpulseConstraintSolver>();
      return exact();
    });
    btRigidBody &belt = world.add_box(0, vec(1, 1, 1), at(0, -5, 0)),
                &body = world.add_box(2, vec(0.1, 0.2, 0.3), at(0, 0, 0));
    auto& joint = world.add_joint<btPoint2PointConstraint>(belt, body, vec(0, 5, 0), vec(0, 0, 0));
    joint.m_setting.m_damping = btScalar(damping);
    belt.setLinearVelocity(vec(conveyor, 0, 0));
    body.setLinearVelocity(vec(1, 2, 3));
    body.setDamping(0, 0);
    world.step(1. / 60);
    return scenes::position(body);
  };
  for (const double damping : {1., 0.3})
    for (const double conveyor : {0., 0.5})
      EXPECT_LT((run(true, damping, conveyor) - run(false, damping, conveyor)).norm(), 1e-7)
          << damping << ", " << conveyor;
  EXPECT_GT(run(true, 0.3, 0).norm(), 1e-2);
  EXPECT_GT(run(true, 1, 0.5).norm(), 1e-3);
}

TEST(ExactJointSolver, AllocatesNothingOnceItHasSeenAnIsland) {
  World world(9.81, 10, exact);
  std::vector<btRigidBody*> links;
  for (int i = 0; i < 20; ++i) {
    links.push_back(&world.add_box(i == 19 ? 10000 : 1, vec(0.5, 0.1, 0.1), at(i + 0.5, 0, 0)));
    if (i == 0)
      world.add_joint<QuaternionHinge>(*links[0], vec(-0.5, 0, 0), vec(0, 1, 0));
    else
      world.add_joint<QuaternionHinge>(*links[size_t(i) - 1], *links[size_t(i)], vec(0.5, 0, 0),
                                       vec(-0.5, 0, 0), vec(0, 1, 0), vec(0, 1, 0));
  }
  for (int i = 0; i < 180; ++i) world.step(1. / 60);
  const long before = allocations;
  for (int i = 0; i < 180; ++i) world.step(1. / 60);
  EXPECT_EQ(allocations, before);
}

// --- every joint -------------------------------------------------------------------------------------

class EveryJoint : public testing::TestWithParam<kinds::Kind> {};

// What the joint's equalities lack, m or rad, where the bodies are.
double error(const pintle::Joint& joint, const btRigidBody& a, const btRigidBody& b) {
  pintle::RowMemory<8, 8> memory;
  pintle::Rows rows(memory);
  joint.addRows(pintle::BodyPair(a, b), rows);
  double most = 0;
  for (int i = 0; i < rows.equalities(); ++i)
    most = std::max(most, std::abs(double(rows[i].position)));
  return most;
}

// Two bodies that tumble on one joint hold at least as well as with Bullet's solver, with any settings.
// (A soft joint is not to hold.)
TEST_P(EveryJoint, HoldsAtLeastAsWellAsWithBullet) {
  const kinds::Kind& kind = GetParam();
  for (int variant = 0; variant < kind.variants; ++variant) {
    bool soft = false;
    const auto run = [&](const scenes::SolverFactory& make_solver) {
      World world(9.81, 10, make_solver);
      btRigidBody& a = world.add_box(1, vec(0.5, 0.1, 0.2), at(0, 0, 0));
      btRigidBody& b = world.add_box(3, vec(0.5, 0.1, 0.2), at(1, 0, 0));
      auto& joint = world.take_joint(kind.make(a, b, at(0.5, 0, 0), at(-0.5, 0, 0), variant));
      const auto rows = support::SolverRows::ofStep(joint);
      for (int i = 0; i < rows.announced(); ++i) soft = soft || rows[i].cfm() > 0;
      a.setAngularVelocity(vec(1, 2, -0.5));
      b.setAngularVelocity(vec(-0.5, 1, 1));
      double sum = 0;
      for (int i = 0; i < 120; ++i) {
        world.step(1. / 60);
        if (!support::is_finite(a) || !support::is_finite(b)) return HUGE_VAL;
        sum += error(joint, a, b) / 120;
      }
      return sum;
    };
    const double ours = run(exact), stocks = run({});
    EXPECT_LT(ours, HUGE_VAL) << "variant " << variant;
    if (soft) continue;
    EXPECT_LE(ours, stocks + (support::is_double ? 1e-9 : 1e-6)) << "variant " << variant;
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryJoint, testing::ValuesIn(kinds::all()),
                         [](const auto& kind) { return kind.param.name; });

}  // namespace
