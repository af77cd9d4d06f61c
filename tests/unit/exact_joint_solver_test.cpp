// What ExactJointSolver promises beside its figures (exact_scenes_test.cpp): it takes Bullet's place in
// all that a world, a joint and a body can see of a solver.
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/body_pair.h>
#include <pintle/rows/row.h>
#include <pintle/solver/exact_joint_solver.h>

#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorldMt.h>
#include <gtest/gtest.h>
#include <scenes/world.h>

#include <cstdlib>
#include <cstring>
#include <new>

#include "exact_support.h"
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

namespace exact_joint_solver_test {
namespace {

using pintle::BallJoint;
using pintle::ExactJointSolver;
using pintle::FixedJoint;
using pintle::QuaternionHinge;
using scenes::World;
using support::scalar;
using support::vec;
using namespace exact_support;

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

TEST(ExactJointSolver, AllocatesNothingInStepsOfSecondOrder) {
  World world(9.81, 10, [] {
    auto solver = std::make_unique<ExactJointSolver>();
    pintle::SolverOptions options;
    options.second_order = true;
    solver->setOptions(options);
    return solver;
  });
  addFloor(world);
  world.add_box(1, vec(0.5, 0.5, 0.5), at(5, 0, 0.5), true);
  world.add_box(1, vec(0.5, 0.5, 0.5), at(9, 0, 5000), true);
  btRigidBody& swings = world.add_box(1, vec(0.5, 0.1, 0.1), at(0.5, 0, 50));
  world.add_joint<QuaternionHinge>(swings, vec(-0.5, 0, 0), vec(0, 1, 0));
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
        sum += error(support::joint(joint), a, b) / 120;
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
}  // namespace exact_joint_solver_test
