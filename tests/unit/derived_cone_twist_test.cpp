// A cone-twist joint of Pintle's is one of Bullet's: what clients do to one, through whatever pointer they hold it.
#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <gtest/gtest.h>
#include <pintle/joints/cone_twist_joint.h>

#include <functional>
#include <memory>

#include "announcing_joints.h"
#include "drawing.h"
#include "solver_of_tests.h"
#include "support.h"

namespace derived_cone_twist_test {
namespace {

using pintle::ConeTwistJoint;
using scenes::pi;
using support::is_double;
using support::nan_value;
using support::Random;
using support::scalar;
using support::SolverRows;
using support::vec;

constexpr double dt = 1. / 60;
// Bullet takes its angles by an arc cosine, which keeps half of the digits.
constexpr double half_digits = is_double ? 1e-7 : 2e-3;

// A swing of this angle about (0, cos, sin) of the direction, after a twist.
btQuaternion rotation(double swing, double direction, double twist) {
  return btQuaternion(vec(0, std::cos(direction), std::sin(direction)), scalar(swing)) *
         btQuaternion(vec(1, 0, 0), scalar(twist));
}

// Two bodies whose pivots coincide, and a cone-twist joint about x between them.
template <class J = ConeTwistJoint>
struct Pair {
  std::unique_ptr<btRigidBody> a = support::body(1, vec(1, 2, 3), scenes::pose_at(vec(1, 0, 0)));
  std::unique_ptr<btRigidBody> b = support::body(2, vec(2, 1, 2), scenes::pose_at(vec(0, 0, 0)));
  J joint{*a, *b, scenes::pose_at(vec(-0.5, 0, 0)), scenes::pose_at(vec(0.5, 0, 0))};
  btConeTwistConstraint& stock() { return joint; }
  // a against b.
  void turn(const btQuaternion& q) {
    a->setCenterOfMassTransform(scenes::pose_at(vec(0.5, 0, 0)) * btTransform(q) *
                                scenes::pose_at(vec(0.5, 0, 0)));
  }
};

TEST(DerivedConeTwist, IsAConeTwistOfBulletsAtTheSameAddress) {
  Pair<> pair;
  btTypedConstraint* const constraint = &pair.joint;
  EXPECT_EQ(constraint->getConstraintType(), CONETWIST_CONSTRAINT_TYPE);
  void* const handle = &pair.joint;
  EXPECT_EQ(static_cast<btConeTwistConstraint*>(handle), &pair.stock());
  const btTransform* const frame = &pair.joint.getFrameOffsetA();
  EXPECT_EQ(frame, &pair.stock().getFrameOffsetA());
  EXPECT_EQ(&pair.joint.constraint(), constraint);
}

// As an engine does, which makes a joint of its own of the type, and calls what is protected.
class Engines : public ConeTwistJoint {
 public:
  using ConeTwistJoint::ConeTwistJoint;
  btScalar sizeOf(const btQuaternion& twist) {
    btScalar angle;
    btVector3 axis;
    computeTwistLimitInfo(twist, angle, axis);
    return angle * m_rbA.getInvMass();
  }
};

TEST(DerivedConeTwist, AnEnginesLimbStopsAtItsLimits) {
  scenes::World world;
  btRigidBody& body = world.add_box(0, vec(0.2, 0.2, 0.2), scenes::pose_at(vec(0, 0, 0)));
  btRigidBody& limb = world.add_box(1, vec(0.3, 0.1, 0.1), scenes::pose_at(vec(0.5, 0, 0)));
  limb.setDamping(scalar(0.5), scalar(0.9));
  btTypedConstraint& constraint = world.add_joint<Engines>(
      limb, body, scenes::pose_at(vec(-0.3, 0, 0)), scenes::pose_at(vec(0.2, 0, 0)));
  ASSERT_EQ(constraint.getConstraintType(), CONETWIST_CONSTRAINT_TYPE);
  auto& stock = static_cast<btConeTwistConstraint&>(constraint);
  stock.setLimit(scalar(0.4), scalar(0.6), scalar(0.3));
  limb.setAngularVelocity(vec(5, 0, 0));
  for (int i = 0; i < 240; ++i) world.step(dt);
  const auto& joint = static_cast<const Engines&>(stock);
  EXPECT_NEAR(double(joint.getSwing2()), 0.6, 0.01);  // gravity turns it about y
  EXPECT_LT(double(stock.getTwistAngle()), 0.31);     // as it was cached in the step
  EXPECT_TRUE(stock.isPastSwingLimit());
  EXPECT_NEAR(double(static_cast<Engines&>(stock).sizeOf(rotation(0, 0, -0.5))), 0.5, half_digits);
}

TEST(DerivedConeTwist, WhatAnyPointerWritesHoldsInTheNextStep) {
  const btTransform frame(btQuaternion(vec(0, 1, 0), scalar(0.2)), vec(0.3, 0.1, 0));
  const std::function<void(btConeTwistConstraint&)> changes[] = {
      [](auto& c) { c.setLimit(scalar(0.1), scalar(0.2), scalar(0.2)); },
      [](auto& c) { c.setLimit(3, scalar(0.1)); },
      [](auto& c) { c.setLimit(4, scalar(0.1)); },
      [](auto& c) { c.setLimit(5, scalar(0.1)); },
      [](auto& c) { c.setLimit(scalar(0.2), scalar(0.2), scalar(0.2), scalar(0.5)); },
      [](auto& c) { c.setLimit(scalar(0.2), scalar(0.2), scalar(0.2), 1, scalar(0.6)); },
      [](auto& c) {
        c.setLimit(scalar(0.2), scalar(0.2), scalar(0.2), 1, scalar(0.3), scalar(0.7));
      },
      [](auto& c) { c.setFixThresh(scalar(0.3)); },
      [](auto& c) { c.setAngularOnly(true); },
      [](auto& c) {
        c.setMotorTarget(rotation(0.1, 1, 0.1));
        c.enableMotor(true);
      },
      [](auto& c) {
        c.setMotorTarget(btQuaternion::getIdentity());
        c.setMaxMotorImpulse(scalar(0.25));
        c.enableMotor(true);
      },
      [](auto& c) {
        c.setMotorTargetInConstraintSpace(rotation(0.1, 2, 0.1));
        c.setMaxMotorImpulseNormalized(scalar(0.25));
        c.enableMotor(true);
      },
      [](auto& c) { c.setParam(BT_CONSTRAINT_ERP, scalar(0.7), 0); },
      [](auto& c) { c.setParam(BT_CONSTRAINT_CFM, scalar(0.1), 1); },
      [](auto& c) { c.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.7)); },
      [](auto& c) { c.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.1), 3); },
      [&](auto& c) { c.setFrames(frame, frame); },
  };
  for (size_t i = 0; i < std::size(changes); ++i) {
    SCOPED_TRACE(i);
    const auto make = [] {
      auto pair = std::make_unique<Pair<>>();
      pair->stock().setLimit(scalar(0.2), scalar(0.2), scalar(0.2));
      pair->turn(rotation(0.5, 1, 0.4));
      pair->a->translate(vec(0.01, 0.02, 0.03));
      return pair;
    };
    const auto before = make(), changed = make(), twin = make();
    SolverRows::ofStep(before->joint);
    SolverRows::ofStep(twin->joint);
    changes[i](before->stock());
    changes[i](changed->stock());
    SolverRows::ofStep(changed->joint);
    const SolverRows rows = SolverRows::ofStep(before->joint);
    EXPECT_NE(rows, SolverRows::ofStep(twin->joint));
    EXPECT_EQ(rows, SolverRows::ofStep(changed->joint));
    EXPECT_TRUE(rows.finite());
    EXPECT_EQ(before->joint.whyIgnored(), "");
  }
}

