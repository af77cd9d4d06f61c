// A hinge of Pintle's is a hinge of Bullet's: what clients do to one, through whatever pointer they hold it.
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <gtest/gtest.h>
#include <pintle/joints/dot_hinge.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/two_point_hinge.h>

#include <cstring>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "announcing_joints.h"
#include "solver_of_tests.h"
#include "support.h"

namespace derived_hinge_test {
namespace {

using pintle::QuaternionHinge;
using scenes::pi;
using support::infinite;
using support::is_double;
using support::nan_value;
using support::Random;
using support::scalar;
using support::SolverRows;
using support::vec;

constexpr double dt = 1. / 60;

// Two bodies whose joint frames coincide, and a hinge about z between them.
template <class Hinge = QuaternionHinge>
struct Pair {
  std::unique_ptr<btRigidBody> a = support::body(1, vec(1, 2, 3), scenes::pose_at(vec(0, 0, 0)));
  std::unique_ptr<btRigidBody> b = support::body(2, vec(2, 1, 2), scenes::pose_at(vec(1, 0, 0)));
  Hinge hinge{*a, *b, scenes::pose_at(vec(0.5, 0, 0)), scenes::pose_at(vec(-0.5, 0, 0)), true};
  btHingeConstraint& stock() { return hinge; }
  // Turns b about the hinge's axis.
  void turn(double angle) {
    const btTransform at(btQuaternion(vec(0, 0, 1), scalar(angle)), vec(0.5, 0, 0));
    b->setCenterOfMassTransform(at * scenes::pose_at(vec(0.5, 0, 0)));
  }
};

bool isWhole(const SolverRows& rows) { return rows.finite() && rows.touched() <= rows.announced(); }

// --- it is one -----------------------------------------------------------------------------------

TEST(DerivedHinge, IsAHingeOfBulletsAtTheSameAddress) {
  Pair<> pair;
  btTypedConstraint* const constraint = &pair.hinge;
  EXPECT_EQ(constraint->getConstraintType(), HINGE_CONSTRAINT_TYPE);
  // As C bindings do it.
  void* const handle = &pair.hinge;
  EXPECT_EQ(static_cast<btTypedConstraint*>(handle), constraint);
  EXPECT_EQ(static_cast<btHingeConstraint*>(handle), &pair.stock());
  EXPECT_EQ(handle, static_cast<btHingeAccumulatedAngleConstraint*>(&pair.hinge));
  btTransform* const frame = &constraint->getRigidBodyA() == pair.a.get()
                                 ? &static_cast<btHingeConstraint*>(constraint)->getFrameOffsetA()
                                 : nullptr;
  EXPECT_EQ(frame, &pair.hinge.getAFrame());
}

// An arm that falls about an axis that lies.
struct Hanging {
  scenes::World world;
  const btQuaternion about_y{vec(1, 0, 0), scalar(-pi / 2)};
  btRigidBody& post = world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
  btRigidBody& arm = world.add_box(1, vec(0.3, 0.1, 0.1), scenes::pose_at(vec(1, 0, 0)));
  QuaternionHinge& hinge = world.add_joint<QuaternionHinge>(
      post, arm, btTransform(about_y, vec(0.5, 0, 0)), btTransform(about_y, vec(-0.5, 0, 0)), true);
};

// As an engine does, which knows its joints by their type.
void configure(btTypedConstraint& constraint) {
  switch (constraint.getConstraintType()) {
    case HINGE_CONSTRAINT_TYPE: {
      auto& hinge = static_cast<btHingeConstraint&>(constraint);
      hinge.setLimit(scalar(-0.5), scalar(0.25));
      hinge.setFrames(scenes::pose_at(vec(0.4, 0, 0)), scenes::pose_at(vec(-0.6, 0, 0)));
      break;
    }
    default: FAIL() << "not known";
  }
}

TEST(DerivedHinge, AnEngineThatAsksForItsTypeConfiguresIt) {
  Hanging hanging;
  scenes::World& world = hanging.world;
  QuaternionHinge& hinge = hanging.hinge;
  auto& stock = static_cast<btHingeConstraint&>(hinge);
  configure(hinge);
  stock.setFrames(btTransform(hanging.about_y, vec(0.4, 0, 0)),
                  btTransform(hanging.about_y, vec(-0.6, 0, 0)));
  for (int i = 0; i < 240; ++i) world.step(dt);
  // It hangs against a limit of either side, by the pivots that it was given then.
  const double angle = double(stock.getHingeAngle());
  EXPECT_LT(std::min(std::abs(angle - 0.25), std::abs(angle + 0.5)), 0.02) << angle;
  const btVector3 gap = hanging.arm.getCenterOfMassTransform() * vec(-0.6, 0, 0) - vec(0.4, 0, 0);
  EXPECT_LT(double(gap.length()), 0.01);
}

// --- what stands in Bullet's object --------------------------------------------------------------

TEST(DerivedHinge, WhatAnyPointerWritesHoldsInTheNextStep) {
  const btTransform frame(btQuaternion(vec(1, 0, 0), scalar(0.2)), vec(0.3, 0.1, 0));
  struct Change {
    const char* name;
    std::function<void(btHingeConstraint&)> by_stock;
    std::function<void(QuaternionHinge&)> by_ours;
  };
  const Change changes[] = {
      {"limit", [](auto& h) { h.setLimit(scalar(0.1), scalar(0.2), 1, scalar(0.6), scalar(0.5)); },
       [](auto& h) { h.setLimit(scalar(0.1), scalar(0.2), 1, scalar(0.6), scalar(0.5)); }},
      {"motor", [](auto& h) { h.enableAngularMotor(true, 2, 3); },
       [](auto& h) { h.enableAngularMotor(true, 2, 3); }},
      {"motor, part by part",
       [](auto& h) {
         h.enableMotor(true);
         h.setMaxMotorImpulse(3);
         h.setMotorTargetVelocity(2);
       },
       [](auto& h) { h.enableAngularMotor(true, 2, 3); }},
      {"angular only", [](auto& h) { h.setAngularOnly(true); },
       [](auto& h) { h.setAngularOnly(true); }},
      {"frames", [&](auto& h) { h.setFrames(frame, frame); },
       [&](auto& h) { h.setFrames(frame, frame); }},
      {"frames by reference", [&](auto& h) { h.getAFrame() = h.getFrameOffsetB() = frame; },
       [&](auto& h) { h.setFrames(frame, frame); }},
      {"frame offset", [](auto& h) { h.setUseFrameOffset(false); },
       [](auto& h) { h.setBlockRows(false); }},
      {"ERP", [](auto& h) { h.setParam(BT_CONSTRAINT_ERP, scalar(0.7)); },
       [](auto& h) { h.setParam(BT_CONSTRAINT_ERP, scalar(0.7)); }},
  };
  for (const Change& change : changes) {
    SCOPED_TRACE(change.name);
    Pair<> by_stock, by_ours, unchanged;
    for (Pair<>* pair : {&by_stock, &by_ours, &unchanged}) {
      pair->turn(0.3);
      pair->b->translate(vec(0.01, 0.02, 0.03));
      pair->b->setAngularVelocity(vec(0.1, 0.2, 0.3));
      SolverRows::ofStep(pair->hinge);
    }
    change.by_stock(by_stock.stock());
    change.by_ours(by_ours.hinge);
    const SolverRows rows = SolverRows::ofStep(by_stock.hinge);
    EXPECT_EQ(rows, SolverRows::ofStep(by_ours.hinge));
    EXPECT_NE(rows, SolverRows::ofStep(unchanged.hinge));
    EXPECT_TRUE(isWhole(rows));
    EXPECT_EQ(by_stock.hinge.whyIgnored(), "");
  }
}

TEST(DerivedHinge, TheLimitThatWasWrittenLastHolds) {
  Pair<> pair;
  pair.turn(1.5);
  const auto rows = [&] { return SolverRows::ofStep(pair.hinge).announced(); };
  pair.hinge.setLimit(-10, 10);
  EXPECT_EQ(rows(), 5);
  EXPECT_EQ(pair.hinge.getLowerLimit(), -10);
  EXPECT_TRUE(pair.hinge.hasLimit());
  EXPECT_FALSE(pair.stock().hasLimit());  // Bullet's has none of more than a turn
  pair.stock().setLimit(0, 1);
  EXPECT_EQ(rows(), 6);
  EXPECT_EQ(pair.hinge.getUpperLimit(), 1);
  pair.hinge.setLimit(-10, 10);
  EXPECT_EQ(rows(), 5);
  pair.hinge.setLimit(-1, 1);
  EXPECT_EQ(rows(), 6);
  pair.stock().setLimit(1, -1);
  EXPECT_EQ(rows(), 5);
  EXPECT_FALSE(pair.hinge.hasLimit());
}

TEST(DerivedHinge, TheDriveThatWasWrittenLastActs) {
  Pair<> pair;
  pair.hinge.enableAngularMotor(true, 2, 3);
  const SolverRows motor = SolverRows::ofStep(pair.hinge);
  pair.hinge.setMotorServo(1, 1, 1, infinite);
  const SolverRows servo = SolverRows::ofStep(pair.hinge);
  EXPECT_NE(servo, motor);
  EXPECT_TRUE(pair.stock().getEnableAngularMotor());
  pair.stock().enableMotor(false);
  EXPECT_EQ(SolverRows::ofStep(pair.hinge).announced(), 5);
  pair.stock().enableMotor(true);
  EXPECT_EQ(SolverRows::ofStep(pair.hinge), servo);
  pair.stock().enableAngularMotor(true, 1, 3);
  SolverRows::ofStep(pair.hinge);
  pair.stock().setMotorTargetVelocity(2);
  EXPECT_EQ(SolverRows::ofStep(pair.hinge), motor);
  pair.hinge.setMotorServo(1, 1, 1, infinite);
  EXPECT_EQ(SolverRows::ofStep(pair.hinge), servo);
  // By Pintle's type also the numbers that stand there already.
  pair.hinge.enableAngularMotor(true, 2, 3);
  EXPECT_EQ(SolverRows::ofStep(pair.hinge), motor);
}

// The numbers of the velocity motor that stood there before the servo.
TEST(DerivedHinge, AMotorComesAgainAfterAServo) {
  const std::function<void(QuaternionHinge&)> again[] = {
      [](auto& h) { h.enableAngularMotor(true, 2, 10); },
      [](auto& h) { h.setMotorTargetVelocity(2); }};
  for (const auto& call : again) {
    Pair<> pair, twin;
    pair.hinge.enableAngularMotor(false, 2, 10);
    pair.hinge.setMotorServo(1, 1, 1, infinite);
    call(pair.hinge);
    twin.hinge.enableAngularMotor(true, 2, 10);
    EXPECT_EQ(SolverRows::ofStep(pair.hinge), SolverRows::ofStep(twin.hinge));
    EXPECT_EQ(pair.hinge.whyIgnored(), "");
  }
}

TEST(DerivedHinge, AWallAtHalfATurnGoesWithBulletsLimit) {
  for (const double half : {pi, 3.14159, 3.1415926}) {
    Pair<> pair;
    pair.hinge.setAccumulatedLimit(scalar(-half), scalar(half));
    pair.turn(3.1);
    pair.b->setAngularVelocity(vec(0, 0, 6));
    EXPECT_EQ(SolverRows::ofStep(pair.hinge).announced(), 6);
    pair.stock().setLimit(scalar(-half), scalar(half));
    EXPECT_EQ(SolverRows::ofStep(pair.hinge).announced(), 5);
  }
}

// A pivot that is moved is no other zero, nor is what stands in the fourth number of a vector.
TEST(DerivedHinge, TurnsAreKeptWhereAxesStay) {
  Pair<> pair;
  for (int i = 1; i <= 30; ++i) {
    pair.turn(0.5 * i);
    SolverRows::ofStep(pair.hinge);
    pair.hinge.getAFrame().getOrigin().setX(scalar(0.5 + 0.001 * i));
    pair.hinge.getAFrame().getOrigin()[3] = scalar(i);
    pair.hinge.getBFrame().getBasis()[1][3] = nan_value;
  }
  EXPECT_NEAR(double(pair.hinge.getAccumulatedHingeAngle()), 15, is_double ? 1e-9 : 1e-4);
}

// At its limit by what it presses, not by the last bit of its angle.
TEST(DerivedHinge, AHingeThatLiesOnItsLimitSaysSo) {
  Hanging hanging;
  scenes::World& world = hanging.world;
  QuaternionHinge& hinge = hanging.hinge;
  hinge.setLimit(scalar(-0.2), scalar(0.2), scalar(0.9), 1, 0);
  btHingeConstraint& stock = hinge;
  for (int i = 0; i < 120; ++i) world.step(dt);
  const btScalar side = stock.getLimitSign();
  EXPECT_NE(side, 0);
  for (int i = 0; i < 60; ++i) {
    world.step(dt);
    EXPECT_TRUE(stock.getSolveLimit()) << i;
    EXPECT_EQ(stock.getLimitSign(), side) << i;
  }
}

// Also where its two numbers do not say what it is: (-2 pi, 2 pi) reads as (0, 0), (-5, 5) as a range.
TEST(DerivedHinge, ALimitThatBulletsSetterMadeActsWhereBulletsDoes) {
  Random random(3);
  std::vector<std::pair<double, double>> limits = {
      {-2 * pi, 2 * pi}, {-5, 5}, {0, 2 * pi}, {-pi, pi}, {0, 4 * pi},          {1, -1},
      {0.3, 0.3},        {4, 5},  {-7, -6},    {2, 4},    {-pi / 2, 3 * pi / 2}};
  for (int i = 0; i < 40; ++i) {
    const double low = random.uniform(-8, 8);
    limits.emplace_back(low, low + random.uniform(0, 7));
  }
  for (const auto& [low, high] : limits) {
    for (int i = 0; i < 24; ++i) {
      const double angle = -pi + 0.13 + i * pi / 12;
      SCOPED_TRACE(testing::Message() << low << " to " << high << ", at " << angle);
      Pair<> ours;
      Pair<btHingeConstraint> stock;
      ours.turn(angle);
      stock.turn(angle);
      for (btHingeConstraint* h : {&ours.stock(), &stock.hinge})
        h->setLimit(scalar(low), scalar(high));
      // No reach: bodies at rest.
      const SolverRows rows = SolverRows::ofStep(ours.hinge),
                       of_stock = SolverRows::ofStep(stock.hinge);
      EXPECT_EQ(rows.announced(), low == high ? 6 : of_stock.announced());
      EXPECT_EQ(ours.stock().getSolveLimit(), stock.hinge.getSolveLimit());
      EXPECT_EQ(ours.stock().getLimitSign(), stock.hinge.getLimitSign());
    }
  }
}

TEST(DerivedHinge, LimitsOfMoreThanATurnHoldBesideBulletsGetters) {
  scenes::World world(0);
  btRigidBody& post = world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
  btRigidBody& wheel = world.add_box(1, vec(0.3, 0.3, 0.1), scenes::pose_at(vec(0, 0, 0)));
  auto& hinge = world.add_joint<QuaternionHinge>(post, wheel, btTransform::getIdentity(),
                                                 btTransform::getIdentity(), true);
  btHingeAccumulatedAngleConstraint& stock = hinge;
  hinge.setLimit(0, scalar(4 * pi), scalar(0.9), 1, 0);
  stock.enableAngularMotor(true, 6, 1);
  for (int i = 0; i < 240; ++i) {
    world.step(dt);
    // By Bullet's name, too, which else loses count.
    EXPECT_NEAR(double(stock.getAccumulatedHingeAngle()), double(hinge.getAccumulatedHingeAngle()),
                is_double ? 1e-12 : 1e-5);
  }
  EXPECT_NEAR(double(hinge.getAccumulatedHingeAngle()), 4 * pi, 1e-3);
}

// --- what no number is ---------------------------------------------------------------------------

struct Bad {
  const char* name;
  std::function<void(btHingeConstraint&, btScalar)> write;
  std::function<btScalar(btHingeConstraint&)> read;
};
const Bad not_a_number[] = {
    {"limit", [](auto& h, btScalar x) { h.setLimit(-1, x, 1, scalar(0.6), scalar(0.5)); },
     [](auto& h) { return h.getUpperLimit(); }},
    {"bias factor", [](auto& h, btScalar x) { h.setLimit(scalar(0.1), 1, 1, x); },
     [](auto& h) { return h.getLimitBiasFactor(); }},
    {"relaxation factor", [](auto& h, btScalar x) { h.setLimit(scalar(0.1), 1, 1, 1, x); },
     [](auto& h) { return h.getLimitRelaxationFactor(); }},
    {"motor target velocity", [](auto& h, btScalar x) { h.setMotorTargetVelocity(x); },
     [](auto& h) { return static_cast<QuaternionHinge&>(h).getMotorTargetVelocity(); }},
    {"max motor impulse", [](auto& h, btScalar x) { h.setMaxMotorImpulse(x); },
     [](auto& h) { return h.getMaxMotorImpulse(); }},
    {"STOP_ERP", [](auto& h, btScalar x) { h.setParam(BT_CONSTRAINT_STOP_ERP, x); },
     [](auto& h) { return h.getParam(BT_CONSTRAINT_STOP_ERP); }},
    {"STOP_CFM", [](auto& h, btScalar x) { h.setParam(BT_CONSTRAINT_STOP_CFM, x); },
     [](auto& h) { return h.getParam(BT_CONSTRAINT_STOP_CFM); }},
    {"ERP", [](auto& h, btScalar x) { h.setParam(BT_CONSTRAINT_ERP, x); },
     [](auto& h) { return h.getParam(BT_CONSTRAINT_ERP); }},
    {"CFM", [](auto& h, btScalar x) { h.setParam(BT_CONSTRAINT_CFM, x); },
     [](auto& h) { return h.getParam(BT_CONSTRAINT_CFM); }},
    {"joint frames", [](auto& h, btScalar x) { h.getAFrame().getOrigin().setY(x); },
     [](auto& h) { return h.getFrameOffsetA().getOrigin().y(); }},
    {"joint frames", [](auto& h, btScalar x) { h.getBFrame().getBasis()[1][2] = x; },
     [](auto& h) { return h.getFrameOffsetB().getBasis()[1][2]; }},
};

TEST(DerivedHinge, OfWhatIsNotANumberTheLastGoodOneStays) {
  for (const Bad& bad : not_a_number) {
    SCOPED_TRACE(bad.name);
    const auto set = [](Pair<>& pair) {
      pair.turn(-0.1);  // beyond the limit
      pair.hinge.setLimit(scalar(0.1), 1, 1, scalar(0.6), scalar(0.5));
      pair.hinge.enableAngularMotor(true, 2, 3);
      for (const int number :
           {BT_CONSTRAINT_ERP, BT_CONSTRAINT_CFM, BT_CONSTRAINT_STOP_ERP, BT_CONSTRAINT_STOP_CFM})
        pair.hinge.setParam(number, scalar(0.125));
      SolverRows::ofStep(pair.hinge);
    };
    Pair<> pair, twin;
    set(pair);
    set(twin);
    bad.write(pair.stock(), nan_value);
    EXPECT_TRUE(std::isnan(bad.read(pair.stock())));
    for (int i = 0; i < 2; ++i) {
      // Limit and factors are written by one method.
      if (bad.name != std::string("bias factor") && bad.name != std::string("relaxation factor")) {
        EXPECT_EQ(SolverRows::ofStep(pair.hinge), SolverRows::ofStep(twin.hinge));
      }
      const std::string why = pair.hinge.whyIgnored();
      EXPECT_NE(why.find("QuaternionHinge"), std::string::npos) << why;
      EXPECT_NE(why.find(bad.name), std::string::npos) << why;
      EXPECT_TRUE(isWhole(SolverRows::ofStep(pair.hinge)));
    }
    bad.write(pair.stock(), scalar(0.5));
    EXPECT_TRUE(isWhole(SolverRows::ofStep(pair.hinge)));
    EXPECT_EQ(pair.hinge.whyIgnored(), "");
  }
}

TEST(DerivedHinge, TakesWhatBulletTakesBelowZero) {
  Pair<> pair;
  pair.hinge.setLimit(scalar(0.1), 1, 1, -1, -1);
  pair.hinge.enableAngularMotor(true, 2, -3);
  pair.hinge.setParam(BT_CONSTRAINT_STOP_ERP, -1);
  const SolverRows rows = SolverRows::ofStep(pair.hinge);
  EXPECT_TRUE(isWhole(rows));
  ASSERT_EQ(rows.announced(), 7);
  // The motor does nothing.
  EXPECT_EQ(rows[5].lower(), 0);
  EXPECT_EQ(rows[5].upper(), 0);
  EXPECT_NE(pair.hinge.whyIgnored().find("max motor impulse"), std::string::npos);
}

// A mirror image, a scale, a shear: Bullet takes any matrix.
TEST(DerivedHinge, HoldsWithFramesThatAreNone) {
  const btMatrix3x3 matrices[] = {{1, 0, 0, 0, 1, 0, 0, 0, -1},
                                  {2, 0, 0, 0, 2, 0, 0, 0, 2},
                                  {1, scalar(0.5), 0, 0, 1, 0, 0, 0, 1},
                                  {0, 0, 0, 0, 0, 0, 0, 0, 1}};
  for (const btMatrix3x3& matrix : matrices) {
    SCOPED_TRACE(testing::Message() << matrix[0][0] << ' ' << matrix[0][1] << ' ' << matrix[2][2]);
    scenes::World world;
    btRigidBody& post = world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
    btRigidBody& arm = world.add_box(1, vec(0.3, 0.1, 0.1), scenes::pose_at(vec(1, 0, 0)));
    auto& hinge = world.add_joint<QuaternionHinge>(post, arm, btTransform(matrix, vec(0.5, 0, 0)),
                                                   btTransform(matrix, vec(-0.5, 0, 0)));
    arm.setAngularVelocity(vec(0, 0, 3));
    for (int i = 0; i < 120; ++i) world.step(dt);
    EXPECT_EQ(hinge.whyIgnored(), "");
    EXPECT_EQ(hinge.getFrameOffsetA().getBasis(), matrix);  // as the client wrote it
    const btVector3 gap = arm.getCenterOfMassTransform() * vec(-0.5, 0, 0) - vec(0.5, 0, 0);
    EXPECT_LT(double(gap.length()), 1e-3);
    EXPECT_NEAR(double(arm.getWorldTransform().getBasis().getColumn(2).z()), 1, 1e-4);
  }
}

// Bullet measures the angle by the y axes.
TEST(DerivedHinge, AMirrorImageOfAFrameHasBulletsZero) {
  const auto a = support::body(1, vec(1, 1, 1), btTransform::getIdentity());
  const auto b = support::body(1, vec(1, 1, 1), btTransform::getIdentity());
  const btTransform mirrored(btMatrix3x3(-1, 0, 0, 0, 1, 0, 0, 0, 1));
  QuaternionHinge hinge(*a, *b, mirrored, btTransform::getIdentity());
  hinge.setLimit(scalar(-0.5), scalar(0.5));
  EXPECT_NEAR(double(hinge.getHingeAngle()), 0, 1e-6);
  EXPECT_NEAR(double(hinge.getAccumulatedHingeAngle()), 0, 1e-6);
  EXPECT_EQ(SolverRows::ofStep(hinge).announced(), 5);
}

// A parameter that was never set, and is set to no number, is not set.
TEST(DerivedHinge, AParameterThatIsNotANumberIsNone) {
  Pair<> pair, twin;
  for (Pair<>* of : {&pair, &twin}) {
    of->hinge.setLimit(1, 2);
    of->b->translate(vec(0, 0.1, 0));
  }
  for (const int number : {BT_CONSTRAINT_ERP, BT_CONSTRAINT_STOP_ERP, BT_CONSTRAINT_STOP_CFM})
    pair.hinge.setParam(number, nan_value);
  EXPECT_EQ(SolverRows::ofStep(pair.hinge), SolverRows::ofStep(twin.hinge));
  EXPECT_NE(pair.hinge.whyIgnored(), "");
}

TEST(DerivedHinge, HoldsNothingBeforeItHasFrames) {
  const auto a = support::body(1, vec(1, 1, 1), btTransform::getIdentity());
  const auto b = support::body(1, vec(1, 1, 1), btTransform::getIdentity());
  const btVector3 good(0, 0, 1), none(0, 0, 0), nan(0, nan_value, 1), inf(infinite, 0, 0);
  std::vector<std::unique_ptr<QuaternionHinge>> hinges;
  for (const btVector3& bad : {none, nan, inf})
    hinges.push_back(std::make_unique<QuaternionHinge>(*a, *b, good, good, bad, good));
  for (const btVector3& bad : {nan, inf}) {
    hinges.push_back(std::make_unique<QuaternionHinge>(*a, *b, bad, good, good, good));
    hinges.push_back(std::make_unique<QuaternionHinge>(*a, bad, good));
    hinges.push_back(std::make_unique<QuaternionHinge>(
        *a, *b, btTransform(btMatrix3x3::getIdentity(), bad), btTransform::getIdentity()));
  }
  for (const auto& hinge : hinges) {
    EXPECT_EQ(SolverRows::ofStep(*hinge).announced(), 0);
    EXPECT_NE(hinge->whyIgnored(), "");
    hinge->setFrames(btTransform::getIdentity(), btTransform::getIdentity());
    EXPECT_EQ(SolverRows::ofStep(*hinge).announced(), 5);
    EXPECT_EQ(hinge->whyIgnored(), "");
  }
}

// Bullet leaves a motor's numbers as the memory was.
TEST(DerivedHinge, AMotorThatWasNeverSetStandsStill) {
  const auto a = support::body(1, vec(1, 1, 1), btTransform::getIdentity());
  const auto b = support::body(1, vec(1, 1, 1), btTransform::getIdentity());
  alignas(16) static unsigned char memory[sizeof(QuaternionHinge)];
  const btTransform frame = btTransform::getIdentity();
  const btVector3 none(0, 0, 0), up(0, 0, 1);
  const std::function<QuaternionHinge*()> constructors[] = {
      [&] { return new (memory) QuaternionHinge(*a, *b, none, none, up, up); },
      [&] { return new (memory) QuaternionHinge(*a, none, up); },
      [&] { return new (memory) QuaternionHinge(*a, *b, frame, frame); },
      [&] { return new (memory) QuaternionHinge(*a, frame); }};
  for (const auto& construct : constructors) {
    std::memset(memory, 0x42, sizeof(memory));
    QuaternionHinge* const hinge = construct();
    static_cast<btHingeConstraint*>(hinge)->enableMotor(true);
    const SolverRows rows = SolverRows::ofStep(*hinge);
    ASSERT_EQ(rows.announced(), 6);
    EXPECT_EQ(rows[5].rhs(), 0);
    EXPECT_EQ(rows[5].upper(), 0);
    EXPECT_EQ(hinge->getParam(BT_CONSTRAINT_STOP_ERP), 0);
    hinge->~QuaternionHinge();
  }
}

// --- subclasses, and clients between steps -------------------------------------------------------

using Announces = support::Announces<QuaternionHinge, 5>;
using AnnouncesAsBullet = support::AnnouncesAsBullet<QuaternionHinge, btHingeConstraint>;

// A client's that sets frames where its base has announced its rows, and before it writes them: the joint's angle is another one then.
template <class J>
class SetsFrames : public J {
 public:
  using J::J;
  void getInfo1(btTypedConstraint::btConstraintInfo1* info) override {
    J::getInfo1(info);
    turn(0.5);
  }
  void getInfo2(btTypedConstraint::btConstraintInfo2* info) override {
    turn(1);
    J::getInfo2(info);
    turn(0);
  }

