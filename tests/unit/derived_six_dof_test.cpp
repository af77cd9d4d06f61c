// Joints of six degrees of freedom of Pintle's are Bullet's: what clients do to one, through whatever pointer they hold it.
#include <LinearMath/btIDebugDraw.h>
#include <gtest/gtest.h>
#include <pintle/joints/generic_6dof_joint.h>
#include <pintle/joints/generic_6dof_spring_2_joint.h>
#include <pintle/joints/generic_6dof_spring_joint.h>
#include <pintle/joints/hinge_2_joint.h>

#include <functional>
#include <memory>
#include <vector>

#include "announcing_joints.h"
#include "solver_of_tests.h"
#include "support.h"

namespace derived_six_dof_test {
namespace {

using pintle::Generic6DofJoint;
using pintle::Generic6DofSpring2Joint;
using pintle::Generic6DofSpringJoint;
using pintle::Hinge2Joint;
using scenes::pi;
using support::infinite;
using support::is_double;
using support::nan_value;
using support::Random;
using support::scalar;
using support::SolverRows;
using support::vec;

constexpr double dt = 1. / 60;
// Bullet computes the same numbers.
constexpr double tolerance = is_double ? 1e-12 : 1e-5;

template <class J>
constexpr bool is_spring_2 = std::is_base_of_v<btGeneric6DofSpring2Constraint, J>;
template <class J>
using StockOf =
    std::conditional_t<is_spring_2<J>, btGeneric6DofSpring2Constraint, btGeneric6DofConstraint>;

// Two bodies, of which b is turned and moved a little out of the joint's frames.
template <class J>
struct Pair {
  std::unique_ptr<btRigidBody> a = support::body(1, vec(1, 2, 3), scenes::pose_at(vec(0, 0, 0)));
  std::unique_ptr<btRigidBody> b = support::body(2, vec(2, 1, 2), scenes::pose_at(vec(1, 0, 0)));
  J joint{*a, *b, scenes::pose_at(vec(0.5, 0, 0)), scenes::pose_at(vec(-0.5, 0, 0))};
  StockOf<J>& stock() { return joint; }
  void move(const btVector3& by, const btVector3& turn) {
    const btQuaternion q = btQuaternion(vec(1, 0, 0), turn.x()) *
                           btQuaternion(vec(0, 1, 0), turn.y()) *
                           btQuaternion(vec(0, 0, 1), turn.z());
    b->setCenterOfMassTransform(scenes::pose_at(vec(0.5, 0, 0)) * btTransform(q, by) *
                                scenes::pose_at(vec(0.5, 0, 0)));
  }
};

template <class J>
class DerivedSixDof : public testing::Test {};
using Types =
    testing::Types<Generic6DofJoint, Generic6DofSpringJoint, Generic6DofSpring2Joint, Hinge2Joint>;
TYPED_TEST_SUITE(DerivedSixDof, Types);

TYPED_TEST(DerivedSixDof, IsOneOfBulletsAtTheSameAddress) {
  Pair<TypeParam> pair;
  btTypedConstraint* const constraint = &pair.joint;
  constexpr bool has_springs = std::is_base_of_v<btGeneric6DofSpringConstraint, TypeParam>;
  EXPECT_EQ(constraint->getConstraintType(), is_spring_2<TypeParam> ? D6_SPRING_2_CONSTRAINT_TYPE
                                             : has_springs          ? D6_SPRING_CONSTRAINT_TYPE
                                                                    : D6_CONSTRAINT_TYPE);
  void* const handle = &pair.joint;
  EXPECT_EQ(static_cast<StockOf<TypeParam>*>(handle), &pair.stock());
  const btTransform* const frame = &pair.joint.getCalculatedTransformA();
  EXPECT_EQ(frame, &pair.stock().getCalculatedTransformA());
}

// Bullet's cached state, which clients and subclasses read.
template <class J>
std::vector<double> state(J& joint) {
  std::vector<double> all;
  const auto add = [&](const btVector3& v) { all.insert(all.end(), {v.x(), v.y(), v.z()}); };
  for (const btTransform* of :
       {&joint.getCalculatedTransformA(), &joint.getCalculatedTransformB()}) {
    add(of->getOrigin());
    for (int i = 0; i < 3; ++i) add(of->getBasis()[i]);
  }
  const auto& linear = *joint.getTranslationalLimitMotor();
  add(linear.m_currentLimitError);
  add(linear.m_currentLinearDiff);
  for (int i = 0; i < 3; ++i) {
    const auto& angular = *joint.getRotationalLimitMotor(i);
    add(joint.getAxis(i));
    all.insert(all.end(), {double(joint.getAngle(i)), double(joint.getRelativePivotPosition(i)),
                           double(linear.m_currentLimit[i]), double(angular.m_currentLimit),
                           double(angular.m_currentPosition)});
    if (angular.m_currentLimit != 0) all.push_back(double(angular.m_currentLimitError));
  }
  return all;
}

TYPED_TEST(DerivedSixDof, AStepLeavesInBulletsObjectWhatBulletsDoes) {
  Random random(5);
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const auto a = support::body(1, vec(1, 2, 3), random.pose(3)),
               b = support::body(2, vec(2, 1, 2), random.pose(3));
    const btTransform frame_a = random.pose(1), frame_b = random.pose(1);
    TypeParam ours(*a, *b, frame_a, frame_b);
    std::unique_ptr<StockOf<TypeParam>> stock;
    if constexpr (is_spring_2<TypeParam>)
      stock = std::make_unique<btGeneric6DofSpring2Constraint>(*a, *b, frame_a, frame_b);
    else
      stock = std::make_unique<btGeneric6DofConstraint>(*a, *b, frame_a, frame_b, true);
    for (int axis = 0; axis < 6; ++axis) {
      const btScalar low = scalar(random.uniform(-2, 2)),
                     high = low + scalar(random.uniform(-1, 1));
      ours.setLimit(axis, low, axis % 3 == i % 4 ? low : high);
      stock->setLimit(axis, low, axis % 3 == i % 4 ? low : high);
    }
    if constexpr (is_spring_2<TypeParam>) {
      ours.setRotationOrder(RotateOrder(i % 6));
      stock->setRotationOrder(RotateOrder(i % 6));
    }
    SolverRows::ofStep(ours);
    SolverRows::ofStep(*stock);
    const auto got = state(ours), expected = state(*stock);
    ASSERT_EQ(got.size(), expected.size());
    for (size_t k = 0; k < got.size(); ++k) EXPECT_NEAR(got[k], expected[k], tolerance) << k;
  }
}

// Calls of clients between steps tell where the bodies are now.
TYPED_TEST(DerivedSixDof, CalculateTransformsLooksAtTheBodies) {
  Pair<TypeParam> pair;
  SolverRows::ofStep(pair.joint);
  pair.move(vec(0.1, 0.2, 0.3), vec(0.1, -0.2, 0.3));
  StockOf<TypeParam>& stock = pair.joint;
  stock.calculateTransforms();
  stock.buildJacobian();
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(double(stock.getRelativePivotPosition(i)), 0.1 * (i + 1), tolerance);
  const double angles[] = {-0.1, 0.2, -0.3};  // of a against b, but for the order
  EXPECT_NEAR(double(stock.getAngle(1)), angles[1], 0.05);
  EXPECT_FALSE(std::isnan(double(stock.getAxis(2).x())));
}

template <class J>
using Change = std::function<void(StockOf<J>&)>;

// Settings that any pointer writes, by setters or in the fields of limit motors.
template <class J>
std::vector<Change<J>> changes() {
  const btTransform frame(btQuaternion(vec(0, 1, 0), scalar(0.2)), vec(0.3, 0.1, 0));
  std::vector<Change<J>> all = {
      [](auto& s) { s.setLinearLowerLimit(vec(0.09, 0, 0)); },
      [](auto& s) { s.setLinearUpperLimit(vec(0, 0.15, 0.35)); },
      [](auto& s) { s.setAngularLowerLimit(vec(-0.2, 0, -0.05)); },
      [](auto& s) { s.setAngularUpperLimit(vec(0, 0.1, 0.2)); },
      [](auto& s) { s.setLimit(0, 0, -1); },
      [](auto& s) { s.setLimit(2, scalar(0.1), scalar(0.1)); },
      [](auto& s) { s.setLimit(3, 1, -1); },
      [](auto& s) { s.setLimit(4, scalar(0.1), scalar(0.1)); },
      [](auto& s) { s.setLimit(5, scalar(-pi), scalar(pi)); },
      [](auto& s) { s.getRotationalLimitMotor(0)->m_loLimit = scalar(-0.01); },
      [](auto& s) { s.getRotationalLimitMotor(1)->m_hiLimit = scalar(0.05); },
      [](auto& s) { s.getRotationalLimitMotor(1)->m_bounce = 1; },
      [](auto& s) { s.getTranslationalLimitMotor()->m_upperLimit[1] = scalar(0.05); },
      [](auto& s) { s.getTranslationalLimitMotor()->m_lowerLimit.m_floats[1] = scalar(0.1); },
      [](auto& s) { s.getTranslationalLimitMotor()->m_upperLimit.setX(scalar(0.02)); },
      [](auto& s) {
        auto& motor = *s.getRotationalLimitMotor(1);
        motor.m_enableMotor = true;
        motor.m_targetVelocity = 2;
        motor.m_maxMotorForce = 3;
      },
      [](auto& s) {
        auto& motor = *s.getTranslationalLimitMotor();
        motor.m_enableMotor[2] = true;
        motor.m_targetVelocity[2] = 2;
        motor.m_maxMotorForce[2] = 3;
      },
      [](auto& s) { s.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.7), 0); },
      [](auto& s) { s.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.7), 4); },
      [](auto& s) { s.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.1), 1); },
      [](auto& s) { s.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.1), 5); },
      [=](auto& s) { s.setFrames(frame, frame); },
      [=](auto& s) { s.getFrameOffsetA() = frame; },
      [](auto& s) { s.setAxis(vec(0, 1, 0), vec(1, 0, 0)); },
  };
  return all;
}

