// The slider beside Bullet's: the same calls, readings, signs and defaults from one source; then what
// it promises beyond, held against closed forms.
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <gtest/gtest.h>
#include <pintle/body_pair.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <scenes/slider_crank.h>

#include <functional>
#include <stdexcept>
#include <vector>

#include "drawing.h"
#include "solver_of_tests.h"
#include "support.h"

namespace slider_joint_test {

using scenes::pi;
using support::infinite;
using support::nan_value;
using support::Random;
using support::scalar;
using support::SolverRows;
using support::StepInfo;
using support::vec;
using Stock = btSliderConstraint;
using Ours = pintle::SliderJoint;

// Rounding of a few operations on numbers of order one.
constexpr double rounding = support::is_double ? 1e-12 : 1e-5;

void expectNear(const btVector3& expected, const btVector3& got, double tolerance) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(expected[i], got[i], tolerance) << "component " << i;
}
void expectNear(const btTransform& expected, const btTransform& got, double tolerance) {
  expectNear(expected.getOrigin(), got.getOrigin(), tolerance);
  for (int i = 0; i < 3; ++i) expectNear(expected.getBasis()[i], got.getBasis()[i], tolerance);
}

// --- the same calls ------------------------------------------------------------------------------

struct TwoBodies {
  std::unique_ptr<btRigidBody> a, b;
  btTransform frame_a, frame_b;

  explicit TwoBodies(Random& random)
      : a(support::body(1, vec(1, 2, 3), random.pose(3))),
        b(support::body(2, vec(2, 1, 3), random.pose(3))),
        frame_a(random.pose(2)),
        frame_b(random.pose(2)) {}

  /// b where the joint holds, at this position along x of frame a, and this angle.
  void meet(double along, double angle) {
    const btTransform there(btQuaternion(vec(1, 0, 0), scalar(angle)), vec(along, 0, 0));
    b->setCenterOfMassTransform(a->getCenterOfMassTransform() * frame_a * there *
                                frame_b.inverse());
  }
};

template <class J>
std::vector<double> settingsOf(J& j) {
  return {double(j.getLowerLinLimit()),
          double(j.getUpperLinLimit()),
          double(j.getLowerAngLimit()),
          double(j.getUpperAngLimit()),
          double(j.getUseLinearReferenceFrameA()),
          double(j.getSoftnessDirLin()),
          double(j.getRestitutionDirLin()),
          double(j.getDampingDirLin()),
          double(j.getSoftnessDirAng()),
          double(j.getRestitutionDirAng()),
          double(j.getDampingDirAng()),
          double(j.getSoftnessLimLin()),
          double(j.getRestitutionLimLin()),
          double(j.getDampingLimLin()),
          double(j.getSoftnessLimAng()),
          double(j.getRestitutionLimAng()),
          double(j.getDampingLimAng()),
          double(j.getSoftnessOrthoLin()),
          double(j.getRestitutionOrthoLin()),
          double(j.getDampingOrthoLin()),
          double(j.getSoftnessOrthoAng()),
          double(j.getRestitutionOrthoAng()),
          double(j.getDampingOrthoAng()),
          double(j.getPoweredLinMotor()),
          double(j.getTargetLinMotorVelocity()),
          double(j.getMaxLinMotorForce()),
          double(j.getPoweredAngMotor()),
          double(j.getTargetAngMotorVelocity()),
          double(j.getMaxAngMotorForce()),
          double(j.getUseFrameOffset()),
          double(j.getFlags())};
}

template <class J>
void changeEverything(J& j) {
  double next = 0.1;
  const auto number = [&] { return scalar(next += 0.05); };
  j.setLowerLinLimit(-number());
  j.setUpperLinLimit(number());
  j.setLowerAngLimit(-number());
  j.setUpperAngLimit(number());
  j.setSoftnessDirLin(number());
  j.setRestitutionDirLin(number());
  j.setDampingDirLin(number());
  j.setSoftnessDirAng(number());
  j.setRestitutionDirAng(number());
  j.setDampingDirAng(number());
  j.setSoftnessLimLin(number());
  j.setRestitutionLimLin(number());
  j.setDampingLimLin(number());
  j.setSoftnessLimAng(number());
  j.setRestitutionLimAng(number());
  j.setDampingLimAng(number());
  j.setSoftnessOrthoLin(number());
  j.setRestitutionOrthoLin(number());
  j.setDampingOrthoLin(number());
  j.setSoftnessOrthoAng(number());
  j.setRestitutionOrthoAng(number());
  j.setDampingOrthoAng(number());
  j.setPoweredLinMotor(true);
  j.setTargetLinMotorVelocity(number());
  j.setMaxLinMotorForce(number());
  j.setPoweredAngMotor(true);
  j.setTargetAngMotorVelocity(number());
  j.setMaxAngMotorForce(number());
  j.setUseFrameOffset(false);
}

TEST(Slider, HasStocksDefaultsAndReadsBackWhatWasSet) {
  Random random(1);
  const TwoBodies pair(random);
  for (const bool use : {false, true}) {
    Stock stock(*pair.a, *pair.b, pair.frame_a, pair.frame_b, use);
    Ours ours(*pair.a, *pair.b, pair.frame_a, pair.frame_b, use);
    EXPECT_EQ(settingsOf(stock), settingsOf(ours));
    changeEverything(stock);
    changeEverything(ours);
    EXPECT_EQ(settingsOf(stock), settingsOf(ours));
  }
  // Without the flag: frame A measures.
  EXPECT_TRUE(Ours(*pair.a, *pair.b, pair.frame_a, pair.frame_b).getUseLinearReferenceFrameA());
  EXPECT_TRUE(Ours(*pair.b, pair.frame_b).getUseLinearReferenceFrameA());
}

TEST(Slider, ParametersAreStocksByAxis) {
  Random random(2);
  const TwoBodies pair(random);
  Stock stock(*pair.a, *pair.b, pair.frame_a, pair.frame_b, true);
  Ours ours(*pair.a, *pair.b, pair.frame_a, pair.frame_b, true);
  double value = 0.3;
  for (const int number : {BT_CONSTRAINT_STOP_ERP, BT_CONSTRAINT_STOP_CFM, BT_CONSTRAINT_CFM}) {
    for (int axis = -1; axis < 6; ++axis) {
      if (number == BT_CONSTRAINT_CFM && axis > 0 && axis != 3) continue;  // stock asserts
      SCOPED_TRACE(testing::Message() << "parameter " << number << ", axis " << axis);
      value += 0.01;
      stock.setParam(number, scalar(value), axis);
      ours.setParam(number, scalar(value), axis);
      EXPECT_EQ(ours.getParam(number, axis), scalar(value));
      EXPECT_EQ(stock.getFlags(), ours.getFlags());
      EXPECT_EQ(settingsOf(stock), settingsOf(ours));  // ERPs are softnesses
      for (int other = -1; other < 6; ++other) {
        EXPECT_EQ(stock.getParam(BT_CONSTRAINT_STOP_ERP, other),
                  ours.getParam(BT_CONSTRAINT_STOP_ERP, other));
        EXPECT_EQ(stock.getParam(BT_CONSTRAINT_STOP_CFM, other),
                  ours.getParam(BT_CONSTRAINT_STOP_CFM, other));
      }
    }
  }
  // Which Bullet has no meaning for, and takes.
  stock.setParam(BT_CONSTRAINT_ERP, scalar(0.5));
  ours.setParam(BT_CONSTRAINT_ERP, scalar(0.5));
  EXPECT_EQ(stock.getParam(BT_CONSTRAINT_ERP), ours.getParam(BT_CONSTRAINT_ERP));
  EXPECT_EQ(settingsOf(stock), settingsOf(ours));
}

TEST(Slider, ConstructorsMakeStocksFrames) {
  Random random(3);
  for (int n = 0; n < 50; ++n) {
    SCOPED_TRACE(n);
    const TwoBodies pair(random);
    for (const bool use : {false, true}) {
      Stock stock(*pair.a, *pair.b, pair.frame_a, pair.frame_b, use);
      Ours ours(*pair.a, *pair.b, pair.frame_a, pair.frame_b, use);
      Stock stock_one(*pair.b, pair.frame_b, use);
      Ours ours_one(*pair.b, pair.frame_b, use);
      // The free body is b, and the fixed one a.
      EXPECT_EQ(&ours_one.getRigidBodyB(), pair.b.get());
      EXPECT_EQ(&ours_one.getRigidBodyA(), &stock_one.getRigidBodyA());
      const auto compare = [](Stock& s, Ours& o) {
        expectNear(s.getFrameOffsetA(), o.getFrameOffsetA(), rounding);
        expectNear(s.getFrameOffsetB(), o.getFrameOffsetB(), rounding);
        expectNear(s.getCalculatedTransformA(), o.getCalculatedTransformA(), 10 * rounding);
        expectNear(s.getCalculatedTransformB(), o.getCalculatedTransformB(), 10 * rounding);
        s.setLowerLinLimit(scalar(0.3));
        o.setLowerLinLimit(scalar(0.3));
        expectNear(s.getAncorInA(), o.getAncorInA(), 10 * rounding);
        expectNear(s.getAncorInB(), o.getAncorInB(), rounding);
        const btTransform a = o.getFrameOffsetA(), b = o.getFrameOffsetB();
        s.setFrames(b, a);
        o.setFrames(b, a);
        expectNear(s.getCalculatedTransformA(), o.getCalculatedTransformA(), 10 * rounding);
      };
      compare(stock, ours);
      compare(stock_one, ours_one);
    }
  }
}

