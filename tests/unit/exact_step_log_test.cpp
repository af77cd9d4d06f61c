// What a step did, the options of the solver, and its log.
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/solver/exact_joint_solver.h>
#include <pintle/solver/step_log.h>

#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "autodiff.h"
#include "bodies.h"
#include "physics_support.h"
#include "support.h"

namespace exact_step_log {
namespace {

using physics::rounding;
using support::scalar;
using support::vec;

constexpr double dt = 1. / 60;

struct World {
  World() { world.setGravity(vec(0, 0, -9.81)); }
  void step(double by = dt) { world.stepSimulation(scalar(by), 0, scalar(by)); }

  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  pintle::ExactJointSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
};

/// A box of 0.2 m and 2 kg on an arm of 1 m, let go from the horizontal.
struct Pendulum : World {
  Pendulum() {
    world.addRigidBody(&body, 0, 0);
    world.addConstraint(&joint);
  }
  ~Pendulum() {
    world.removeConstraint(&joint);
    world.removeRigidBody(&body);
  }
  btBoxShape shape{vec(0.1, 0.1, 0.1)};
  btRigidBody body{2, nullptr, &shape, vec(0.02, 0.02, 0.02)};
  pintle::BallJoint joint{body, vec(-1, 0, 0)};
};

TEST(LastStep, OfAPendulum) {
  Pendulum of;
  EXPECT_EQ(of.solver.lastStep().components, 0);
  EXPECT_EQ(of.solver.lastStep().tier, 0);
  of.step();  // from rest: of no energy, what rounding gives is too much
  for (int i = 0; i < 120; ++i) {
    of.step();
    const pintle::StepReport step = of.solver.lastStep();
    EXPECT_EQ(step.components, 1) << i;
    EXPECT_EQ(step.tier, 1) << i;
    EXPECT_EQ(step.second_tier + step.one_by_one + step.not_converged, 0) << i;
    EXPECT_GE(step.newton_steps, 1) << i;
    EXPECT_GE(step.factorisations, 1) << i;
    EXPECT_LE(step.residual, rounding(1e-6, 1e-9)) << i;
    EXPECT_LE(step.open, rounding(2e-6, 1e-9)) << i;
    EXPECT_LE(std::abs(step.ledger), step.ledger_limit) << i;
  }
  // 1 % of the kinetic energy at the bottom, which is forgotten within a second or so.
  EXPECT_NEAR(of.solver.lastStep().ledger_limit, 0.01 * 2 * 9.81, 0.2 * 0.01 * 2 * 9.81);
}

// Where steps resolve how it swings: the end is foreseen so well that one solve leads there.
TEST(LastStep, TakesOneSolveOfAPendulum) {
  Pendulum of;
  int solves = 0;
  constexpr int steps = 480;
  for (int i = 0; i < steps; ++i) {
    of.step(1. / 240);
    solves += of.solver.lastStep().newton_steps;
  }
  EXPECT_LT(solves, 1.05 * steps);
}

// Impulses of the last step often lead to where it is: then there is nothing to solve.
TEST(LastStep, TakesFewSolvesAtRest) {
  Pendulum of;
  of.body.setCenterOfMassTransform(
      btTransform(btQuaternion(vec(0, 1, 0), scalar(SIMD_HALF_PI)), vec(-1, 0, -1)));
  of.body.setActivationState(DISABLE_DEACTIVATION);
  for (int i = 0; i < 60; ++i) of.step();
  int solves = 0, factors = 0;
  for (int i = 0; i < 120; ++i) {
    of.step();
    const pintle::StepReport step = of.solver.lastStep();
    solves += step.newton_steps;
    factors += step.factorisations;
    EXPECT_EQ(step.tier, 1) << i;
    EXPECT_EQ(step.not_converged, 0) << i;
    EXPECT_LT(of.body.getLinearVelocity().length(), rounding(1e-6, 1e-12)) << i;
  }
  EXPECT_LT(solves, rounding(90, 40));
  EXPECT_LE(factors, solves);
  EXPECT_NEAR(double(of.body.getCenterOfMassPosition().z()), -1, rounding(1e-6, 1e-12));
}

// Its impulses are large, and so is what they do by an error that is next to nothing.
TEST(LastStep, AHeavyLoadThatHangsStaysInTheFirstTier) {
  World of;
  support::Bodies bodies(of.world);
  btRigidBody* last = &bodies.add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 0.5));
  for (int i = 0; i < 10; ++i) {
    btRigidBody& link = bodies.add(i < 9 ? 1 : 1e6, vec(0.17, 0.17, 0.17), vec(0, 0, -0.5 - i));
    bodies.join(std::make_unique<pintle::BallJoint>(*last, link, vec(0, 0, -0.5), vec(0, 0, 0.5)));
    last = &link;
  }
  int second_tier = 0;
  for (int i = 0; i < 2000; ++i) {
    of.step();
    second_tier += of.solver.lastStep().second_tier;
  }
  EXPECT_LE(second_tier, 20);
}