// Without an effect in Bullet it has none here.
TEST(DerivedConeTwist, ADampingChangesNothing) {
  Pair<> pair, twin;
  pair.turn(rotation(0.5, 1, 0.4));
  twin.turn(rotation(0.5, 1, 0.4));
  pair.stock().setDamping(nan_value);
  EXPECT_EQ(SolverRows::ofStep(pair.joint), SolverRows::ofStep(twin.joint));
  EXPECT_EQ(pair.joint.whyIgnored(), "");
}

TEST(DerivedConeTwist, WhatBulletsGettersReturnAfterAStepIsBullets) {
  Random random(4);
  int past_swing = 0, past_twist = 0;
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE(i);
    Pair<> ours;
    Pair<btConeTwistConstraint> stock;
    const auto span = [&] { return i % 5 == 0 ? 0. : random.uniform(0.06, pi); };
    const double span_1 = span(), span_2 = span(), twist_span = random.uniform(-0.3, pi),
                 softness = random.uniform(0.7, 1);
    const double direction = random.uniform(-pi, pi), swing = random.uniform(0, 2.5),
                 twist = random.uniform(-pi, pi);
    ours.turn(rotation(swing, direction, twist));
    stock.turn(rotation(swing, direction, twist));
    for (btConeTwistConstraint* c : {&ours.stock(), &stock.joint})
      c->setLimit(scalar(span_1), scalar(span_2), scalar(twist_span), scalar(softness));
    SolverRows::ofStep(ours.joint);
    SolverRows::ofStep(stock.joint);
    EXPECT_NEAR(double(ours.stock().getTwistAngle()), double(stock.joint.getTwistAngle()),
                half_digits / std::cos(swing / 2));
    EXPECT_EQ(ours.stock().getTwistLimitSign(), stock.joint.getTwistLimitSign());
    const double radius =
        softness * 1 / std::hypot(std::cos(direction) / span_2, std::sin(direction) / span_1);
    if (std::abs(swing - radius) > 1e-2) {
      EXPECT_EQ(ours.stock().isPastSwingLimit(), stock.joint.isPastSwingLimit());
    }
    if (std::abs(std::abs(twist) - softness * twist_span) > 1e-2) {
      EXPECT_EQ(ours.stock().getSolveTwistLimit(), stock.joint.getSolveTwistLimit());
    }
    past_swing += stock.joint.isPastSwingLimit();
    past_twist += stock.joint.getSolveTwistLimit() != 0;
  }
  EXPECT_GT(past_swing, 500);
  EXPECT_LT(past_swing, 1800);
  EXPECT_GT(past_twist, 500);
  EXPECT_LT(past_twist, 1500);
}