// Positions, angles, and what of them is beyond the limits.
TEST(Slider, ReadsWhatStockReads) {
  Random random(4);
  int broken_lin = 0, broken_ang = 0, adjusted = 0;
  for (int n = 0; n < 500; ++n) {
    SCOPED_TRACE(n);
    TwoBodies pair(random);
    const bool met = n % 2 == 0;  // else anyhow
    if (met) pair.meet(random.uniform(-2, 2), random.uniform(-3.1, 3.1));
    const bool use = n % 4 < 2;
    Stock stock(*pair.a, *pair.b, pair.frame_a, pair.frame_b, use);
    Ours ours(*pair.a, *pair.b, pair.frame_a, pair.frame_b, use);
    const double low = random.uniform(-3, 2), ang_low = random.uniform(-3, 2);
    const double high = random.uniform(low, 3), ang_high = random.uniform(ang_low, 3);
    const auto limits = [&](auto& joint) {
      joint.setLowerLinLimit(scalar(low));
      joint.setUpperLinLimit(scalar(high));
      joint.setLowerAngLimit(scalar(ang_low));
      joint.setUpperAngLimit(scalar(ang_high));
    };
    limits(stock);
    limits(ours);
    SolverRows::ofStep(stock);
    SolverRows::ofStep(ours);
    const double tolerance = 20 * rounding;
    EXPECT_NEAR(stock.getLinearPos(), ours.getLinearPos(), tolerance);
    EXPECT_NEAR(stock.getLinDepth(), ours.getLinDepth(), tolerance);
    EXPECT_EQ(stock.getSolveLinLimit(), ours.getSolveLinLimit());
    broken_lin += stock.getSolveLinLimit();
    // Half-way round the outside both limits are as near.
    const double from_middle =
        std::abs(std::remainder(double(stock.getAngularPos()) - (ang_low + ang_high) / 2, 2 * pi));
    if (pi - from_middle < 1e-3) continue;
    // The angle of b's y axis, which where that is short across a's x is rounded off further.
    EXPECT_NEAR(stock.getAngularPos(), ours.getAngularPos(), met ? tolerance : 100 * tolerance);
    if (std::abs(double(stock.getAngularPos())) > pi) ++adjusted;
    if (!met) continue;
    EXPECT_NEAR(stock.getAngDepth(), ours.getAngDepth(), tolerance);
    EXPECT_EQ(stock.getSolveAngLimit(), ours.getSolveAngLimit());
    EXPECT_NEAR(
        std::remainder(double(ours.getAccumulatedAngularPos() - ours.getAngularPos()), 2 * pi), 0,
        tolerance);
    broken_ang += stock.getSolveAngLimit();
  }
  EXPECT_GT(broken_lin, 50);
  EXPECT_GT(broken_ang, 50);
  EXPECT_GT(adjusted, 10);
}

TEST(Slider, TestsItsLimitsWhenAsked) {
  Random random(5);
  TwoBodies pair(random);
  pair.meet(0, 0);
  Ours slider(*pair.a, *pair.b, pair.frame_a, pair.frame_b);
  slider.setLowerLinLimit(-1);
  slider.setUpperLinLimit(1);
  slider.setLowerAngLimit(scalar(-0.5));
  slider.setUpperAngLimit(scalar(0.5));
  EXPECT_FALSE(slider.getSolveLinLimit());
  pair.meet(1.25, -0.75);
  EXPECT_FALSE(slider.getSolveLinLimit());  // has not looked
  EXPECT_FALSE(slider.getSolveAngLimit());
  slider.testLinLimits();
  slider.testAngLimits();
  EXPECT_TRUE(slider.getSolveLinLimit());
  EXPECT_TRUE(slider.getSolveAngLimit());
  EXPECT_NEAR(slider.getLinDepth(), 0.25, 20 * rounding);
  EXPECT_NEAR(slider.getAngDepth(), -0.25, 20 * rounding);
}

// --- in a world ----------------------------------------------------------------------------------

/// A static body a and a cube b on it (or both free cubes), joint frames turned, anchors off centre.
template <class J>
struct Rig {
  scenes::World world;
  btRigidBody *a, *b;
  J* joint;

  struct Settings {
    bool use = true, both_free = false;
    double gravity = 0, mass = 2;
    int iterations = 10;
    btVector3 anchor_a = vec(0.3, 0.1, -0.2), anchor_b = vec(-0.2, 0.1, 0.15);
    btQuaternion turn = btQuaternion(vec(1, 2, 3).normalized(), scalar(0.8));
    double along = 0;
    btVector3 half_extents = vec(0.2, 0.2, 0.2);
  };
  explicit Rig(const Settings& s) : world(s.gravity, s.iterations) {
    const btTransform frame_a(s.turn, s.anchor_a), frame_b(s.turn, s.anchor_b);
    const btTransform slide(btQuaternion::getIdentity(), vec(s.along, 0, 0));
    a = &world.add_box(s.both_free ? s.mass : 0, s.half_extents, btTransform::getIdentity());
    b = &world.add_box(s.mass, s.half_extents, frame_a * slide * frame_b.inverse());
    joint = &world.template add_joint<J>(*a, *b, frame_a, frame_b, s.use);
  }
  btRigidBody& free() { return *b; }
  void step(double dt = 1.0 / 60) { world.step(dt); }

  // What the poses say, whatever the joint does.
  btTransform frameA() const { return a->getCenterOfMassTransform() * joint->getFrameOffsetA(); }
  btTransform frameB() const { return b->getCenterOfMassTransform() * joint->getFrameOffsetB(); }
  btVector3 axis() const { return frameA().getBasis().getColumn(0); }
  btVector3 between() const {
    return frameA().getBasis().transpose() * (frameB().getOrigin() - frameA().getOrigin());
  }
  double along() const { return between().x(); }
  double across() const { return std::hypot(double(between().y()), double(between().z())); }
  btVector3 turned() const {
    btQuaternion q = (frameA().inverse() * frameB()).getRotation();
    if (q.w() < 0) q = -q;
    const btVector3 v(q.x(), q.y(), q.z());
    const btScalar length = v.length();
    return length > 0 ? v * (2 * btAtan2(length, q.w()) / length) : v;
  }
  double angle() const { return turned().x(); }
};
template <class J>
using RigSettings = typename Rig<J>::Settings;

template <class J>
void freeAngle(J& joint) {
  joint.setLowerAngLimit(1);
  joint.setUpperAngLimit(-1);
}

/// Where the motors have moved it after a second.
struct Moved {
  double reading, angle_reading, along, angle;
};
template <class J>
Moved moveByMotors(bool use, bool both_free, double lin, double ang) {
  RigSettings<J> settings;
  settings.use = use;
  settings.both_free = both_free;
  if (both_free) settings.anchor_a = settings.anchor_b = vec(0, 0, 0);  // else they turn each other
  Rig<J> rig(settings);
  rig.joint->setLowerAngLimit(-2);
  rig.joint->setUpperAngLimit(2);
  rig.joint->setTargetLinMotorVelocity(scalar(lin));
  rig.joint->setMaxLinMotorForce(1000);
  rig.joint->setPoweredLinMotor(lin != 0);
  rig.joint->setTargetAngMotorVelocity(scalar(ang));
  rig.joint->setMaxAngMotorForce(1000);
  rig.joint->setPoweredAngMotor(ang != 0);
  for (int i = 0; i < 60; ++i) rig.step();
  rig.joint->buildJacobian();
  SolverRows::ofStep(*rig.joint);
  return {double(rig.joint->getLinearPos()), double(rig.joint->getAngularPos()), rig.along(),
          rig.angle()};
}