// Also where it rests and takes no solve, and poses have no factor but that of the velocities.
TEST(LastStep, WhatRestsClosesByTheFactorOfItsVelocities) {
  Pendulum of;
  pintle::SolverOptions options;
  options.max_factors = 0;
  of.solver.setOptions(options);
  of.body.setActivationState(DISABLE_DEACTIVATION);
  const btQuaternion hanging(vec(0, 1, 0), scalar(SIMD_HALF_PI));
  of.body.setCenterOfMassTransform(btTransform(hanging, vec(-1, 0, -1)));
  for (int i = 0; i < 60; ++i) of.step();
  of.body.setCenterOfMassTransform(btTransform(hanging, vec(-1, 0, -1.001)));
  for (int i = 0; i < 120; ++i) of.step();
  EXPECT_LT(of.solver.lastStep().open, rounding(1e-5, 1e-9));
}

/// An arm of five links on hinges with stops, friction and motors, which is struck. Which of these act is found, by a few factors.
TEST(LastStep, FindsWhichRowsActUnderBlows) {
  World of;
  support::Bodies bodies(of.world);
  support::Random random(3);
  btRigidBody* last = &bodies.add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 0.5));
  const btVector3 top = vec(0, 0, 0.5), bottom = vec(0, 0, -0.5), axis = vec(1, 0, 0);
  for (int i = 0; i < 5; ++i) {
    btRigidBody& link = bodies.add(1, vec(0.17, 0.17, 0.17), vec(0, 0, -0.5 - i));
    auto hinge = std::make_unique<pintle::QuaternionHinge>(*last, link, bottom, top, axis, axis);
    hinge->setLimit(scalar(-0.4), scalar(0.4));
    hinge->setFriction(scalar(random.uniform(0.1, 3)));
    hinge->enableAngularMotor(true, scalar(random.uniform(-2, 2)),
                              scalar(random.uniform(0.01, 0.2)));
    bodies.join(std::move(hinge));
    last = &link;
  }
  const int steps = 2000;
  int unsettled = 0, factors = 0;
  for (int i = 0; i < steps; ++i) {
    for (const auto& body : bodies.bodies)
      if (random.uniform(0, 1) < 0.1)
        body->applyTorqueImpulse(
            vec(random.uniform(-1, 1) * std::exp(random.uniform(-2, 2)), 0, 0));
    of.step();
    const pintle::StepReport step = of.solver.lastStep();
    unsettled += step.unsettled;
    factors += step.factorisations;
  }
  EXPECT_LE(unsettled, steps / 8);
  EXPECT_LE(factors, 20 * steps);
}

TEST(LastStep, SaysHowFarJointsAreOpen) {
  Pendulum of;
  of.body.setCenterOfMassTransform(btTransform(btQuaternion::getIdentity(), vec(0.3, 0, 0)));
  of.step();
  EXPECT_NEAR(of.solver.lastStep().open, 0.3, 1e-6);
}

TEST(LastStep, IsOfNothingWhereAllSleep) {
  Pendulum of;
  of.step();
  of.body.forceActivationState(ISLAND_SLEEPING);
  of.step();
  EXPECT_EQ(of.solver.lastStep().components, 0);
}

void expectRejected(const pintle::SolverOptions& options, const std::string& with) {
  pintle::ExactJointSolver solver;
  try {
    solver.setOptions(options);
    ADD_FAILURE() << with;
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("pintle::SolverOptions: " + with), std::string::npos)
        << error.what();
  }
  EXPECT_EQ(solver.options().ledger_share, pintle::SolverOptions().ledger_share);
}

/// 8 x 8 plates, each joined to its neighbours, that swing from two corners; those of the far edge are heavy.
template <class Ball>
struct Net {
  static constexpr int size = 8;

  explicit Net(btConstraintSolver& solver)
      : world(&dispatcher, &broadphase, &solver, &configuration) {
    world.setGravity(vec(0, 0, -9.81));
    const btVector3 x = vec(0.5, 0, 0), y = vec(0, 0.5, 0);
    for (int i = 0; i < size * size; ++i) {
      const double mass = i < size * (size - 1) ? 1 : 100;
      btRigidBody::btRigidBodyConstructionInfo info(scalar(mass), nullptr, &shape,
                                                    vec(0.06 * mass, 0.06 * mass, 0.1 * mass));
      info.m_startWorldTransform.setOrigin(vec(i % size, double(i / size), 0));
      bodies.push_back(std::make_unique<btRigidBody>(info));
      world.addRigidBody(bodies.back().get(), 0, 0);
      if (i % size > 0) join(i - 1, x, i);
      if (i >= size) join(i - size, y, i);
    }
    for (const int corner : {0, size - 1}) {
      joints.push_back(std::make_unique<Ball>(*bodies[size_t(corner)], (corner > 0 ? x : -x) - y));
      world.addConstraint(joints.back().get(), true);
    }
  }
  ~Net() {
    for (const auto& joint : joints) world.removeConstraint(joint.get());
    for (const auto& body : bodies) world.removeRigidBody(body.get());
  }
  void join(int a, const btVector3& half, int b) {
    joints.push_back(std::make_unique<Ball>(*bodies[size_t(a)], *bodies[size_t(b)], half, -half));
    world.addConstraint(joints.back().get(), true);
    ends.push_back({a, b});
  }
  /// m: the largest.
  double gap() const {
    double most = 0;
    for (size_t c = 0; c < ends.size(); ++c) {
      const btVector3 half =
          vec(ends[c][1] - ends[c][0] == 1 ? 0.5 : 0, ends[c][1] - ends[c][0] == 1 ? 0 : 0.5, 0);
      const auto at = [&](int body, const btVector3& point) {
        return bodies[size_t(body)]->getCenterOfMassTransform()(point);
      };
      most = std::max(most, double((at(ends[c][0], half) - at(ends[c][1], -half)).length()));
    }
    return most;
  }

  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btDiscreteDynamicsWorld world;
  btBoxShape shape{vec(0.4, 0.4, 0.1)};
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  std::vector<std::unique_ptr<btTypedConstraint>> joints;
  std::vector<std::array<int, 2>> ends;
};