TYPED_TEST(DerivedSixDof, WhatAnyPointerWritesHoldsInTheNextStep) {
  const auto all = changes<TypeParam>();
  for (size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE(i);
    const auto make = [] {
      auto pair = std::make_unique<Pair<TypeParam>>();
      for (int axis = 0; axis < 6; ++axis)
        pair->stock().setLimit(axis, scalar(-0.08), scalar(0.08));
      pair->move(vec(0.1, 0.2, 0.3), vec(0.1, -0.2, 0.3));
      pair->b->setLinearVelocity(vec(5, 4, 3));
      pair->b->setAngularVelocity(vec(-5, -4, -3));
      return pair;
    };
    const auto before = make(), changed = make(), twin = make();
    SolverRows::ofStep(before->joint);
    SolverRows::ofStep(twin->joint);
    all[i](before->stock());
    all[i](changed->stock());
    SolverRows::ofStep(changed->joint);
    const SolverRows rows = SolverRows::ofStep(before->joint);
    EXPECT_NE(rows, SolverRows::ofStep(twin->joint));
    // (A joint that has not been there before starts apart.)
    const bool is_locked = i == 5 || i == 7;
    if (!is_locked) {
      EXPECT_EQ(rows, SolverRows::ofStep(changed->joint));
    }
    EXPECT_TRUE(rows.finite());
  }
}