TEST(Slider, MotorsAndPositionsHaveStocksSigns) {
  for (const bool use : {false, true}) {
    for (const bool both_free : {false, true}) {
      for (const double lin : {-0.5, 0.5, 0.0}) {
        for (const double ang : {-0.5, 0.5, 0.0}) {
          SCOPED_TRACE(testing::Message() << "reference A " << use << ", both free " << both_free
                                          << ", motors " << lin << ", " << ang);
          const Moved stock = moveByMotors<Stock>(use, both_free, lin, ang);
          const Moved ours = moveByMotors<Ours>(use, both_free, lin, ang);
          // Of a half: stock's drift within a second, and what its motors lose.
          EXPECT_NEAR(stock.reading, ours.reading, 0.02);
          EXPECT_NEAR(stock.along, ours.along, 0.02);
          EXPECT_NEAR(stock.angle, ours.angle, 0.02);
          EXPECT_NEAR(stock.angle_reading, ours.angle_reading, 0.02);
          // And the closed form: speed times time.
          EXPECT_NEAR(ours.reading, lin, 2e-3);
          EXPECT_NEAR(ours.along, use ? lin : -lin, 2e-3);
          EXPECT_NEAR(ours.angle, -ang, 2e-3);
          EXPECT_NEAR(ours.angle_reading, -ang, 2e-3);
        }
      }
    }
  }
}

// Bullet bounds a motor by a force: what it can lift it lifts.
TEST(Slider, AMotorIsBoundedByAForce) {
  for (const double dt : {1.0 / 60, 1.0 / 240}) {
    for (const double force : {15.0, 25.0}) {
      const auto lifted = [&](auto* type) {
        using J = std::remove_pointer_t<decltype(type)>;
        RigSettings<J> settings;
        settings.gravity = 10;
        settings.turn = btQuaternion(vec(0, 1, 0), scalar(-pi / 2));  // x is up
        Rig<J> rig(settings);
        rig.joint->setMaxLinMotorForce(scalar(force));
        rig.joint->setPoweredLinMotor(true);  // of target 0: a brake
        for (int i = 0; i < int(0.5 / dt + 0.5); ++i) rig.step(dt);
        return rig.along();
      };
      // 2 kg weigh 20 N; a brake of 15 N leaves 2.5 m/s^2 for half a second. (A step more or less.)
      const double expected = force < 20 ? -0.5 * 2.5 * 0.25 : 0;
      EXPECT_NEAR(lifted(static_cast<Ours*>(nullptr)), expected, 2.5 * 0.5 * dt) << dt;
      EXPECT_NEAR(lifted(static_cast<Stock*>(nullptr)), expected, 2.5 * 0.5 * dt) << dt;
    }
  }
}

// --- what the softnesses and parameters do ------------------------------------------------------

/// The part of an error that a step leaves, at an ERP of the world of 0.2.
struct Left {
  double across, direction, along, angle;
};
template <class J>
Left errorAfterAStep(const std::function<void(J&)>& set) {
  Left left = {};
  const auto one = [&](const btTransform& off, const std::function<double(const Rig<J>&)>& error) {
    RigSettings<J> settings;
    settings.anchor_a = settings.anchor_b =
        vec(0, 0, 0);  // no row then touches another one's error
    settings.turn = btQuaternion::getIdentity();
    Rig<J> rig(settings);
    rig.b->setCenterOfMassTransform(off);
    rig.joint->setLowerLinLimit(0);
    rig.joint->setUpperLinLimit(0);
    support::closeByErpAlone(*rig.joint);
    set(*rig.joint);
    const double before = error(rig);
    rig.step();
    return error(rig) / before;
  };
  const auto turn = [](const btVector3& axis) {
    return btTransform(btQuaternion(axis, scalar(0.01)));
  };
  left.across = one(scenes::pose_at(vec(0, 0.1, 0)), [](auto& rig) { return rig.across(); });
  left.direction = one(turn(vec(0, 1, 0)), [](auto& rig) { return double(rig.turned().y()); });
  left.along = one(scenes::pose_at(vec(0.1, 0, 0)), [](auto& rig) { return rig.along(); });
  left.angle = one(turn(vec(1, 0, 0)), [](auto& rig) { return rig.angle(); });
  return left;
}

template <class J>
Left errorAfterAStep(int which) {
  return errorAfterAStep<J>([which](J& j) {
    switch (which) {
      case 1: j.setSoftnessOrthoLin(scalar(0.5)); break;
      case 2: j.setSoftnessOrthoAng(scalar(0.5)); break;
      case 3: j.setSoftnessLimLin(scalar(0.5)); break;
      case 4: j.setSoftnessLimAng(scalar(0.5)); break;
      case 5: j.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.6), 0); break;
      case 6: j.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.6), 1); break;
      case 7: j.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.6), 3); break;
      case 8: j.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.6), 5); break;
      case 9:  // which do nothing
        j.setSoftnessDirLin(scalar(0.1));
        j.setSoftnessDirAng(scalar(0.1));
        j.setRestitutionDirLin(0);
        j.setRestitutionLimLin(0);
        j.setRestitutionLimAng(0);
        j.setRestitutionOrthoLin(0);
        j.setRestitutionOrthoAng(0);
        j.setDampingDirLin(scalar(0.5));
        j.setDampingDirAng(scalar(0.5));
        j.setDampingOrthoLin(scalar(0.5));
        j.setDampingOrthoAng(scalar(0.5));
        break;
      default: break;
    }
  });
}

TEST(Slider, SoftnessesAndErpsDoWhatTheyDoInStock) {
  PINTLE_SKIP_ON_EXACT_SOLVER("what is open closes by poses, which velocities tell nothing of");
  const Left as_is = {0.8, 0.8, 0.8, 0.8};
  std::vector<Left> expected(10, as_is);
  expected[1].across = 0.9;
  expected[2].direction = 0.9;
  expected[3].along = 0.9;
  expected[4].angle = 0.9;
  expected[5].along = 1 - 0.36;  // the ERP counts twice at a limit
  expected[6].across = 0.4;
  expected[7].angle = 1 - 0.36;
  expected[8].direction = 0.4;
  for (int which = 0; which < 10; ++which) {
    SCOPED_TRACE(which);
    const Left stock = errorAfterAStep<Stock>(which), ours = errorAfterAStep<Ours>(which);
    // A turn of 0.01 rad, by its sine and as an angle; and float's rounding of a rotation that small.
    const double near = support::is_double ? 1e-4 : 2e-3;
    const auto expectSame = [&](double Left::*error) {
      EXPECT_NEAR(stock.*error, expected[size_t(which)].*error, near);
      EXPECT_NEAR(ours.*error, expected[size_t(which)].*error, near);
    };
    expectSame(&Left::across);
    expectSame(&Left::direction);
    expectSame(&Left::along);
    expectSame(&Left::angle);
  }
}

// In the solver's rows: as many soft ones, of as much softness.
TEST(Slider, CfmsReachTheRowsThatTheyReachInStock) {
  Random random(6);
  TwoBodies pair(random);
  pair.meet(2, 1);
  const auto cfms = [&](auto& joint, int number, int axis) {
    joint.setLowerLinLimit(-1);
    joint.setUpperLinLimit(1);
    joint.setLowerAngLimit(scalar(-0.5));
    joint.setUpperAngLimit(scalar(0.5));
    joint.setPoweredLinMotor(number == BT_CONSTRAINT_CFM);
    joint.setPoweredAngMotor(number == BT_CONSTRAINT_CFM);
    joint.setParam(number, scalar(0.0625), axis);
    const SolverRows rows = SolverRows::ofStep(joint);
    int soft = 0;
    for (int i = 0; i < rows.announced(); ++i) soft += rows[i].cfm() == scalar(0.0625);
    return soft;
  };
  for (const int number : {BT_CONSTRAINT_STOP_CFM, BT_CONSTRAINT_CFM}) {
    for (const int axis : {0, 1, 3, 4}) {
      if (number == BT_CONSTRAINT_CFM && axis != 0 && axis != 3) continue;
      SCOPED_TRACE(testing::Message() << "parameter " << number << ", axis " << axis);
      Stock stock(*pair.a, *pair.b, pair.frame_a, pair.frame_b, true);
      Ours ours(*pair.a, *pair.b, pair.frame_a, pair.frame_b, true);
      const int expected = axis == 1 || axis == 4 ? 2 : 1;
      EXPECT_EQ(cfms(stock, number, axis), expected);
      // Motor and limit at once: ours solves them together, and has one row for the outcome.
      if (number == BT_CONSTRAINT_STOP_CFM) {
        EXPECT_EQ(cfms(ours, number, axis), expected);
      }
    }
  }
  // A motor alone, and a locked angle.
  Ours motor(*pair.a, *pair.b, pair.frame_a, pair.frame_b),
      locked(*pair.a, *pair.b, pair.frame_a, pair.frame_b);
  motor.setPoweredLinMotor(true);
  motor.setParam(BT_CONSTRAINT_CFM, scalar(0.0625));
  const SolverRows motor_rows = SolverRows::ofStep(motor);
  EXPECT_EQ(motor_rows[motor_rows.announced() - 1].cfm(), scalar(0.0625));
  locked.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.0625), 3);
  const SolverRows locked_rows = SolverRows::ofStep(locked);
  int soft = 0;
  for (int i = 0; i < locked_rows.announced(); ++i) soft += locked_rows[i].cfm() > 0;
  EXPECT_EQ(soft, 1);
}