// Bullet leaves what was never set as the memory was.
TEST(DerivedConeTwist, WhatIsNotSetIsReadAsItIsBeforeAStep) {
  alignas(ConeTwistJoint) unsigned char memory[sizeof(ConeTwistJoint)];
  Pair<> pair;
  pair.turn(rotation(0.3, 1, -0.4));
  std::memset(memory, 0xa5, sizeof memory);
  auto* const joint = new (static_cast<void*>(memory))
      ConeTwistJoint(*pair.a, *pair.b, pair.joint.getFrameOffsetA(), pair.joint.getFrameOffsetB());
  const btConeTwistConstraint& stock = *joint;
  EXPECT_NEAR(double(stock.getTwistAngle()), 0.4, half_digits);
  EXPECT_FALSE(stock.isMotorEnabled());
  EXPECT_FALSE(stock.isMaxMotorImpulseNormalized());
  EXPECT_EQ(stock.getMotorTarget().w(), 1);
  EXPECT_EQ(joint->btConeTwistConstraint::getTwistLimitSign(), 0);
  joint->btConeTwistConstraint::enableMotor(true);
  EXPECT_TRUE(SolverRows::ofStep(*joint).finite());
  EXPECT_EQ(joint->whyIgnored(), "");
  joint->~ConeTwistJoint();
}

TEST(DerivedConeTwist, TheLimitThatWasWrittenLastHolds) {
  Pair<> pair;
  pair.turn(rotation(0.3, -pi / 2, 0.3));  // swing 1 = -0.3
  const auto rows = [&] { return SolverRows::ofStep(pair.joint).announced(); };
  pair.joint.setSwingLimits(scalar(-0.2), 1, scalar(-0.5), scalar(0.5));
  pair.joint.setTwistLimit(scalar(-1), scalar(0.1));
  EXPECT_EQ(rows(), 5);
  EXPECT_EQ(pair.stock().getSwingSpan1(), 1);  // the larger side
  EXPECT_EQ(pair.stock().getSwingSpan2(), scalar(0.5));
  EXPECT_EQ(pair.stock().getTwistSpan(), 1);
  // One of the spans by Bullet's: the others are Pintle's.
  pair.stock().setLimit(3, 2);
  EXPECT_EQ(rows(), 4);
  pair.stock().setLimit(5, 2);
  EXPECT_EQ(rows(), 3);
  pair.joint.setTwistLimit(scalar(-1), scalar(0.1));
  EXPECT_EQ(rows(), 4);
  // The span that stands there, by Pintle's type.
  pair.joint.setLimit(3, 1);
  EXPECT_EQ(rows(), 3);
  pair.joint.setSwingLimits(scalar(-0.2), 1, scalar(-0.5), scalar(0.5));
  EXPECT_EQ(rows(), 4);
  pair.joint.setLimit(1, scalar(0.5), 1);
  EXPECT_EQ(rows(), 3);
  // Free ones are free in Bullet's, too.
  pair.joint.setTwistLimit(-1, -2);
  EXPECT_LT(pair.stock().getTwistSpan(), 0);
}

