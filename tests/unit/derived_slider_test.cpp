// A slider of Pintle's is one of Bullet's: what clients do to one, through whatever pointer they hold it.
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <gtest/gtest.h>
#include <pintle/joints/slider_joint.h>

#include <functional>
#include <memory>
#include <vector>

#include "announcing_joints.h"
#include "solver_of_tests.h"
#include "support.h"

namespace derived_slider_test {
namespace {

using pintle::SliderJoint;
using scenes::pi;
using support::infinite;
using support::is_double;
using support::nan_value;
using support::Random;
using support::scalar;
using support::SolverRows;
using support::vec;

constexpr double dt = 1. / 60;
// Bullet computes the same numbers in another order.
constexpr double tolerance = is_double ? 2e-11 : 2e-5;

// Two bodies whose joint frames coincide, and a slider along x between them.
template <class J = SliderJoint>
struct Pair {
  std::unique_ptr<btRigidBody> a = support::body(1, vec(1, 2, 3), scenes::pose_at(vec(0, 0, 0)));
  std::unique_ptr<btRigidBody> b = support::body(2, vec(2, 1, 2), scenes::pose_at(vec(1, 0, 0)));
  J slider{*a, *b, scenes::pose_at(vec(0.5, 0, 0)), scenes::pose_at(vec(-0.5, 0, 0)), true};
  btSliderConstraint& stock() { return slider; }
  // b along the axis, and about it.
  void move(double along, double angle) {
    b->setCenterOfMassTransform(
        btTransform(btQuaternion(vec(1, 0, 0), scalar(angle)), vec(1 + along, 0, 0)));
  }
};

TEST(DerivedSlider, IsASliderOfBulletsAtTheSameAddress) {
  Pair<> pair;
  btTypedConstraint* const constraint = &pair.slider;
  EXPECT_EQ(constraint->getConstraintType(), SLIDER_CONSTRAINT_TYPE);
  void* const handle = &pair.slider;
  EXPECT_EQ(static_cast<btSliderConstraint*>(handle), &pair.stock());
  const btTransform* const frame = &pair.slider.getCalculatedTransformA();
  EXPECT_EQ(frame, &pair.stock().getCalculatedTransformA());
}

// As an engine does, which makes a slider of its own of the type, and knows its fields.
class Engines : public SliderJoint {
 public:
  using SliderJoint::SliderJoint;
  void limit(btScalar low, btScalar high) {
    m_lowerLinLimit = low;
    m_upperLinLimit = high;
  }
};

TEST(DerivedSlider, AnEnginesSliderStopsAtItsLimits) {
  scenes::World world;
  btRigidBody& post = world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
  btRigidBody& load = world.add_box(1, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
  const btTransform along_g(btQuaternion(vec(0, 1, 0), scalar(pi / 2)));  // x is -z
  auto& by_field = world.add_joint<Engines>(post, load, along_g, along_g, true);
  by_field.limit(scalar(-0.5), scalar(0.5));
  btRigidBody& other = world.add_box(1, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(5, 0, 0)));
  btTypedConstraint& constraint = world.add_joint<SliderJoint>(
      post, other, btTransform(along_g.getBasis(), vec(5, 0, 0)), along_g, true);
  ASSERT_EQ(constraint.getConstraintType(), SLIDER_CONSTRAINT_TYPE);
  auto& stock = static_cast<btSliderConstraint&>(constraint);
  stock.setLowerLinLimit(scalar(-0.5));
  stock.setUpperLinLimit(scalar(0.5));
  for (int i = 0; i < 180; ++i) world.step(dt);
  for (btSliderConstraint* of : {static_cast<btSliderConstraint*>(&by_field), &stock}) {
    EXPECT_NEAR(double(of->getLinearPos()), 0.5, 0.01);  // as it was cached in the step
    EXPECT_NEAR(std::abs(double(of->getRigidBodyB().getCenterOfMassPosition().z())), 0.5, 0.01);
  }
}

TEST(DerivedSlider, WhatAnyPointerWritesHoldsInTheNextStep) {
  const btTransform frame(btQuaternion(vec(0, 1, 0), scalar(0.2)), vec(0.3, 0.1, 0));
  const std::function<void(btSliderConstraint&)> changes[] = {
      [](auto& s) { s.setUpperLinLimit(scalar(0.1)); },
      [](auto& s) { s.setLowerLinLimit(scalar(0.4)); },
      [](auto& s) { s.setUpperAngLimit(scalar(0.1)); },
      [](auto& s) {
        s.setLowerAngLimit(1);
        s.setUpperAngLimit(-1);
      },
      [](auto& s) {
        s.setPoweredLinMotor(true);
        s.setTargetLinMotorVelocity(2);
        s.setMaxLinMotorForce(3);
      },
      [](auto& s) {
        s.setPoweredAngMotor(true);
        s.setTargetAngMotorVelocity(2);
        s.setMaxAngMotorForce(3);
      },
      [](auto& s) { s.setSoftnessLimLin(scalar(0.5)); },
      [](auto& s) { s.setSoftnessLimAng(scalar(0.5)); },
      [](auto& s) { s.setSoftnessOrthoLin(scalar(0.5)); },
      [](auto& s) { s.setSoftnessOrthoAng(scalar(0.5)); },
      [](auto& s) { s.setDampingLimLin(scalar(0.1)); },
      [](auto& s) { s.setDampingLimAng(scalar(0.1)); },
      [](auto& s) { s.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.7), 0); },
      [](auto& s) { s.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.7), 1); },
      [](auto& s) { s.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.7), 3); },
      [](auto& s) { s.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.7), 4); },
      [](auto& s) { s.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.1), 0); },
      [](auto& s) { s.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.1), 1); },
      [](auto& s) { s.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.1), 3); },
      [](auto& s) { s.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.1), 4); },
      [](auto& s) { s.setUseFrameOffset(false); },
      [&](auto& s) { s.setFrames(frame, frame); },
      [&](auto& s) { s.getFrameOffsetA() = frame; },
  };
  for (size_t i = 0; i < std::size(changes); ++i) {
    SCOPED_TRACE(i);
    const auto make = [] {
      auto pair = std::make_unique<Pair<>>();
      pair->stock().setLowerLinLimit(scalar(-0.2));
      pair->stock().setUpperLinLimit(scalar(0.2));
      pair->stock().setLowerAngLimit(scalar(-0.2));
      pair->stock().setUpperAngLimit(scalar(0.2));
      pair->move(0.3, 0.3);
      pair->b->setLinearVelocity(vec(5, 0, 0));
      pair->b->setAngularVelocity(vec(5, 0, 0));
      pair->b->translate(vec(0, 0.02, 0.03));
      pair->b->setCenterOfMassTransform(pair->b->getCenterOfMassTransform() *
                                        btTransform(btQuaternion(vec(0, 0, 1), scalar(0.1))));
      return pair;
    };
    const auto before = make(), changed = make(), twin = make();
    SolverRows::ofStep(before->slider);
    SolverRows::ofStep(twin->slider);
    changes[i](before->stock());
    changes[i](changed->stock());
    SolverRows::ofStep(changed->slider);
    const SolverRows rows = SolverRows::ofStep(before->slider);
    EXPECT_NE(rows, SolverRows::ofStep(twin->slider));
    EXPECT_EQ(rows, SolverRows::ofStep(changed->slider));
    EXPECT_TRUE(rows.finite());
  }
}