// --- limits --------------------------------------------------------------------------------------

/// Thrown along the axis at 3 m/s at a limit 0.52 m away.
struct Thrown {
  double farthest = 0, rebound = 0;
};
template <class J>
Thrown throwAtLimit(bool use, double damping, bool upper) {
  RigSettings<J> settings;
  settings.use = use;
  Rig<J> rig(settings);
  const double side = upper ? 1 : -1;  // of the position
  rig.joint->setLowerLinLimit(scalar(upper ? -10 : -0.52));
  rig.joint->setUpperLinLimit(scalar(upper ? 0.52 : 10));
  rig.joint->setDampingLimLin(scalar(damping));
  const btVector3 axis = rig.axis() * scalar(use ? side : -side);
  rig.b->setLinearVelocity(axis * 3);
  Thrown thrown;
  for (int i = 0; i < 30; ++i) {
    rig.step();
    thrown.farthest = std::max(thrown.farthest, side * rig.along() * (use ? 1 : -1));
    thrown.rebound = -double(rig.b->getLinearVelocity().dot(axis)) / 3;
  }
  return thrown;
}

TEST(Slider, ALinearLimitIsHeldInTheStepThatReachesItWhereStocksIsPassed) {
  for (const bool use : {false, true}) {
    for (const bool upper : {false, true}) {
      const Thrown stock = throwAtLimit<Stock>(use, 1, upper),
                   ours = throwAtLimit<Ours>(use, 1, upper);
      EXPECT_GT(stock.farthest, 0.525);
      EXPECT_NEAR(ours.farthest, 0.52, 1e-4);
      EXPECT_NEAR(ours.rebound, 0, 1e-3);
    }
  }
}

// |1 - damping| of the speed comes back. Stock's sign is wrong: it comes back at none, or goes on.
TEST(Slider, ALinearLimitReboundsWhereStocksDoesNot) {
  for (const double damping : {0.75, 0.5, 0.0}) {
    for (const bool upper : {false, true}) {
      SCOPED_TRACE(testing::Message() << damping << ", upper " << upper);
      for (const bool use : {false, true}) {
        const Thrown ours = throwAtLimit<Ours>(use, damping, upper);
        EXPECT_NEAR(ours.rebound, 1 - damping, 1e-3);
        EXPECT_NEAR(ours.farthest, 0.52, 1e-4);
      }
      // By frame A a rebound of the correction alone, whatever the damping; by frame B the limit
      // lets go as much as it ought to throw back.
      EXPECT_LT(throwAtLimit<Stock>(true, damping, upper).rebound, 0.2);
      EXPECT_GT(throwAtLimit<Stock>(false, damping, upper).farthest, 0.53);
      EXPECT_LE(throwAtLimit<Stock>(false, damping, upper).rebound, 0);
    }
  }
}

template <class J>
Thrown turnAtLimit(double damping, bool upper) {
  RigSettings<J> settings;
  settings.anchor_a = settings.anchor_b = vec(0, 0, 0);
  Rig<J> rig(settings);
  const double side = upper ? 1 : -1;
  rig.joint->setLowerAngLimit(scalar(upper ? -2 : -0.52));
  rig.joint->setUpperAngLimit(scalar(upper ? 0.52 : 2));
  rig.joint->setDampingLimAng(scalar(damping));
  const btVector3 axis = rig.axis() * scalar(side);
  rig.b->setAngularVelocity(axis * 3);
  Thrown thrown;
  for (int i = 0; i < 30; ++i) {
    rig.step();
    thrown.farthest = std::max(thrown.farthest, side * rig.angle());
    thrown.rebound = -double(rig.b->getAngularVelocity().dot(axis)) / 3;
  }
  return thrown;
}

TEST(Slider, AnAngularLimitReboundsAsStocksDoes) {
  for (const double damping : {0.75, 0.5, 0.0}) {
    for (const bool upper : {false, true}) {
      SCOPED_TRACE(testing::Message() << damping << ", upper " << upper);
      const Thrown stock = turnAtLimit<Stock>(damping, upper),
                   ours = turnAtLimit<Ours>(damping, upper);
      EXPECT_NEAR(stock.rebound, 1 - damping, 1e-2);
      EXPECT_NEAR(ours.rebound, 1 - damping, 1e-2);
      EXPECT_GT(stock.farthest, 0.525);
      EXPECT_NEAR(ours.farthest, 0.52, 1e-4);
    }
  }
}

TEST(Slider, AngularLimitsSpanAnyNumberOfTurns) {
  RigSettings<Ours> settings;
  Rig<Ours> rig(settings);
  rig.joint->setLowerAngLimit(scalar(-pi));
  rig.joint->setUpperAngLimit(scalar(6 * pi));
  EXPECT_EQ(rig.joint->getUpperAngLimit(), scalar(6 * pi));
  rig.joint->setTargetAngMotorVelocity(-9);
  rig.joint->setMaxAngMotorForce(100);
  rig.joint->setPoweredAngMotor(true);
  for (int i = 0; i < 240; ++i) rig.step();
  // A motor of finite torque, against a limit that is hard.
  EXPECT_NEAR(rig.joint->getAccumulatedAngularPos(), 6 * pi, 1e-3);
  EXPECT_NEAR(rig.joint->getAngularPos(), 6 * pi, 1e-3);
  rig.joint->setTargetAngMotorVelocity(9);
  for (int i = 0; i < 300; ++i) rig.step();
  EXPECT_NEAR(rig.joint->getAccumulatedAngularPos(), -pi, 1e-3);
  // A new limit within a turn holds in the turn that the joint is in.
  rig.joint->setLowerAngLimit(scalar(4 * pi - 0.5));
  rig.joint->setUpperAngLimit(scalar(4 * pi + 0.5));
  EXPECT_NEAR(std::abs(rig.joint->getAccumulatedAngularPos() - scalar(4 * pi)), pi, 1e-3);
  rig.joint->setAccumulatedAngularPos(scalar(9.2 * pi));
  EXPECT_NEAR(rig.joint->getAccumulatedAngularPos(), 9 * pi, 1e-3);
}

TEST(Slider, ALockedAngleIsReachedThroughAllTheTurnsThatItIsOff) {
  for (const double locked : {-3., 0., 2.5}) {
    for (const int turns : {-2, -1, 0, 1, 2}) {
      SCOPED_TRACE(testing::Message() << turns << " turns from " << locked);
      RigSettings<Ours> settings;
      Rig<Ours> rig(settings);
      rig.joint->setLowerAngLimit(scalar(locked));
      rig.joint->setUpperAngLimit(scalar(locked));
      const double off = 2 * pi * turns + double(rig.joint->getAccumulatedAngularPos()) - locked;
      rig.joint->setAccumulatedAngularPos(scalar(locked + off));
      double turned = 0, fastest = 0;
      for (int i = 0; i < 600; ++i) {
        // By poses: the exact solver closes it without velocities.
        const double before = double(rig.joint->getAngularPos());
        rig.step();
        const double by = std::remainder(double(rig.joint->getAngularPos()) - before, 2 * pi);
        turned += by;
        fastest = std::max(fastest, std::abs(by) * 60);
      }
      EXPECT_NEAR(double(rig.joint->getAccumulatedAngularPos()), locked, 1e-3);
      EXPECT_NEAR(turned, -off, 0.05);
      EXPECT_LE(fastest, 8 + 1e-3);
    }
  }
}

// Stock's motor slows down before the limit that it moves away from, and stops there.
TEST(Slider, AMotorLeavesAnAngularLimitWhereStocksIsStuck) {
  const auto leave = [](auto* type) {
    using J = std::remove_pointer_t<decltype(type)>;
    Rig<J> rig({});
    rig.joint->setLowerAngLimit(-1);
    rig.joint->setUpperAngLimit(0);
    rig.joint->setTargetAngMotorVelocity(1);  // downwards
    rig.joint->setMaxAngMotorForce(100);
    rig.joint->setPoweredAngMotor(true);
    for (int i = 0; i < 30; ++i) rig.step();
    return rig.angle();
  };
  EXPECT_GT(leave(static_cast<Stock*>(nullptr)), -0.02);
  EXPECT_NEAR(leave(static_cast<Ours*>(nullptr)), -0.5, 1e-3);
}