TYPED_TEST(DerivedSixDof, FreeIsWrittenInManyWays) {
  for (const auto& [low, high] : {std::pair(1., -1.), {0., -1.}, {-pi, pi}, {-3.14159, 3.14159}}) {
    Pair<TypeParam> pair;
    StockOf<TypeParam>& stock = pair.joint;
    for (int i = 0; i < 3; ++i) stock.setLimit(i, 0, 0);
    stock.setLimit(3, 0, 0);
    stock.setLimit(4, scalar(low), scalar(high));
    stock.setLimit(5, 0, 0);
    EXPECT_EQ(SolverRows::ofStep(pair.joint).announced(), 5) << low;
    pair.move(vec(0, 0, 0), vec(0, 3.1, 0));
    EXPECT_EQ(SolverRows::ofStep(pair.joint).announced(), 5) << low;
  }
}

// --- numbers that are none ------------------------------------------------------------------------

TYPED_TEST(DerivedSixDof, ANumberThatIsNotFiniteIsNotUsed) {
  Pair<TypeParam> pair, twin;
  StockOf<TypeParam>& stock = pair.joint;
  for (StockOf<TypeParam>* s : {&stock, &twin.stock()}) {
    for (int axis = 0; axis < 6; ++axis) s->setLimit(axis, scalar(-0.1), scalar(0.1));
    s->getRotationalLimitMotor(0)->m_enableMotor = true;
    s->getRotationalLimitMotor(0)->m_targetVelocity = 1;
  }
  pair.move(vec(0.2, 0.2, 0.2), vec(0.2, -0.2, 0.2));
  twin.move(vec(0.2, 0.2, 0.2), vec(0.2, -0.2, 0.2));
  SolverRows::ofStep(pair.joint);
  EXPECT_EQ(pair.joint.whyIgnored(), "");
  stock.getRotationalLimitMotor(0)->m_targetVelocity = nan_value;
  stock.getRotationalLimitMotor(1)->m_hiLimit = nan_value;
  stock.getTranslationalLimitMotor()->m_lowerLimit[2] = nan_value;
  stock.setParam(BT_CONSTRAINT_STOP_ERP, nan_value, 0);
  EXPECT_TRUE(std::isnan(double(stock.getRotationalLimitMotor(1)->m_hiLimit)));
  const std::string why = pair.joint.whyIgnored();
  for (const char* field : {"angular x motor target velocity", "angular y limit", "linear z limit",
                            "linear x STOP_ERP"})
    EXPECT_NE(why.find(field), std::string::npos) << why;
  SolverRows::ofStep(twin.joint);
  EXPECT_EQ(SolverRows::ofStep(pair.joint), SolverRows::ofStep(twin.joint));
}