// Where Bullet says that a limit is broken it has a row, and where it has none there is none.
TEST(DerivedSlider, LimitsThatBulletsSettersMadeActWhereBulletsDo) {
  Random random(3);
  for (int i = 0; i < 400; ++i) {
    SCOPED_TRACE(i);
    Pair<> ours;
    Pair<btSliderConstraint> stock;
    const double low = random.uniform(-1, 1), high = low + random.uniform(-0.5, 1),
                 lower = random.uniform(-7, 7), upper = lower + random.uniform(-1, 7),
                 along = random.uniform(-1.5, 1.5), angle = random.uniform(-pi, pi);
    ours.move(along, angle);
    stock.move(along, angle);
    for (btSliderConstraint* s : {&ours.stock(), &stock.slider}) {
      s->setLowerLinLimit(scalar(low));
      s->setUpperLinLimit(scalar(high));
      s->setLowerAngLimit(scalar(lower));
      s->setUpperAngLimit(scalar(upper));
    }
    const SolverRows rows = SolverRows::ofStep(ours.slider),
                     of_stock = SolverRows::ofStep(stock.slider);
    EXPECT_EQ(rows.announced(), of_stock.announced());
    EXPECT_EQ(ours.stock().getSolveLinLimit(), stock.slider.getSolveLinLimit());
    EXPECT_EQ(ours.stock().getSolveAngLimit(), stock.slider.getSolveAngLimit());
    EXPECT_EQ(ours.stock().getLinearPos(), stock.slider.getLinearPos());
    if (stock.slider.getLowerAngLimit() <=
        stock.slider.getUpperAngLimit()) {  // else it is not read
      EXPECT_EQ(ours.stock().getAngularPos(), stock.slider.getAngularPos());
    }
  }
}