TEST(Slider, HoldsALoadAtItsLimitNoWorseThanStock) {
  const auto sag = [](auto* type, bool frame_offset) {
    using J = std::remove_pointer_t<decltype(type)>;
    RigSettings<J> settings;
    settings.gravity = 10;
    settings.turn = btQuaternion(vec(0, 1, 0), scalar(-1));
    Rig<J> rig(settings);
    rig.joint->setUseFrameOffset(frame_offset);
    rig.joint->setLowerLinLimit(scalar(-0.1));
    rig.joint->setUpperLinLimit(1);
    for (int i = 0; i < 200; ++i) rig.step();
    return std::array<double, 3>{std::abs(rig.along() + 0.1), rig.across(),
                                 double(rig.turned().length())};
  };
  const auto ours = sag(static_cast<Ours*>(nullptr), true);
  for (const bool offset : {false, true}) {
    const auto stock = sag(static_cast<Stock*>(nullptr), offset);
    for (size_t i = 0; i < 3; ++i) EXPECT_LE(ours[i], stock[i] + 10 * rounding) << i;
  }
}

// A telescope that sticks out, stage in stage, its last one the heaviest: how far it sinks.
template <class J>
double telescope(int iterations, double ratio) {
  scenes::World world(10, iterations);
  const btVector3 half_extents = vec(0.5, 0.1, 0.1);
  const int stages = 4;
  btRigidBody* last = &world.add_box(0, half_extents, btTransform::getIdentity());
  double worst = 0;
  for (int i = 1; i <= stages; ++i) {
    btRigidBody& next =
        world.add_box(i == stages ? ratio : 1, half_extents, scenes::pose_at(vec(0.9 * i, 0, 0)));
    J& joint = world.add_joint<J>(*last, next, scenes::pose_at(vec(0.5, 0, 0)),
                                  scenes::pose_at(vec(-0.4, 0, 0)), true);
    joint.setLowerLinLimit(-1);
    joint.setUpperLinLimit(0);
    last = &next;
  }
  for (int i = 0; i < 240; ++i) {
    world.step(1.0 / 60);
    worst = std::max(worst, std::abs(double(last->getCenterOfMassPosition().z())));
  }
  return worst;
}

TEST(Slider, ATelescopeSinksLessThanStocks) {
  for (const double ratio : {1., 10.}) {
    for (const int iterations : {4, 10, 50}) {
      SCOPED_TRACE(testing::Message() << "load " << ratio << ", iterations " << iterations);

      EXPECT_LT(telescope<Ours>(iterations, ratio), telescope<Stock>(iterations, ratio));
    }
  }
}

// A piston locked on a spinning disc: the curvature of its own row keeps it there.
TEST(Slider, ALockedPositionHoldsOnASpinningBodyWhereStocksGives) {
  const auto error = [](auto* type) {
    using J = std::remove_pointer_t<decltype(type)>;
    RigSettings<J> settings;
    settings.both_free = true;
    settings.turn = btQuaternion::getIdentity();
    settings.anchor_a = settings.anchor_b = vec(0, 0, 0);
    settings.along = 1;
    Rig<J> rig(settings);
    rig.joint->setLowerLinLimit(1);
    rig.joint->setUpperLinLimit(1);
    // About the middle between the two, at 5 rad/s.
    for (btRigidBody* body : {rig.a, rig.b}) body->setAngularVelocity(vec(0, 0, 5));
    rig.a->setLinearVelocity(vec(0, -2.5, 0));
    rig.b->setLinearVelocity(vec(0, 2.5, 0));
    double worst = 0;
    for (int i = 0; i < 120; ++i) {
      rig.step();
      worst = std::max(worst, std::abs(rig.along() - 1));
    }
    return worst;
  };
  EXPECT_GT(error(static_cast<Stock*>(nullptr)), 0.01);
  EXPECT_LT(error(static_cast<Ours*>(nullptr)), 2e-3);
}

// --- the document's example ----------------------------------------------------------------------

struct Correction {
  double left, spin;         // of the gap; rad/s, at most
  double momentum, angular;  // at most, of a pair that had none
};

// Two cubes at rest, pushed apart across the axis.
Correction correct(pintle::Formulation formulation, bool block, bool turns, bool centred) {
  RigSettings<Ours> settings;
  settings.both_free = true;
  if (centred) settings.anchor_a = settings.anchor_b = vec(0, 0, 0);
  settings.along = 1.5;
  settings.iterations = 50;
  Rig<Ours> rig(settings);
  rig.joint->setFormulation(formulation);
  rig.joint->setBlockRows(block);
  support::closeByErpAlone(*rig.joint);
  if (turns) freeAngle(*rig.joint);
  rig.b->translate(rig.frameA().getBasis() * vec(0, 0.3, 0.2));
  const double before = rig.across();
  Correction result = {};
  for (int i = 0; i < 60; ++i) {
    const Eigen::Matrix3d last = scenes::rotation(*rig.b);
    rig.step();
    Eigen::Vector3d L(0, 0, 0), P(0, 0, 0);
    for (const btRigidBody* body : {rig.a, rig.b}) {  // a cube's inertia is a number
      const double mass = 1 / double(body->getInvMass());
      const Eigen::Vector3d v = mass * scenes::to_eigen(body->getLinearVelocity());
      L += scenes::position(*body).cross(v) +
           double(body->getLocalInertia().x()) * scenes::to_eigen(body->getAngularVelocity());
      P += v;
    }
    // Of the exact solver poses say it, which closes it without velocities.
    const double turn =
        Eigen::AngleAxisd(Eigen::Matrix3d(scenes::rotation(*rig.b) * last.transpose())).angle();
    result.spin = std::max(
        result.spin, onExactSolver() ? turn * 60 : double(rig.b->getAngularVelocity().length()));
    result.angular = std::max(result.angular, L.norm());
    result.momentum = std::max(result.momentum, P.norm());
  }
  result.left = rig.across() / before;
  return result;
}

// Anchors at the centres of mass: a force alone would act along two lines, so the correction has to
// turn the bodies.
TEST(Slider, CorrectsWithTorqueAndConservesAngularMomentum) {
  const double nothing = support::is_double ? 1e-12 : 2e-5;
  for (const auto formulation : {pintle::Formulation::document, pintle::Formulation::conditioned}) {
    const bool document = formulation == pintle::Formulation::document;
    for (const bool block : {false, true}) {
      for (const bool turns : {false, true}) {
        SCOPED_TRACE(testing::Message()
                     << "document " << document << ", block " << block << ", turns " << turns);
        const Correction example = correct(formulation, block, turns, true);
        EXPECT_LT(example.left, 0.01);
        EXPECT_GT(example.spin, 1);
        EXPECT_LT(example.momentum, nothing);
        // (On the exact solver poses close it, which turn their levers with them.)
        EXPECT_LT(example.angular, document && !turns && onExactSolver() ? 1e-2 : nothing);
        // Off the centres the force is not along the gap. The document's levers meet half-way along
        // the axis, but each on its own side of the gap: there it turns the pair out of nothing.
        const Correction other = correct(formulation, block, turns, false);
        EXPECT_LT(other.left, 0.01);
        EXPECT_LT(other.momentum, nothing);
        if (document && !turns && !onExactSolver()) {
          EXPECT_GT(other.angular, 10 * nothing);
        } else {
          EXPECT_LT(other.angular, nothing);
        }
      }
    }
  }
}

// --- the parts of the two axes -------------------------------------------------------------------

// A load along and about the axis, held by limits, motors and friction of both.
TEST(Slider, TheImpulsesOfBothAxesAreKnownApart) {
  for (const bool block : {false, true}) {
    for (const bool use : {false, true}) {
      SCOPED_TRACE(testing::Message() << "block " << block << ", reference A " << use);
      RigSettings<Ours> settings;
      settings.use = use;
      settings.anchor_a = settings.anchor_b = vec(0, 0, 0);
      settings.iterations = 50;
      Rig<Ours> rig(settings);
      Ours& slider = *rig.joint;
      slider.setBlockRows(block);
      slider.setLowerLinLimit(0);
      slider.setUpperLinLimit(1);
      slider.setLowerAngLimit(-1);
      slider.setUpperAngLimit(0);
      slider.setLinFriction(5);
      slider.setAngFriction(1);
      slider.setTargetLinMotorVelocity(1);  // out of the limit, and too weak
      slider.setMaxLinMotorForce(3);
      slider.setPoweredLinMotor(true);
      slider.setTargetAngMotorVelocity(1);  // the angle down, out of its limit, and too weak
      slider.setMaxAngMotorForce(2);
      slider.setPoweredAngMotor(true);
      slider.enableFeedback(true);
      const double dt = 1.0 / 60, sign = use ? 1 : -1;
      for (int i = 0; i < 20; ++i) {
        rig.b->applyCentralForce(rig.axis() * scalar(-30 * sign));
        rig.b->applyTorque(rig.axis() * 10);
        rig.step(dt);
      }
      const double near = 1e-3 * dt;  // of what the rows still differ by after the iterations
      EXPECT_NEAR(slider.getLinMotorImpulse(), 3 * dt, near);
      EXPECT_NEAR(slider.getAngMotorImpulse(), -2 * dt, near);
      // At rest: what friction does not take the limits do.
      EXPECT_LE(std::abs(slider.getLinFrictionImpulse()), 5 * dt + near);
      EXPECT_LE(std::abs(slider.getAngFrictionImpulse()), 1 * dt + near);
      const double lin = double(slider.getLinMotorImpulse() + slider.getLinLimitImpulse() +
                                slider.getLinFrictionImpulse());
      const double ang = double(slider.getAngMotorImpulse() + slider.getAngLimitImpulse() +
                                slider.getAngFrictionImpulse());
      EXPECT_NEAR(lin, 30 * dt, 5e-3 * 30 * dt);
      EXPECT_NEAR(ang, -10 * dt, 5e-3 * 10 * dt);
      EXPECT_GT(slider.getLinLimitImpulse(), 0);
      EXPECT_LT(slider.getAngLimitImpulse(), 0);
      // Bullet's own reading is the last row's: the limit of the angle, a positive.
      EXPECT_NEAR(-double(slider.getAppliedImpulse()), double(slider.getAngLimitImpulse()), near);
      // Off, and away from the limits: nothing.
      slider.setPoweredLinMotor(false);
      slider.setPoweredAngMotor(false);
      slider.setLinFriction(0);
      slider.setAngFriction(0);
      freeAngle(slider);
      slider.setLowerLinLimit(-10);
      rig.step(dt);
      EXPECT_EQ(slider.getLinLimitImpulse(), 0);
      EXPECT_EQ(slider.getAngLimitImpulse(), 0);
      EXPECT_EQ(slider.getAngMotorImpulse(), 0);
    }
  }
}