TYPED_TEST(DerivedSixDof, HoldsNothingBeforeItHasFrames) {
  Pair<TypeParam> pair;
  pair.joint.setFrames(scenes::pose_at(vec(0, nan_value, 0)), btTransform::getIdentity());
  TypeParam joint(*pair.a, *pair.b, scenes::pose_at(vec(0, nan_value, 0)),
                  btTransform::getIdentity());
  EXPECT_EQ(SolverRows::ofStep(joint).announced(), 0);
  EXPECT_NE(joint.whyIgnored().find("joint frames"), std::string::npos);
  joint.setFrames(btTransform::getIdentity(), btTransform::getIdentity());
  EXPECT_GT(SolverRows::ofStep(joint).announced(), 0);
  joint.getFrameOffsetA().setBasis(btMatrix3x3(1, 0, 0, 0, 1, 0, 0, 0, -1));  // a mirror image
  EXPECT_TRUE(SolverRows::ofStep(joint).finite());
  EXPECT_EQ(joint.whyIgnored().find("joint frames"), std::string::npos);
}

// --- clients' own classes -------------------------------------------------------------------------

// As a viewer of characters does, which scales a model.
class Scaled : public Generic6DofSpring2Joint {
 public:
  using Generic6DofSpring2Joint::Generic6DofSpring2Joint;
  void scale(btScalar by) {
    m_linearLimits.m_lowerLimit *= by;
    m_linearLimits.m_upperLimit *= by;
    m_linearLimits.m_equilibriumPoint *= by;
    m_frameInA.getOrigin() *= by;
    m_frameInB.getOrigin() *= by;
    m_angularLimits[1].m_hiLimit *= by;
  }
};

TEST(DerivedSixDofSubclass, ScalesProtectedMembersInPlace) {
  Pair<Scaled> pair;
  for (int i = 0; i < 6; ++i) pair.joint.setLimit(i, scalar(-0.1), scalar(0.1));
  pair.move(vec(0.15, 0, 0), vec(0, -0.15, 0));
  const auto holds = [&] { return SolverRows::ofStep(pair.joint).announced(); };
  const int before = holds();
  EXPECT_GT(before, 0);
  pair.joint.scale(2);
  pair.b->setCenterOfMassTransform(pair.a->getCenterOfMassTransform() *
                                   pair.joint.getFrameOffsetA() *
                                   pair.joint.getFrameOffsetB().inverse());
  EXPECT_EQ(holds(), 0);
}

TEST(DerivedSixDofSubclass, AnnouncesAsBulletAndIsHeldByWhatItAnnounced) {
  using J = support::AnnouncesAsBullet<Generic6DofJoint, btGeneric6DofConstraint>;
  Pair<J> pair;
  for (int i = 0; i < 6; ++i) pair.joint.setLimit(i, 0, 0);
  pair.move(vec(0.1, 0.2, 0.3), vec(0.1, -0.2, 0.3));
  const SolverRows rows = SolverRows::ofStep(pair.joint);
  EXPECT_EQ(rows.announced(), 6);
  EXPECT_EQ(rows.touched(), 6);
}

// --- drawing ----------------------------------------------------------------------------------------

class Lines : public btIDebugDraw {
 public:
  int count = 0;
  void drawLine(const btVector3&, const btVector3&, const btVector3&) override { ++count; }
  void drawContactPoint(const btVector3&, const btVector3&, btScalar, int,
                        const btVector3&) override {}
  void reportErrorWarning(const char*) override {}
  void draw3dText(const btVector3&, const char*) override {}
  void setDebugMode(int) override {}
  int getDebugMode() const override { return DBG_DrawConstraints | DBG_DrawConstraintLimits; }
};

TYPED_TEST(DerivedSixDof, IsDrawnByBulletAndByItself) {
  scenes::World world;
  btRigidBody &a = world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0))),
              &b = world.add_box(1, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 1)));
  auto& joint = world.add_joint<TypeParam>(a, b, scenes::pose_at(vec(0, 0, 0.5)),
                                           scenes::pose_at(vec(0, 0, -0.5)));
  joint.setLimit(4, scalar(-0.5), scalar(0.5));
  Lines bullets, own;
  world.bullet().setDebugDrawer(&bullets);
  world.bullet().debugDrawWorld();
  world.bullet().setDebugDrawer(nullptr);
  EXPECT_GT(bullets.count, 6);
  joint.drawJoint(own);
  EXPECT_GT(own.count, 6);
}

}  // namespace
}  // namespace derived_six_dof_test