TEST(DerivedSlider, TheLimitThatWasWrittenLastHolds) {
  Pair<> pair;
  pair.move(0, 1.5);
  const auto rows = [&] { return SolverRows::ofStep(pair.slider).announced(); };
  pair.slider.setLowerAngLimit(-10);
  pair.slider.setUpperAngLimit(10);
  EXPECT_EQ(rows(), 4);
  EXPECT_EQ(pair.slider.getLowerAngLimit(), -10);
  EXPECT_GT(pair.stock().getLowerAngLimit(), pair.stock().getUpperAngLimit());  // free there
  // One side by Bullet's: the other one is Pintle's.
  pair.stock().setUpperAngLimit(1);
  EXPECT_EQ(rows(), 5);
  EXPECT_EQ(pair.slider.getLowerAngLimit(), -10);
  EXPECT_EQ(pair.slider.getUpperAngLimit(), 1);
  pair.slider.setUpperAngLimit(10);
  EXPECT_EQ(rows(), 4);
  pair.stock().setLowerAngLimit(-1);
  pair.stock().setUpperAngLimit(1);
  EXPECT_EQ(rows(), 5);
  pair.stock().setLowerAngLimit(scalar(-pi));
  pair.stock().setUpperAngLimit(scalar(pi));
  EXPECT_EQ(rows(), 4);
}

TEST(DerivedSlider, TheDriveThatWasWrittenLastActs) {
  Pair<> pair;
  btSliderConstraint& stock = pair.slider;
  stock.setPoweredLinMotor(true);
  stock.setTargetLinMotorVelocity(2);
  stock.setMaxLinMotorForce(3);
  const SolverRows motor = SolverRows::ofStep(pair.slider);
  pair.slider.setLinMotorServo(1, 1, 1, infinite);
  const SolverRows servo = SolverRows::ofStep(pair.slider);
  EXPECT_NE(servo, motor);
  stock.setPoweredLinMotor(false);
  EXPECT_EQ(SolverRows::ofStep(pair.slider).announced(), 6 - 1);
  stock.setPoweredLinMotor(true);
  EXPECT_EQ(SolverRows::ofStep(pair.slider), servo);
  stock.setTargetLinMotorVelocity(1);
  SolverRows::ofStep(pair.slider);
  stock.setTargetLinMotorVelocity(2);
  EXPECT_EQ(SolverRows::ofStep(pair.slider), motor);
}