TEST(Slider, FeedbackIsTheForceOnTheBodies) {
  const auto feedback = [](auto* type) {
    using J = std::remove_pointer_t<decltype(type)>;
    RigSettings<J> settings;
    settings.gravity = 10;
    Rig<J> rig(settings);
    rig.joint->setLowerLinLimit(0);
    rig.joint->setUpperLinLimit(0);
    btJointFeedback out;
    rig.joint->setJointFeedback(&out);
    rig.joint->enableFeedback(true);
    for (int i = 0; i < 120; ++i) rig.step();
    return out;
  };
  const btJointFeedback stock = feedback(static_cast<Stock*>(nullptr));
  const btJointFeedback ours = feedback(static_cast<Ours*>(nullptr));
  // 2 kg at rest. (Bullet's applied torque is about the centre of mass.)
  EXPECT_NEAR(ours.m_appliedForceBodyB.z(), 20, 0.01);
  expectNear(stock.m_appliedForceBodyB, ours.m_appliedForceBodyB, 0.05);
  expectNear(stock.m_appliedTorqueBodyB, ours.m_appliedTorqueBodyB, 0.05);
}

TEST(Slider, BreaksAsStockDoes) {
  const auto breaks = [](auto* type, const btVector3& force, const btVector3& torque) {
    using J = std::remove_pointer_t<decltype(type)>;
    RigSettings<J> settings;
    settings.turn = btQuaternion::getIdentity();
    settings.anchor_a = settings.anchor_b = vec(0, 0, 0);
    Rig<J> rig(settings);
    rig.joint->setBreakingImpulseThreshold(scalar(0.5));
    return support::stepOfBreaking(rig, *rig.joint, force, torque);
  };
  const btVector3 none(0, 0, 0);
  for (const btVector3& push : {vec(0, 1, 0), vec(0, 0, 1)}) {
    const int stock = breaks(static_cast<Stock*>(nullptr), push, none);
    EXPECT_NEAR(stock, 31, 1);  // 30 N for 1/60 s
    EXPECT_NEAR(breaks(static_cast<Ours*>(nullptr), push, none), stock, 1);
    EXPECT_NEAR(breaks(static_cast<Stock*>(nullptr), none, push),
                breaks(static_cast<Ours*>(nullptr), none, push), 1);
  }
  EXPECT_EQ(breaks(static_cast<Ours*>(nullptr), vec(1, 0, 0), none), -1);  // it slides
}

// --- beyond stock --------------------------------------------------------------------------------

TEST(Slider, AServoSwingsAtItsFrequency) {
  RigSettings<Ours> settings;
  Rig<Ours> rig(settings);
  rig.joint->setLinMotorServo(scalar(0.5), 2, 0, 1e6);
  // Bullet's implicit spring damps by itself: its first swing passes the target a quarter period on.
  const double dt = 1.0 / 1000;
  double crossed = 0;
  for (int i = 1; crossed == 0 && i < 1000; ++i) {
    rig.step(dt);
    if (rig.along() >= 0.5) crossed = i * dt;
  }
  EXPECT_NEAR(crossed, 0.125, 2e-3);
  // Damped it comes to rest at the target.
  rig.joint->setLinMotorServo(scalar(0.5), 2, 1, 1e6);
  for (int i = 0; i < 2000; ++i) rig.step(dt);
  EXPECT_NEAR(rig.along(), 0.5, 1e-4);
  // Off and on again it is a servo still, and by a target velocity a motor.
  rig.joint->setPoweredLinMotor(false);
  rig.joint->setPoweredLinMotor(true);
  rig.joint->setLinMotorServo(scalar(-0.5), 2, 1, 1e6);
  for (int i = 0; i < 2000; ++i) rig.step(dt);
  EXPECT_NEAR(rig.along(), -0.5, 1e-4);
  rig.joint->setMaxLinMotorForce(1000);
  rig.joint->setTargetLinMotorVelocity(1);
  for (int i = 0; i < 500; ++i) rig.step(dt);
  EXPECT_NEAR(rig.along(), 0, 1e-2);
}

TEST(Slider, AServosLargeBoundIsNone) {
  const auto way = [](btScalar max_force) {
    RigSettings<Ours> settings;
    Rig<Ours> rig(settings);
    rig.joint->setLinMotorServo(scalar(0.5), scalar(0.01), 1, max_force);
    for (int i = 0; i < 60; ++i) rig.step(1.0 / 60);
    return rig.along();
  };
  EXPECT_NEAR(way(scalar(BT_LARGE_FLOAT)), way(scalar(1e4)), 1e-6);
  EXPECT_NEAR(way(SIMD_INFINITY), way(scalar(1e4)), 1e-6);
}

TEST(Slider, AnAngularServoCountsTurns) {
  Rig<Ours> rig({});
  freeAngle(*rig.joint);
  rig.joint->setAngMotorServo(scalar(5 * pi), 1, 1, 1e6);
  for (int i = 0; i < 300; ++i) rig.step();
  EXPECT_NEAR(rig.joint->getAccumulatedAngularPos(), 5 * pi, 1e-2);
}

TEST(Slider, FrictionStopsAfterItsClosedForm) {
  Rig<Ours> rig({});
  rig.joint->setLinFriction(4);  // 2 m/s^2 on 2 kg
  rig.b->setLinearVelocity(rig.axis() * 2);
  const double dt = 1.0 / 240;
  for (int i = 0; i < 480; ++i) rig.step(dt);
  EXPECT_NEAR(rig.along(), 1, 2 * dt);  // v^2 / 2a, and half a step of v
  EXPECT_NEAR(rig.b->getLinearVelocity().length(), 0, 1e-4);
  freeAngle(*rig.joint);
  rig.joint->setAngFriction(scalar(0.05));
  rig.b->setAngularVelocity(rig.axis() * 2);
  rig.b->setLinearVelocity(vec(0, 0, 0));
  for (int i = 0; i < 960; ++i) rig.step(dt);
  EXPECT_NEAR(rig.b->getAngularVelocity().length(), 0, 1e-3);
}

// A weight on a soft limit: m g / k deeper, k = m w^2.
TEST(Slider, ASoftLimitGivesByTheWeight) {
  RigSettings<Ours> settings;
  settings.gravity = 10;
  settings.turn = btQuaternion(vec(0, 1, 0), scalar(-pi / 2));  // x is up
  settings.anchor_a = settings.anchor_b = vec(0, 0, 0);
  Rig<Ours> rig(settings);
  rig.joint->setLowerLinLimit(0);
  rig.joint->setUpperLinLimit(1);
  rig.joint->setLinLimitSpring(2, 1);
  for (int i = 0; i < 300; ++i) rig.step();
  const double w = 2 * pi * 2;
  EXPECT_NEAR(rig.along(), -10 / (w * w), 1e-3 * 10 / (w * w));
  // And about the axis.
  rig.joint->setUpperAngLimit(1);
  rig.joint->setAngLimitSpring(2, 1);
  const double torque = -0.5, inertia = double(rig.b->getLocalInertia().x());
  for (int i = 0; i < 300; ++i) {
    rig.b->applyTorque(rig.axis() * scalar(torque));
    rig.step();
  }
  EXPECT_NEAR(rig.angle(), torque / (inertia * w * w), 0.01 * std::abs(torque / (inertia * w * w)));
}