TEST(SolverOptions, OneMoreFactorAStepHoldsANet) {
  btSequentialImpulseConstraintSolver bullet;
  pintle::ExactJointSolver exact, cheap;
  pintle::SolverOptions options;
  options.max_factors = 1;
  cheap.setOptions(options);
  Net<btPoint2PointConstraint> stock(bullet);
  Net<pintle::BallJoint> all(exact), few(cheap);
  double stock_gap = 0, gap = 0;
  int most = 0;
  for (int i = 0; i < 60; ++i) {
    stock.world.stepSimulation(scalar(dt), 0, scalar(dt));
    all.world.stepSimulation(scalar(dt), 0, scalar(dt));
    few.world.stepSimulation(scalar(dt), 0, scalar(dt));
    stock_gap += stock.gap() / 60;
    gap += few.gap() / 60;
    most = std::max(most, exact.lastStep().factorisations);
    EXPECT_LE(cheap.lastStep().factorisations, 3)
        << i;  // of velocities, of those at the end, of poses
  }
  EXPECT_LT(gap, stock_gap / 100);
  EXPECT_GT(most, 3) << "of which it has need";
}

TEST(SolverOptions, AreChecked) {
  pintle::SolverOptions options;
  options.ledger_share = 0.05;
  pintle::ExactJointSolver solver;
  solver.setOptions(options);
  EXPECT_EQ(solver.options().ledger_share, 0.05);
  options = {};
  options.newton_tolerance = -1;
  expectRejected(options, "newton_tolerance = -1: must be above zero");
  options = {};
  options.pose_tolerance = std::numeric_limits<double>::quiet_NaN();
  expectRejected(options, "pose_tolerance = nan: must be above zero");
  options = {};
  options.max_iterations = 0;
  expectRejected(options, "max_iterations = 0: must be 1 or more");
  options = {};
  options.max_factors = -1;
  expectRejected(options, "max_factors = -1: must be 0 or more");
  options = {};
  options.longest_path = 0;
  expectRejected(options, "longest_path = 0: must be 1 or more");
  options = {};
  options.dependent_margin = 0.5;
  expectRejected(options, "dependent_margin = 0.5: must be 1 or more");
  options = {};
  options.ledger_share = 1;
  expectRejected(options, "ledger_share = 1: must be above 0 and below 1");
  options = {};
  options.stable_swing = 4;
  expectRejected(options, "stable_swing = 4: must be above 0 and below 4");
}

std::vector<std::vector<double>> numbers(std::istream& in) {
  std::vector<std::vector<double>> lines;
  for (std::string line; std::getline(in, line);) {
    lines.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) lines.back().push_back(std::stod(cell));
  }
  return lines;
}

TEST(StepLog, OfAPendulum) {
  Pendulum of;
  std::stringstream out;
  pintle::StepLog log(of.world, out);
  for (int i = 0; i < 60; ++i) {
    of.step();
    log.write();
  }
  std::string names;
  std::getline(out, names);
  EXPECT_EQ(names,
            "time,kinetic,potential,work,ledger,ledger_limit,residual,open,tier,not_converged,"
            "components");
  const auto lines = numbers(out);
  ASSERT_EQ(lines.size(), 60u);
  const double start = lines[0][1] + lines[0][2];
  for (const auto& line : lines) {
    ASSERT_EQ(line.size(), 11u);
    EXPECT_NEAR(line[1] + line[2], start, 0.02 * 2 * 9.81) << "at " << line[0] << " s";
    if (&line != &lines.front()) {
      EXPECT_EQ(line[8], 1);
    }
    EXPECT_EQ(line[10], 1);
  }
  EXPECT_NEAR(lines.back()[0], 1, 1e-5);
  EXPECT_GT(lines[30][1], 1) << "it swings";
}

TEST(StepLog, NeedsAnExactSolver) {
  Pendulum of;
  btSequentialImpulseConstraintSolver stock;
  of.world.setConstraintSolver(&stock);
  std::ostringstream out;
  EXPECT_THROW(pintle::StepLog(of.world, out), std::invalid_argument);
  EXPECT_THROW(pintle::lastStep(of.world), std::invalid_argument);
  EXPECT_EQ(out.str(), "");
}

}  // namespace
}  // namespace exact_step_log