 private:
  void turn(double angle) {
    const btTransform about_z(btQuaternion(vec(0, 0, 1), scalar(angle)), vec(0.5, 0, 0));
    btHingeConstraint::setFrames(about_z, btTransform(this->getBFrame()));
  }
};

template <class J>
struct Swing {
  scenes::World world;
  btRigidBody& post = world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
  btRigidBody& arm = world.add_box(1, vec(0.3, 0.1, 0.1), scenes::pose_at(vec(1, 0, 0)));
  J& hinge;

  Swing()
      : hinge(world.add_joint<J>(post, arm, scenes::pose_at(vec(0.5, 0, 0)),
                                 scenes::pose_at(vec(-0.5, 0, 0)), true)) {
    arm.setAngularVelocity(vec(0.3, 0.2, 4));
  }
  double gap() const {
    return double((arm.getCenterOfMassTransform() * vec(-0.5, 0, 0) - vec(0.5, 0, 0)).length());
  }
};

template <class J>
double gapOfSwing() {
  Swing<J> swing;
  double largest = 0;
  for (int i = 0; i < 180; ++i) {
    swing.world.step(dt);
    largest = std::max(largest, swing.gap());
  }
  return largest;
}

TEST(DerivedHinge, ASubclassThatOverridesGetInfo1AloneHolds) {
  const double plain = gapOfSwing<QuaternionHinge>();
  EXPECT_LT(plain, 0.02);
  EXPECT_NEAR(gapOfSwing<Announces>(), plain, onExactSolver() ? 0.02 : 1e-6);
  EXPECT_LT(gapOfSwing<AnnouncesAsBullet>(), 0.02);
}

// As many as it announced, whatever of ours acts beyond them, and whatever is called between.
TEST(DerivedHinge, NoMoreRowsAreWrittenThanAreAnnounced) {
  const auto touched = [](auto& pair, double high, double speed) {
    pair.hinge.setLimit(-1, scalar(high));
    pair.b->setAngularVelocity(vec(0, 0, speed));
    SolverRows rows = SolverRows::ofStep(pair.hinge);
    EXPECT_LE(rows.touched(), rows.announced());
    rows = SolverRows::ofStep(pair.hinge);
    EXPECT_LE(rows.touched(), rows.announced());
    return rows.announced();
  };
  for (const double high : {0.01, -0.01}) {
    Pair<Announces> alone;
    EXPECT_EQ(touched(alone, high, 6), 5);
    Pair<AnnouncesAsBullet> bullets;
    EXPECT_EQ(touched(bullets, high, 6), high > 0 ? 5 : 6);
    Pair<SetsFrames<QuaternionHinge>> busy;
    EXPECT_EQ(touched(busy, high, 6), 6);
  }
}

TEST(DerivedHinge, WhatClientsCallBetweenStepsChangesNothing) {
  Swing<QuaternionHinge> plain, bothered;
  for (int i = 0; i < 60; ++i) {
    plain.world.step(dt);
    bothered.world.step(dt);
    btHingeConstraint& stock = bothered.hinge;
    stock.buildJacobian();
    stock.setFrames(btTransform(stock.getAFrame()), btTransform(stock.getBFrame()));
    stock.testLimit(bothered.post.getWorldTransform(), bothered.arm.getWorldTransform());
    bothered.hinge.whyIgnored();
    stock.buildJacobian();
  }
  EXPECT_EQ(plain.arm.getCenterOfMassTransform(), bothered.arm.getCenterOfMassTransform());
  EXPECT_EQ(plain.arm.getAngularVelocity(), bothered.arm.getAngularVelocity());
}

TEST(DerivedHinge, EveryHingeIsOne) {
  Pair<pintle::DotHinge> dot;
  dot.stock().setLimit(scalar(0.1), 1);
  EXPECT_EQ(SolverRows::ofStep(dot.hinge).announced(), 6);
  Pair<pintle::TwoPointHinge> two;
  two.stock().enableAngularMotor(true, 1, 1);
  EXPECT_EQ(SolverRows::ofStep(two.hinge).announced(), 6);
}

}  // namespace
}  // namespace derived_hinge_test