TEST(Slider, AngularOnlyLeavesThePositionAlone) {
  Rig<Ours> rig({});
  rig.joint->setAngularOnly(true);
  rig.joint->setLowerLinLimit(0);
  rig.joint->setUpperLinLimit(0);
  EXPECT_EQ(SolverRows::ofStep(*rig.joint).announced(), 3);
  rig.b->setLinearVelocity(vec(1, 2, 3));
  rig.b->setAngularVelocity(vec(3, 2, 1));
  const btVector3 start = rig.b->getCenterOfMassPosition();
  for (int i = 0; i < 60; ++i) rig.step();
  expectNear(rig.b->getCenterOfMassPosition(), start + vec(1, 2, 3), 1e-4);
  EXPECT_LT(rig.turned().length(), 1e-3);
}

TEST(Slider, HasARowForWhatActs) {
  struct Count {
    const char* name;
    int rows;
    std::function<void(Ours&, btRigidBody&)> set;
  };
  const btVector3 along(6, 0, 0);  // 0.1 m a step
  const auto limit = [](Ours& j, double low, double high) {
    j.setLowerLinLimit(scalar(low));
    j.setUpperLinLimit(scalar(high));
  };
  const Count counts[] = {
      {"as made", 5, [](auto&, auto&) {}},
      {"free to turn", 4, [](auto& j, auto&) { freeAngle(j); }},
      {"inside both", 4,
       [&](auto& j, auto&) {
         j.setLowerAngLimit(-1);
         j.setUpperAngLimit(1);
         limit(j, -1, 1);
       }},
      {"broken", 6, [&](auto& j, auto&) { limit(j, 1, 2); }},
      {"broken, high", 6, [&](auto& j, auto&) { limit(j, -2, -1); }},
      {"both broken", 6,
       [&](auto& j, auto&) {
         limit(j, 1, 2);
         j.setUpperAngLimit(2);
         j.setLowerAngLimit(1);
       }},
      {"locked", 6, [&](auto& j, auto&) { limit(j, 0, 0); }},
      {"about to be reached", 6,
       [&](auto& j, auto& b) {
         limit(j, -1, 0.09);
         b.setLinearVelocity(along);
       }},
      {"about to be left", 5,
       [&](auto& j, auto& b) {
         limit(j, -0.09, 1);
         b.setLinearVelocity(along);
       }},
      {"driven by a force", 6,
       [&](auto& j, auto& b) {
         limit(j, -1, 0.01);
         b.applyCentralForce(vec(100, 0, 0));  // 100 m/s^2 is 0.028 m in a step
       }},
      {"driven less", 5,
       [&](auto& j, auto& b) {
         limit(j, -1, 0.01);
         b.applyCentralForce(vec(10, 0, 0));
       }},
      {"motor", 6, [](auto& j, auto&) { j.setPoweredLinMotor(true); }},
      {"angular motor, locked", 5, [](auto& j, auto&) { j.setPoweredAngMotor(true); }},
      {"angular motor", 5,
       [](auto& j, auto&) {
         freeAngle(j);
         j.setPoweredAngMotor(true);
       }},
      {"all", 7,  // friction and limit along the axis
       [&](auto& j, auto&) {
         freeAngle(j);
         j.setAngFriction(1);
         j.setLinFriction(1);
         limit(j, 0, 0);
       }},
      {"locked, by a spring", 5, [](auto& j, auto&) { j.setAngLimitSpring(1, 1); }},
  };
  for (const auto formulation : {pintle::Formulation::document, pintle::Formulation::conditioned}) {
    for (const Count& count : counts) {
      SCOPED_TRACE(count.name);
      const btTransform unit = btTransform::getIdentity();
      const auto a = support::body(0, vec(1, 1, 1), unit), b = support::body(1, vec(1, 1, 1), unit);
      Ours slider(*a, *b, unit, unit);
      slider.setFormulation(formulation);
      count.set(slider, *b);
      const SolverRows rows = SolverRows::ofStep(slider);
      EXPECT_EQ(rows.announced(), count.rows);
      EXPECT_TRUE(rows.finite());
    }
  }
}

// In a plane game an axis square to the plane leaves the rows of its direction nothing but rounding.
// Bullet passes over them, and no other row may be mixed with them.
TEST(Slider, RowsWithoutMassAreMixedIntoNoOther) {
  Random random(8);
  for (int n = 0; n < 50; ++n) {
    const btTransform spin_a(btQuaternion(vec(0, 0, 1), scalar(random.uniform(-3, 3))));
    const btTransform spin_b(btQuaternion(vec(0, 0, 1), scalar(random.uniform(-3, 3))));
    const auto a = support::body(1, vec(1, 1, 1), spin_a),
               b = support::body(1, vec(1, 1, 1), spin_b);
    for (btRigidBody* body : {a.get(), b.get()}) {
      body->setLinearFactor(vec(1, 1, 0));
      body->setAngularFactor(vec(0, 0, 1));
    }
    const btTransform frame(btQuaternion(vec(0, 1, 0), scalar(pi / 2)), vec(0.5, 0.2, 0));
    Ours slider(*a, *b, frame, frame);
    freeAngle(slider);
    for (const auto form : {pintle::Formulation::document, pintle::Formulation::conditioned}) {
      slider.setFormulation(form);
      const SolverRows rows = SolverRows::ofStep(slider);
      ASSERT_EQ(rows.announced(), 4);
      for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 12; ++k) EXPECT_LE(std::abs(rows[i].fields[k]), 3) << i << ", " << k;
    }
  }
}

// From any orientation, no faster than the bound, and nearly as soon as stock where that keeps it.
TEST(Slider, RecoversFromAnyOrientation) {
  struct Recovered {
    int steps = -1;
    double fastest = 0;
  };
  const auto recover = [](auto* type, const btVector3& about, double angle) {
    using J = std::remove_pointer_t<decltype(type)>;
    RigSettings<J> settings;
    settings.both_free = true;
    settings.turn = btQuaternion::getIdentity();
    settings.anchor_a = vec(0.5, 0, 0);
    settings.anchor_b = vec(-0.5, 0, 0);
    settings.half_extents = vec(0.5, 0.1, 0.1);
    Rig<J> rig(settings);
    btTransform pose(btQuaternion(about.normalized(), scalar(angle)));
    pose.setOrigin(vec(0.5, 0, 0) - pose.getBasis() * vec(-0.5, 0, 0));
    rig.b->setCenterOfMassTransform(pose);
    Recovered result;
    for (int i = 1; i <= 600; ++i) {
      rig.step();
      const bool right = double(rig.turned().length()) < scenes::radians(1) && rig.across() < 0.01;
      if (!right) result.steps = -1;
      if (right && result.steps < 0) result.steps = i;
      for (const btRigidBody* body : {rig.a, rig.b})
        result.fastest = std::max(result.fastest, double(body->getAngularVelocity().length()));
    }
    return result;
  };
  for (const btVector3& about : {vec(1, 0, 0), vec(0, 1, 0), vec(0.6, 0.8, 0), vec(1, 1, 1)}) {
    for (const double angle : {45., 90., 120., 170., 179., 180.}) {
      SCOPED_TRACE(testing::Message() << angle << " about " << about.x() << ' ' << about.y());
      const Recovered stock = recover(static_cast<Stock*>(nullptr), about, scenes::radians(angle));
      const Recovered ours = recover(static_cast<Ours*>(nullptr), about, scenes::radians(angle));
      EXPECT_GT(ours.steps, 0);
      EXPECT_LE(ours.steps, 40);
      EXPECT_LE(ours.fastest, 8);
      // Stock's correction is bounded by a sine across the axis, and about it by nothing.
      if (stock.steps > 0 && stock.fastest <= 8) {
        EXPECT_LE(ours.steps, stock.steps + 3);
      }
    }
  }
}

// --- in a loop -----------------------------------------------------------------------------------

TEST(Slider, ASliderCrankFollowsItsClosedForm) {
  using scenes::SliderCrankResult;
  scenes::SliderCrankSettings settings;
  settings.iterations = 100;
  const auto stock = [&] {
    return scenes::slider_crank<btHingeConstraint, btPoint2PointConstraint, Stock>(settings);
  };
  const auto ours = [&] {
    return scenes::slider_crank<pintle::QuaternionHinge, pintle::BallJoint, Ours>(settings);
  };
  std::vector<double> errors;
  for (const double hz : {60, 120, 240}) {
    settings.dt = 1 / hz;
    const SliderCrankResult s = stock(), o = ours();
    ASSERT_TRUE(o.finite);
    EXPECT_LT(o.max_piston_error, 0.1 * s.max_piston_error) << hz;
    EXPECT_LT(o.max_gap, 0.1 * s.max_gap) << hz;
    EXPECT_NEAR(o.max_reading_error, o.max_piston_error, 1e-5) << hz;
    errors.push_back(o.max_piston_error);
  }
  // Five turns at 60 Hz, of a stroke of 0.6 m; third order in the step, where stock's is second.
  EXPECT_LT(errors[0], 6e-4);
  if (onExactSolver()) {
    // What is left is of a loop's least softness, and of rounding.
    EXPECT_LT(*std::max_element(errors.begin(), errors.end()), support::is_double ? 5e-6 : 2e-5);
  } else {
    // Below that line, as far as the crank turns by enough in a step to be looked where that leads.
    for (const int i : {1, 2}) EXPECT_LT(errors[size_t(i)], 6e-4 / std::pow(8, i));
  }
  // With few iterations the crank lags, and that is of the first order.
  settings.dt = 1.0 / 60;
  settings.iterations = 10;
  EXPECT_LT(ours().max_piston_error, 0.5 * stock().max_piston_error);
}