TEST(DerivedSlider, ASliderThatLiesOnItsLimitSaysSo) {
  scenes::World world;
  btRigidBody& post = world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
  btRigidBody& load = world.add_box(1, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
  const btTransform down(btQuaternion(vec(0, 1, 0), scalar(pi / 2)));  // x is -z
  auto& slider = world.add_joint<SliderJoint>(post, load, down, down, true);
  slider.setLowerLinLimit(scalar(-0.3));
  slider.setUpperLinLimit(scalar(0.3));
  slider.setDampingLimLin(1);
  btSliderConstraint& stock = slider;
  for (int i = 0; i < 120; ++i) world.step(dt);
  for (int i = 0; i < 60; ++i) {
    world.step(dt);
    EXPECT_TRUE(stock.getSolveLinLimit()) << i;
  }
}

TEST(DerivedSlider, HoldsNothingBeforeItHasFrames) {
  Pair<> pair;
  SliderJoint slider(*pair.a, *pair.b, scenes::pose_at(vec(0, nan_value, 0)),
                     btTransform::getIdentity());
  EXPECT_EQ(SolverRows::ofStep(slider).announced(), 0);
  EXPECT_NE(slider.whyIgnored().find("joint frames"), std::string::npos);
  slider.setFrames(btTransform::getIdentity(), btTransform::getIdentity());
  EXPECT_EQ(SolverRows::ofStep(slider).announced(), 5);
  // A mirror image: the axis stays.
  slider.getFrameOffsetA().setBasis(btMatrix3x3(1, 0, 0, 0, 1, 0, 0, 0, -1));
  EXPECT_TRUE(SolverRows::ofStep(slider).finite());
  EXPECT_EQ(slider.whyIgnored(), "");
}

// Bullet's cached state, which subclasses may read.
template <class Base>
class Cached : public Base {
 public:
  using Base::Base;
  static constexpr size_t angle_at = 1;
  std::vector<double> state() const {
    std::vector<double> all{double(this->m_linPos), double(this->m_angPos),
                            double(this->m_angDepth), double(this->m_solveLinLim),
                            double(this->m_solveAngLim)};
    const auto add = [&](const btVector3& v) { all.insert(all.end(), {v.x(), v.y(), v.z()}); };
    for (const btTransform* of : {&this->m_calculatedTransformA, &this->m_calculatedTransformB}) {
      add(of->getOrigin());
      for (int i = 0; i < 3; ++i) add(of->getBasis()[i]);
    }
    add(this->m_realPivotAInW);
    add(this->m_realPivotBInW);
    add(this->m_projPivotInW);
    add(this->m_sliderAxis);
    add(this->m_delta);
    add(this->m_depth);
    btSliderConstraint& stock = const_cast<Cached&>(*this);
    add(stock.getAncorInA());
    add(stock.getAncorInB());
    return all;
  }
};

TEST(DerivedSlider, AStepLeavesInBulletsObjectWhatBulletsDoes) {
  Random random(5);
  for (int i = 0; i < 400; ++i) {
    SCOPED_TRACE(i);
    const btTransform frame_a = random.pose(1), frame_b = random.pose(1);
    const auto a = support::body(1, vec(1, 2, 3), random.pose(3));
    const btTransform moved(btQuaternion(vec(1, 0, 0), scalar(random.uniform(-3, 3))),
                            vec(random.uniform(-2, 2), 0, 0));
    const auto b = support::body(
        2, vec(2, 1, 2), a->getCenterOfMassTransform() * frame_a * moved * frame_b.inverse());
    Cached<SliderJoint> ours(*a, *b, frame_a, frame_b, i % 2 == 0);
    Cached<btSliderConstraint> stock(*a, *b, frame_a, frame_b, i % 2 == 0);
    const double low = random.uniform(-1, 1), angle = random.uniform(-1, 1);
    const bool is_free = i % 4 > 1;
    for (btSliderConstraint* s :
         {static_cast<btSliderConstraint*>(&ours), static_cast<btSliderConstraint*>(&stock)}) {
      s->setLowerLinLimit(scalar(low));
      s->setUpperLinLimit(scalar(low + 0.5));
      s->setLowerAngLimit(scalar(angle));
      s->setUpperAngLimit(scalar(is_free ? angle - 1 : angle + 1));
    }
    SolverRows::ofStep(ours);
    SolverRows::ofStep(stock);
    const auto got = ours.state(), expected = stock.state();
    for (size_t k = 0; k < got.size(); ++k)
      if (k != ours.angle_at || !is_free) {  // else Bullet does not write it
        EXPECT_NEAR(got[k], expected[k], tolerance) << k;
      }
  }
}

using Announces = support::Announces<SliderJoint, 4>;
using AnnouncesAsBullet = support::AnnouncesAsBullet<SliderJoint, btSliderConstraint>;

template <class J>
void limit(Pair<J>& pair) {
  pair.slider.setLowerLinLimit(scalar(-0.2));
  pair.slider.setUpperLinLimit(scalar(0.2));
  pair.slider.setLowerAngLimit(scalar(-0.2));
  pair.slider.setUpperAngLimit(scalar(0.2));
}

// A test of a limit after the rows are announced makes no row of it.
template <class J>
SolverRows rowsAroundATest(double before, double after, bool by_limits) {
  Pair<J> pair;
  limit(pair);
  pair.move(before, before);
  SolverRows::ofStep(pair.slider);
  pair.slider.buildJacobian();
  SolverRows rows;
  rows.count(pair.slider);
  if (by_limits) {
    pair.slider.setUpperLinLimit(scalar(before - 0.1));
    pair.slider.setUpperAngLimit(scalar(before - 0.1));
  } else {
    pair.move(after, after);
  }
  pair.slider.testLinLimits();
  pair.slider.testAngLimits();
  EXPECT_TRUE(pair.slider.getSolveLinLimit());
  EXPECT_TRUE(pair.slider.getSolveAngLimit());
  rows.fill(pair.slider);
  return rows;
}

TEST(DerivedSlider, NoMoreRowsAreWrittenThanAreAnnounced) {
  for (const bool by_limits : {false, true}) {
    for (const double before : {0.1, 0.3}) {
      SCOPED_TRACE(testing::Message() << by_limits << ", " << before);
      const SolverRows alone = rowsAroundATest<Announces>(before, 0.4, by_limits);
      EXPECT_EQ(alone.touched(), 4);
      const SolverRows bullets = rowsAroundATest<AnnouncesAsBullet>(before, 0.4, by_limits);
      EXPECT_EQ(bullets.announced(), before > 0.2 ? 6 : 4);
      EXPECT_EQ(bullets.touched(), bullets.announced());
    }
  }
}

TEST(DerivedSlider, ASubclassThatOverridesGetInfo1AloneStillHolds) {
  const auto farthest = [](auto* type) {
    scenes::World world;
    btRigidBody& post = world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
    btRigidBody& load = world.add_box(1, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
    const btTransform down(btQuaternion(vec(0, 1, 0), scalar(pi / 2)));  // x is -z
    auto& slider = world.add_joint<std::remove_pointer_t<decltype(type)>>(post, load, down, down);
    slider.setLowerLinLimit(scalar(-0.3));
    slider.setUpperLinLimit(scalar(0.3));
    slider.setLowerAngLimit(1);
    slider.setUpperAngLimit(-1);
    for (int i = 0; i < 60; ++i) {
      world.step(dt);
      slider.testLinLimits();
      slider.testAngLimits();
    }
    const btVector3 at = load.getCenterOfMassPosition();
    EXPECT_NEAR(double(at.x()), 0, 1e-3);
    return std::abs(double(at.z()));
  };
  EXPECT_GT(farthest(static_cast<Announces*>(nullptr)), 1);  // there is no row for the limit
  EXPECT_LT(farthest(static_cast<AnnouncesAsBullet*>(nullptr)), 0.35);
}

TEST(DerivedSlider, WhatClientsCallBetweenStepsChangesNothing) {
  const auto run = [](bool bother) {
    scenes::World world;
    btRigidBody& post = world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
    btRigidBody& load = world.add_box(1, vec(0.1, 0.2, 0.3), scenes::pose_at(vec(1, 0, 0)));
    auto& slider = world.add_joint<SliderJoint>(post, load, scenes::pose_at(vec(0.5, 0, 0)),
                                                scenes::pose_at(vec(-0.5, 0, 0)));
    slider.setLowerLinLimit(scalar(-0.3));
    slider.setUpperLinLimit(scalar(0.3));
    load.setLinearVelocity(vec(2, 0, 0));
    for (int i = 0; i < 90; ++i) {
      world.step(dt);
      if (!bother) continue;
      btSliderConstraint& stock = slider;
      stock.buildJacobian();
      stock.calculateTransforms(load.getWorldTransform(), post.getWorldTransform());
      stock.testLinLimits();
      slider.calculateTransforms(load.getWorldTransform(), post.getWorldTransform());
      slider.getLinearPos();
      slider.whyIgnored();
    }
    return load.getCenterOfMassTransform();
  };
  EXPECT_EQ(run(false), run(true));
}

}  // namespace
}  // namespace derived_slider_test