TEST(DerivedConeTwist, TheDriveThatWasWrittenLastActs) {
  Pair<> pair;
  btConeTwistConstraint& stock = pair.joint;
  stock.setMotorTarget(rotation(0.2, 1, 0.1));
  stock.setMaxMotorImpulse(3);
  stock.enableMotor(true);
  const SolverRows motor = SolverRows::ofStep(pair.joint);
  EXPECT_EQ(motor.announced(), 6);
  pair.joint.setMotorVelocity(vec(1, 2, 3));
  const SolverRows velocity = SolverRows::ofStep(pair.joint);
  EXPECT_NE(velocity, motor);
  stock.enableMotor(false);
  EXPECT_EQ(SolverRows::ofStep(pair.joint).announced(), 3);
  stock.enableMotor(true);
  EXPECT_EQ(SolverRows::ofStep(pair.joint), velocity);
  stock.setMotorTarget(btQuaternion::getIdentity());
  SolverRows::ofStep(pair.joint);
  stock.setMotorTarget(rotation(0.2, 1, 0.1));
  EXPECT_EQ(SolverRows::ofStep(pair.joint), motor);
  // The same target again, by Pintle's type.
  pair.joint.setMotorTarget(rotation(0.2, 1, 0.1));
  pair.joint.setMotorVelocity(vec(1, 2, 3));
  EXPECT_EQ(SolverRows::ofStep(pair.joint), velocity);
  pair.joint.setMotorTarget(rotation(0.2, 1, 0.1));
  EXPECT_NE(SolverRows::ofStep(pair.joint), velocity);
}

TEST(DerivedConeTwist, ALimbIsDrivenByBulletsPointer) {
  for (const bool normalized : {false, true}) {
    scenes::World world(0);
    btRigidBody& body = world.add_box(0, vec(0.2, 0.2, 0.2), scenes::pose_at(vec(0, 0, 0)));
    btRigidBody& limb = world.add_box(1, vec(0.3, 0.1, 0.1), scenes::pose_at(vec(0.5, 0, 0)));
    auto& joint = world.add_joint<ConeTwistJoint>(limb, body, scenes::pose_at(vec(-0.3, 0, 0)),
                                                  scenes::pose_at(vec(0.2, 0, 0)));
    btConeTwistConstraint& stock = joint;
    stock.setLimit(1, 1, 1);
    stock.setMotorTarget(rotation(0.6, 0, 0.5));
    normalized ? stock.setMaxMotorImpulseNormalized(10) : stock.setMaxMotorImpulse(10);
    stock.enableMotor(true);
    for (int i = 0; i < 60; ++i) world.step(dt);
    EXPECT_NEAR(double(joint.getSwing2()), 0.6, 0.01);
    EXPECT_NEAR(double(joint.getTwist()), 0.5, 0.01);
    EXPECT_GT(double(joint.getMotorImpulse().length()), 0);
  }
}

TEST(DerivedConeTwist, HoldsNothingBeforeItHasFrames) {
  Pair<> pair;
  ConeTwistJoint joint(*pair.a, *pair.b, scenes::pose_at(vec(0, nan_value, 0)),
                       btTransform::getIdentity());
  EXPECT_EQ(SolverRows::ofStep(joint).announced(), 0);
  EXPECT_NE(joint.whyIgnored().find("joint frames"), std::string::npos);
  joint.setFrames(btTransform::getIdentity(), btTransform::getIdentity());
  EXPECT_EQ(SolverRows::ofStep(joint).announced(), 3);
  // A mirror image: the axis stays.
  joint.getFrameOffsetA().setBasis(btMatrix3x3(1, 0, 0, 0, 1, 0, 0, 0, -1));
  joint.setLimit(0, 0, 0);
  EXPECT_TRUE(SolverRows::ofStep(joint).finite());
  EXPECT_EQ(joint.whyIgnored(), "");
  for (const btScalar value : {nan_value, support::infinite}) {
    joint.getFrameOffsetB().getBasis()[1][2] = value;
    EXPECT_TRUE(SolverRows::ofStep(joint).finite());
    EXPECT_NE(joint.whyIgnored(), "");
  }
}

using Announces = support::Announces<ConeTwistJoint, 3>;
using AnnouncesAsBullet = support::AnnouncesAsBullet<ConeTwistJoint, btConeTwistConstraint>;