// --- drawing -------------------------------------------------------------------------------------

TEST(Slider, DrawsItsFramesAndLimits) {
  Rig<Ours> rig({});
  const auto lines = [&](int mode) { return drawing::linesOf(*rig.joint, mode); };
  const int frames = btIDebugDraw::DBG_DrawConstraints;
  const int limits = btIDebugDraw::DBG_DrawConstraintLimits;
  EXPECT_EQ(lines(0), 0);
  EXPECT_EQ(lines(frames), 6);
  const int locked = 3;              // a sector of no width, as Bullet draws it
  EXPECT_EQ(lines(limits), locked);  // free along
  rig.joint->setLowerLinLimit(-1);
  rig.joint->setUpperLinLimit(1);
  EXPECT_EQ(lines(limits), locked + 1);
  rig.joint->setUpperAngLimit(1);
  EXPECT_GT(lines(limits), 5);
  EXPECT_EQ(lines(frames | limits), lines(frames) + lines(limits));
  rig.joint->setUpperLinLimit(infinite);
  rig.joint->setUpperAngLimit(infinite);
  lines(frames | limits);
}

// --- settings that are refused -------------------------------------------------------------------

// Bullet's own methods take anything. What is no number is not used, and the joint says so.
TEST(Slider, OfWhatIsNotANumberTheLastGoodOneStays) {
  struct Setting {
    const char* field;  ///< empty: nothing is made of it
    std::function<void(Ours&, btScalar)> call;
    bool negative_is_good, infinity_is_good;
  };
  const Setting settings[] = {
      {"softness across", [](Ours& j, btScalar v) { j.setSoftnessOrthoLin(v); }, false, false},
      {"softness across", [](Ours& j, btScalar v) { j.setSoftnessOrthoAng(v); }, false, false},
      {"limit softness", [](Ours& j, btScalar v) { j.setSoftnessLimLin(v); }, false, false},
      {"limit softness", [](Ours& j, btScalar v) { j.setSoftnessLimAng(v); }, false, false},
      {"", [](Ours& j, btScalar v) { j.setRestitutionLimLin(v); }, true, false},
      {"limit damping", [](Ours& j, btScalar v) { j.setDampingLimLin(v); }, true, false},
      {"limit damping", [](Ours& j, btScalar v) { j.setDampingLimAng(v); }, true, false},
      {"target linear motor velocity", [](Ours& j, btScalar v) { j.setTargetLinMotorVelocity(v); },
       true, false},
      {"target angular motor velocity", [](Ours& j, btScalar v) { j.setTargetAngMotorVelocity(v); },
       true, false},
      {"max linear motor force", [](Ours& j, btScalar v) { j.setMaxLinMotorForce(v); }, false,
       true},
      {"max angular motor force", [](Ours& j, btScalar v) { j.setMaxAngMotorForce(v); }, false,
       true},
      {"STOP_ERP", [](Ours& j, btScalar v) { j.setParam(BT_CONSTRAINT_STOP_ERP, v, 4); }, false,
       false},
      {"CFM", [](Ours& j, btScalar v) { j.setParam(BT_CONSTRAINT_CFM, v, 3); }, false, false},
      {"linear limit", [](Ours& j, btScalar v) { j.setLowerLinLimit(v); }, true, true},
      {"linear limit", [](Ours& j, btScalar v) { j.setUpperLinLimit(v); }, true, true},
      {"angular limit", [](Ours& j, btScalar v) { j.setLowerAngLimit(v); }, true, true},
      {"angular limit", [](Ours& j, btScalar v) { j.setUpperAngLimit(v); }, true, true},
  };
  Random random(9);
  TwoBodies pair(random);
  pair.meet(0.5, 0.1);
  for (const Setting& setting : settings) {
    const auto fresh = [&] {
      auto slider = std::make_unique<Ours>(*pair.a, *pair.b, pair.frame_a, pair.frame_b);
      slider->setPoweredLinMotor(true);
      slider->setPoweredAngMotor(true);
      return slider;
    };
    for (const btScalar value : {nan_value, infinite, scalar(-1)}) {
      SCOPED_TRACE(testing::Message() << setting.field << " = " << value);
      const auto slider = fresh(), twin = fresh();
      ASSERT_NO_THROW(setting.call(*slider, value));
      const SolverRows rows = SolverRows::ofStep(*slider);
      EXPECT_TRUE(rows.finite());
      const std::string why = slider->whyIgnored();
      const bool is_good = value < 0   ? setting.negative_is_good
                           : value > 0 ? setting.infinity_is_good
                                       : false;
      if (is_good || setting.field == std::string()) {
        EXPECT_EQ(why, "");
        continue;
      }
      EXPECT_NE(why.find("SliderJoint"), std::string::npos) << why;
      EXPECT_NE(why.find(setting.field), std::string::npos) << why;
      // A parameter that was never a number is 0.
      if (!(value < 0) && std::string(setting.field).find('P') == std::string::npos &&
          std::string(setting.field) != "CFM") {
        EXPECT_EQ(rows, SolverRows::ofStep(*twin));
      }
      setting.call(*slider, scalar(0.5));
      EXPECT_EQ(slider->whyIgnored(), "");
    }
  }
}

TEST(Slider, RefusesBadSettingsAndStaysAsItWas) {
  struct Setting {
    const char* field;
    std::function<void(Ours&, btScalar)> call;
    bool negative_is_good, infinity_is_good;
  };
  const Setting settings[] = {
      {"target", [](Ours& j, btScalar v) { j.setLinMotorServo(v, 1, 1, 1); }, true, false},
      {"frequency", [](Ours& j, btScalar v) { j.setLinMotorServo(1, v, 1, 1); }, false, false},
      {"damping", [](Ours& j, btScalar v) { j.setAngMotorServo(1, 1, v, 1); }, false, false},
      {"force", [](Ours& j, btScalar v) { j.setLinMotorServo(1, 1, 1, v); }, false, true},
      {"torque", [](Ours& j, btScalar v) { j.setAngMotorServo(1, 1, 1, v); }, false, true},
      {"force", [](Ours& j, btScalar v) { j.setLinFriction(v); }, false, true},
      {"torque", [](Ours& j, btScalar v) { j.setAngFriction(v); }, false, true},
      {"frequency", [](Ours& j, btScalar v) { j.setLinLimitSpring(v, 1); }, false, false},
      {"damping", [](Ours& j, btScalar v) { j.setAngLimitSpring(1, v); }, false, false},
      {"accumulated", [](Ours& j, btScalar v) { j.setAccumulatedAngularPos(v); }, true, false},
  };
  Random random(9);
  TwoBodies pair(random);
  pair.meet(0.5, 0.1);
  const auto expectRefused = [&](const std::function<void(Ours&)>& call, const std::string& field) {
    Ours slider(*pair.a, *pair.b, pair.frame_a, pair.frame_b);
    Ours twin(*pair.a, *pair.b, pair.frame_a, pair.frame_b);
    std::string message = "accepted";
    try {
      call(slider);
    } catch (const std::invalid_argument& error) {
      message = error.what();
    }
    EXPECT_NE(message.find("SliderJoint"), std::string::npos) << field << ": " << message;
    EXPECT_NE(message.find(field), std::string::npos) << field << ": " << message;
    EXPECT_EQ(settingsOf(slider), settingsOf(twin));
    EXPECT_EQ(SolverRows::ofStep(slider), SolverRows::ofStep(twin));
  };
  for (const Setting& setting : settings) {
    expectRefused([&](Ours& j) { setting.call(j, nan_value); }, setting.field);
    for (const auto& [value, good] :
         {std::pair{infinite, setting.infinity_is_good}, {scalar(-1), setting.negative_is_good}}) {
      if (!good) {
        expectRefused([&, v = value](Ours& j) { setting.call(j, v); }, setting.field);
        continue;
      }
      Ours slider(*pair.a, *pair.b, pair.frame_a, pair.frame_b);
      EXPECT_NO_THROW(setting.call(slider, value)) << setting.field;
      EXPECT_TRUE(SolverRows::ofStep(slider).finite());
    }
  }
}

}  // namespace slider_joint_test