template <class J>
double gapOfASwing(double span, double& farthest) {
  scenes::World world;
  btRigidBody& body = world.add_box(0, vec(0.2, 0.2, 0.2), scenes::pose_at(vec(0, 0, 0)));
  btRigidBody& limb = world.add_box(1, vec(0.3, 0.1, 0.1), scenes::pose_at(vec(0.5, 0, 0)));
  auto& joint = world.add_joint<J>(limb, body, scenes::pose_at(vec(-0.3, 0, 0)),
                                   scenes::pose_at(vec(0.2, 0, 0)));
  joint.setLimit(scalar(span), scalar(span), scalar(span));
  double gap = 0;
  for (int i = 0; i < 120; ++i) {
    world.step(dt);
    gap = std::max(gap,
                   double((joint.getCalculatedTransformA().getOrigin() - vec(0.2, 0, 0)).length()));
    // Whoever looks between steps makes no row of it.
    joint.isPastSwingLimit();
    joint.calcAngleInfo2(limb.getWorldTransform(), body.getWorldTransform(),
                         limb.getInvInertiaTensorWorld(), limb.getInvInertiaTensorWorld());
    farthest = std::max(farthest, std::hypot(double(joint.getSwing1()), double(joint.getSwing2())));
  }
  return gap;
}

TEST(DerivedConeTwist, ASubclassThatOverridesGetInfo1AloneStillHolds) {
  double own = 0, of_bullets = 0;
  EXPECT_LT(gapOfASwing<Announces>(0.5, own), 0.02);
  EXPECT_GT(own, 1);  // there is no row for the limit
  EXPECT_LT(gapOfASwing<AnnouncesAsBullet>(0.5, of_bullets), 0.02);
  EXPECT_LT(of_bullets, 0.7);
}

TEST(DerivedConeTwist, BulletDrawsItWithoutAFurtherLine) {
  const auto drawn = [](auto* type, btScalar size) {
    using J = std::remove_pointer_t<decltype(type)>;
    scenes::World world(0);
    btRigidBody& a = world.add_box(1, vec(0.3, 0.1, 0.1), scenes::pose_at(vec(1, 0, 0)));
    btRigidBody& b = world.add_box(1, vec(0.2, 0.2, 0.2), scenes::pose_at(vec(0, 0, 0)));
    auto& joint =
        world.add_joint<J>(a, b, scenes::pose_at(vec(-0.5, 0, 0)), scenes::pose_at(vec(0.5, 0, 0)));
    btTypedConstraint& constraint = joint;
    constraint.setDbgDrawSize(size);
    joint.setLimit(scalar(0.5), scalar(0.7), scalar(0.3));
    world.step(dt);
    drawing::Recorder recorder;
    world.bullet().setDebugDrawer(&recorder);
    world.bullet().debugDrawWorld();
    return recorder.lines;
  };
  constexpr ConeTwistJoint* ours = nullptr;
  constexpr btConeTwistConstraint* bullets = nullptr;
  for (const double size : {0., 0.7}) {
    const auto got = drawn(ours, scalar(size)), expected = drawn(bullets, scalar(size));
    EXPECT_EQ(got.size() > 0, size > 0);
    ASSERT_EQ(got.size(), expected.size());
    for (size_t i = 0; i < got.size(); ++i)
      EXPECT_LT((got[i].from - expected[i].from).length(), 1e-3) << i;
  }
}

TEST(DerivedConeTwist, WhatClientsCallBetweenStepsChangesNothing) {
  const auto run = [](bool bother) {
    scenes::World world;
    btRigidBody& body = world.add_box(0, vec(0.2, 0.2, 0.2), scenes::pose_at(vec(0, 0, 0)));
    btRigidBody& limb = world.add_box(1, vec(0.3, 0.1, 0.1), scenes::pose_at(vec(0.5, 0, 0)));
    auto& joint = world.add_joint<ConeTwistJoint>(limb, body, scenes::pose_at(vec(-0.3, 0, 0)),
                                                  scenes::pose_at(vec(0.2, 0, 0)));
    joint.setLimit(scalar(0.5), scalar(0.3), scalar(0.2));
    limb.setAngularVelocity(vec(5, 2, 1));
    for (int i = 0; i < 90; ++i) {
      world.step(dt);
      if (!bother) continue;
      btConeTwistConstraint& stock = joint;
      const btMatrix3x3& I = limb.getInvInertiaTensorWorld();
      stock.buildJacobian();
      stock.calcAngleInfo2(body.getWorldTransform(), limb.getWorldTransform(), I, I);
      stock.setFrames(btTransform(stock.getAFrame()), btTransform(stock.getBFrame()));
      joint.calcAngleInfo2(body.getWorldTransform(), limb.getWorldTransform(), I, I);
      joint.getTwistAngle();
      joint.isPastSwingLimit();
      joint.whyIgnored();
    }
    return limb.getCenterOfMassTransform();
  };
  EXPECT_EQ(run(false), run(true));
}

}  // namespace
}  // namespace derived_cone_twist_test
