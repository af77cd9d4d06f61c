// The universal joint in the place of Bullet's: the same calls give the same answers, bodies move
// alike where Bullet's joint works, and as the equations say where it does not.
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btUniversalConstraint.h>
#include <gtest/gtest.h>
#include <pintle/joints/universal_joint.h>
#include <scenes/drive_shaft.h>

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <vector>

#include "drawing.h"
#include "solver_of_tests.h"
#include "support.h"

namespace universal_joint_test {

using scenes::pi;
using support::infinite;
using support::is_double;
using support::nan_value;
using support::Random;
using support::refusal;
using support::scalar;
using support::vec;
using Stock = btUniversalConstraint;
using Ours = pintle::UniversalJoint;

// Of a few operations on numbers of order one.
constexpr double rounding = is_double ? 1e-12 : 1e-5;

template <class Joint>
void drive(Joint& joint, int axis, double velocity, double torque) {
  btRotationalLimitMotor& motor = *joint.getRotationalLimitMotor(axis - 3);
  motor.m_enableMotor = true;
  motor.m_targetVelocity = scalar(velocity);
  motor.m_maxMotorForce = scalar(torque);
}

template <class Joint>
void setFree(Joint& joint) {
  joint.setLimit(4, 1, -1);
  joint.setLimit(5, 1, -1);
}

void expectSame(const btVector3& a, const btVector3& b, double tolerance = rounding) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}
void expectSame(const btTransform& a, const btTransform& b, double tolerance = rounding) {
  expectSame(a.getOrigin(), b.getOrigin(), tolerance);
  for (int i = 0; i < 3; ++i) expectSame(a.getBasis()[i], b.getBasis()[i], tolerance);
}

// --- frames and readings -------------------------------------------------------------------------

struct Pair {
  std::unique_ptr<btRigidBody> a, b;
};

Pair randomPair(Random& random) {
  return {support::body(1, vec(1, 2, 3), random.pose(3)),
          support::body(2, vec(1, 2, 3), random.pose(3))};
}

struct Axes {
  btVector3 anchor, first, second;
};

Axes randomAxes(Random& random) {
  Axes axes;
  axes.anchor = random.vector(2);
  axes.first = random.unit();
  axes.second = axes.first.cross(random.unit()).normalized();
  return axes;
}

// b where the joint stands at the equations' alpha and beta.
template <class Joint>
void place(Pair& pair, const Joint& joint, double alpha, double beta) {
  const btQuaternion turn =
      btQuaternion(vec(0, 0, 1), scalar(alpha)) * btQuaternion(vec(0, 1, 0), scalar(beta));
  pair.b->setCenterOfMassTransform(pair.a->getCenterOfMassTransform() * joint.getFrameOffsetA() *
                                   btTransform(turn) * joint.getFrameOffsetB().inverse());
}

TEST(DropInUniversal, ConstructorAndSetAxisMakeStocksFrames) {
  Random random(1);
  for (int n = 0; n < 200; ++n) {
    SCOPED_TRACE(n);
    Pair pair = randomPair(random);
    Axes axes = randomAxes(random);
    const btScalar length = scalar(random.uniform(0.1, 3));
    Stock stock(*pair.a, *pair.b, axes.anchor, axes.first * length, axes.second * length);
    Ours ours(*pair.a, *pair.b, axes.anchor, axes.first * length, axes.second * length);
    for (int turn = 0; turn < 2; ++turn) {
      expectSame(stock.getFrameOffsetA(), ours.getFrameOffsetA(), 10 * rounding);
      expectSame(stock.getFrameOffsetB(), ours.getFrameOffsetB(), 10 * rounding);
      expectSame(stock.getAxis1(), ours.getAxis1());
      expectSame(stock.getAxis2(), ours.getAxis2());
      // Elsewhere by now: the anchor of the constructor counts, in the world.
      pair.a->setCenterOfMassTransform(random.pose(3));
      axes = randomAxes(random);
      stock.setAxis(axes.first * 2, axes.second * 3);
      ours.setAxis(axes.first * 2, axes.second * 3);
    }
  }
}

TEST(DropInUniversal, ReadingsAreStocksInsideItsRange) {
  Random random(2);
  for (int n = 0; n < 300; ++n) {
    SCOPED_TRACE(n);
    Pair pair = randomPair(random);
    const Axes axes = randomAxes(random);
    Stock stock(*pair.a, *pair.b, axes.anchor, axes.first, axes.second);
    Ours ours(*pair.a, *pair.b, axes.anchor, axes.first, axes.second);
    const double alpha = random.uniform(-3.1, 3.1), beta = random.uniform(-1.4, 1.4);
    place(pair, ours, alpha, beta);
    pair.b->translate(random.vector(0.1));
    stock.calculateTransforms();
    ours.calculateTransforms();
    const double tolerance = 20 * rounding;
    EXPECT_NEAR(stock.getAngle1(), ours.getAngle1(), tolerance);
    EXPECT_NEAR(stock.getAngle2(), ours.getAngle2(), tolerance);
    EXPECT_NEAR(ours.getAngle1(), -alpha, tolerance);
    EXPECT_NEAR(ours.getAngle2(), -beta, tolerance);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(stock.getAngle(i), ours.getAngle(i), tolerance) << i;
      expectSame(stock.getAxis(i), ours.getAxis(i), tolerance);
      EXPECT_NEAR(stock.getRelativePivotPosition(i), ours.getRelativePivotPosition(i), tolerance);
    }
    expectSame(stock.getAnchor(), ours.getAnchor(), tolerance);
    expectSame(stock.getAnchor2(), ours.getAnchor2(), tolerance);
    expectSame(stock.getCalculatedTransformA(), ours.getCalculatedTransformA(), tolerance);
    expectSame(stock.getCalculatedTransformB(), ours.getCalculatedTransformB(), tolerance);
  }
}

TEST(Universal, ReadingsGoOnBeyondStocksRange) {
  Random random(3);
  for (int n = 0; n < 100; ++n) {
    Pair pair = randomPair(random);
    const Axes axes = randomAxes(random);
    Ours ours(*pair.a, *pair.b, axes.anchor, axes.first, axes.second);
    const double way_1 = random.uniform(-1, 1), way_2 = random.uniform(-1, 1);
    for (int i = 1; i <= 20; ++i) {
      // Both go up to three turns, less than half a turn a look.
      place(pair, ours, -way_1 * i, -way_2 * i);
      const double tolerance = 40 * rounding;
      ASSERT_NEAR(std::remainder(double(ours.getAngle1()) - way_1 * i, 2 * pi), 0, tolerance);
      ASSERT_NEAR(std::remainder(double(ours.getAngle2()) - way_2 * i, 2 * pi), 0, tolerance);
      support::SolverRows::ofStep(ours);
      ASSERT_NEAR(ours.getAccumulatedAngle(5), way_1 * i, tolerance);
      ASSERT_NEAR(ours.getAccumulatedAngle(4), way_2 * i, tolerance);
    }
    ours.setAccumulatedAngle(4, ours.getAngle2() + scalar(6 * pi));
    EXPECT_NEAR(ours.getAccumulatedAngle(4), ours.getAngle2() + 6 * pi, 40 * rounding);
  }
}

TEST(Universal, FrameConstructorsAreAtTheirFrames) {
  Random random(4);
  Pair pair = randomPair(random);
  const btTransform frame_a = random.pose(1), frame_b = random.pose(1);
  const Ours both(*pair.a, *pair.b, frame_a, frame_b);
  expectSame(both.getFrameOffsetA(), frame_a);
  expectSame(both.getFrameOffsetB(), frame_b);
  expectSame(both.getAxis1(), both.getCalculatedTransformA().getBasis().getColumn(2));
  expectSame(both.getAxis2(), both.getCalculatedTransformB().getBasis().getColumn(1));
  const Ours one(*pair.a, frame_a);
  EXPECT_EQ(&one.getRigidBodyB(), &btTypedConstraint::getFixedBody());
  expectSame(one.getCalculatedTransformA(), one.getCalculatedTransformB());
  EXPECT_NEAR(one.getAngle1(), 0, rounding);
}

// --- settings ------------------------------------------------------------------------------------

template <class Joint>
std::vector<double> setAndAsk() {
  const auto a = support::body(1, vec(1, 2, 3), btTransform::getIdentity());
  const auto b = support::body(1, vec(1, 2, 3), btTransform::getIdentity());
  Joint joint(*a, *b, vec(0, 0, 0), vec(0, 0, 1), vec(0, 1, 0));
  btTypedConstraint& base = joint;
  std::vector<double> answers;
  const auto ask = [&] {
    btVector3 low, high;
    joint.getAngularLowerLimit(low);
    joint.getAngularUpperLimit(high);
    for (int i = 0; i < 3; ++i) {
      answers.push_back(double(low[i]));
      answers.push_back(double(high[i]));
    }
    for (int i = 0; i < 6; ++i) answers.push_back(joint.isLimited(i));
    answers.push_back(joint.getFlags());
    answers.push_back(joint.getUseFrameOffset());
    answers.push_back(base.isEnabled());
    answers.push_back(double(base.getBreakingImpulseThreshold()) / 1e38);
  };
  ask();
  // Stock's order: the bound of angle 2 first.
  joint.setUpperLimit(scalar(0.3), scalar(0.4));
  joint.setLowerLimit(scalar(-0.2), scalar(-0.1));
  ask();
  joint.setLimit(4, scalar(-0.5), scalar(0.6));
  joint.setLimit(5, 2, -2);
  ask();
  joint.setAngularLowerLimit(vec(0, -1, -2));
  joint.setAngularUpperLimit(vec(0, 1, 2));
  ask();
  joint.setUseFrameOffset(false);
  ask();
  for (int axis = 0; axis < 6; ++axis) {
    base.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.3), axis);
    base.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.4), axis);
    base.setParam(BT_CONSTRAINT_CFM, scalar(0.5), axis);
    ask();
    for (const int number : {BT_CONSTRAINT_STOP_ERP, BT_CONSTRAINT_STOP_CFM, BT_CONSTRAINT_CFM})
      answers.push_back(double(base.getParam(number, axis)));
  }
  // The angles may differ from each other.
  base.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.6), 4);
  base.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.7), 5);
  answers.push_back(double(base.getParam(BT_CONSTRAINT_STOP_ERP, 4)));
  answers.push_back(double(base.getParam(BT_CONSTRAINT_STOP_ERP, 5)));
  return answers;
}

TEST(DropInUniversal, SettersAndGettersGiveStocksAnswers) {
  const auto stock = setAndAsk<Stock>(), ours = setAndAsk<Ours>();
  ASSERT_EQ(stock.size(), ours.size());
  // Stock's margin of the limits is a float.
  for (size_t i = 0; i < stock.size(); ++i) EXPECT_NEAR(stock[i], ours[i], 1e-6) << i;
}

TEST(Universal, RefusesBadSettingsAndStaysAsItWas) {
  Random random(5);
  Pair pair = randomPair(random);
  struct Bad {
    const char* field;
    const char* value;
    std::function<void(Ours&)> call;
  };
  std::vector<Bad> bads = {
      {"axis", "6", [](Ours& j) { j.setLimit(6, 0, 0); }},
      {"axis", "6", [](Ours& j) { j.enableMotor(6, true, 1, 1); }},
      {"axis", "0", [](Ours& j) { (void)j.getMotorImpulse(0); }},
      {"axis", "-1", [](Ours& j) { (void)j.isLimited(-1); }},
      {"axis index", "3", [](Ours& j) { (void)j.getAngle(3); }},
      {"axis index", "-1", [](Ours& j) { (void)j.getAxis(-1); }},
      {"axis 3", "0.5", [](Ours& j) { j.setAngularLowerLimit(vec(0.5, 0, 0)); }},
      {"lower limit", "nan",
       [](Ours& j) {
         j.setAngularLowerLimit({0, 0, nan_value});
       }},
      {"upper limit", "nan", [](Ours& j) { j.setUpperLimit(nan_value, 0); }},
      {"upper limit", "nan", [](Ours& j) { j.setUpperLimit(0, nan_value); }},
      {"limit", "nan", [](Ours& j) { j.setLimit(4, nan_value, 0); }},
      {"accumulated", "nan", [](Ours& j) { j.setAccumulatedAngle(5, nan_value); }},
      {"velocity", "inf", [](Ours& j) { j.enableMotor(5, true, infinite, 1); }},
      {"torque", "-1", [](Ours& j) { j.enableMotor(5, true, 1, -1); }},
      {"target", "nan", [](Ours& j) { j.setMotorServo(5, nan_value, 1, 1, 1); }},
      {"frequency", "0", [](Ours& j) { j.setMotorServo(5, 0, 0, 1, 1); }},
      {"damping", "-1", [](Ours& j) { j.setMotorServo(5, 0, 1, -1, 1); }},
      {"torque", "nan", [](Ours& j) { j.setMotorServo(5, 0, 1, 1, nan_value); }},
      {"frequency", "-1", [](Ours& j) { j.setLimitSpring(4, -1, 1); }},
      {"damping", "nan", [](Ours& j) { j.setLimitSpring(4, 1, nan_value); }},
      {"bounce", "-1", [](Ours& j) { j.setLimitBounce(4, -1); }},
      {"friction", "-1", [](Ours& j) { j.setFriction(4, -1); }},
      {"STOP_ERP", "-1", [](Ours& j) { j.setParam(BT_CONSTRAINT_STOP_ERP, -1, 4); }},
      {"CFM", "nan", [](Ours& j) { j.setParam(BT_CONSTRAINT_CFM, nan_value); }},
      {"axis1", "0", [](Ours& j) { j.setAxis(vec(0, 0, 0), vec(0, 1, 0)); }},
      {"axis2", "nan", [](Ours& j) { j.setAxis(vec(0, 0, 1), vec(0, 1, double(nan_value))); }},
      {"right angles", "0.6", [](Ours& j) { j.setAxis(vec(0, 0, 1), vec(0, 0.8, 0.6)); }},
  };
  for (const Bad& bad : bads) {
    SCOPED_TRACE(testing::Message() << bad.field << " = " << bad.value);
    Ours joint(*pair.a, *pair.b, vec(0, 0, 0), vec(0, 0, 1), vec(0, 1, 0));
    Ours twin(*pair.a, *pair.b, vec(0, 0, 0), vec(0, 0, 1), vec(0, 1, 0));
    const std::string message = refusal([&] { bad.call(joint); });
    EXPECT_NE(message.find("UniversalJoint"), std::string::npos) << message;
    EXPECT_NE(message.find(bad.field), std::string::npos) << message;
    EXPECT_NE(message.find(bad.value), std::string::npos) << message;
    EXPECT_EQ(support::SolverRows::ofStep(joint), support::SolverRows::ofStep(twin));
    for (const int axis : {4, 5}) {
      EXPECT_EQ(joint.getLowerLimit(axis), twin.getLowerLimit(axis));
      EXPECT_EQ(joint.getUpperLimit(axis), twin.getUpperLimit(axis));
    }
    EXPECT_EQ(joint.getFlags(), twin.getFlags());
    expectSame(joint.getFrameOffsetA(), twin.getFrameOffsetA(), 0);
    expectSame(joint.getAxis1(), twin.getAxis1(), 0);
  }
  EXPECT_NE(refusal([&] {
              Ours(*pair.a, *pair.b, vec(0, 0, 0), vec(0, 0, 1), vec(0, 1, 1));
            }).find("right angles"),
            std::string::npos);
}

// --- motion --------------------------------------------------------------------------------------

// A cube that turns about its centre against a static one, or against another cube: its inertia is
// the same about any axis.
template <class Joint>
class Rig {
 public:
  static constexpr double inertia = 0.12;  // kg m^2, of each that moves
  static constexpr double dt = 1.0 / 60;

  explicit Rig(bool both = false, int iterations = 10)
      : m_world(0, iterations),
        m_a(m_world.add_box(both ? 2 : 0, vec(0.3, 0.3, 0.3), btTransform::getIdentity())),
        m_b(m_world.add_box(2, vec(0.3, 0.3, 0.3), btTransform::getIdentity())),
        m_joint(m_world.add_joint<Joint>(m_a, m_b, vec(0, 0, 0), vec(0, 0, 1), vec(0, 1, 0))),
        m_turned_1(0),
        m_turned_2(0) {}

  Joint& joint() { return m_joint; }
  btRigidBody& a() { return m_a; }
  btRigidBody& b() { return m_b; }
  btRigidBody& free() { return m_b; }

  void step() {
    m_world.step(dt);
    look();
  }
  /// Takes the angles; from the bodies alone.
  void look() {
    const Eigen::Matrix3d Q = relative();
    m_angle_1 = m_turned_1(std::atan2(Q(0, 1), Q(1, 1)));
    m_angle_2 = m_turned_2(std::atan2(Q(2, 0), Q(2, 2)));
  }
  double angle(int axis) const { return axis == 5 ? m_angle_1 : m_angle_2; }
  /// rad, of the axes off their right angle.
  double error() const { return std::asin(std::min(1.0, std::abs(relative()(2, 1)))); }
  /// Speed of the angle, rad/s.
  double rate(int axis) const {
    return (scenes::to_eigen(m_a.getAngularVelocity()) - scenes::to_eigen(m_b.getAngularVelocity()))
        .dot(direction(axis));
  }
  /// A torque (N m) along the angle, for the next step.
  void push(int axis, double torque) {
    const Eigen::Vector3d along = torque * direction(axis);
    m_a.applyTorque(scenes::to_bullet(along));
    m_b.applyTorque(scenes::to_bullet(-along));
  }
  /// Turns b about the hinges, to these angles.
  void place(double angle_1, double angle_2) {
    const btQuaternion turn =
        btQuaternion(vec(0, 0, 1), scalar(-angle_1)) * btQuaternion(vec(0, 1, 0), scalar(-angle_2));
    m_b.setCenterOfMassTransform(btTransform(turn));
    look();
  }

 private:
  Eigen::Matrix3d relative() const {
    return scenes::rotation(m_a).transpose() * scenes::rotation(m_b);
  }
  Eigen::Vector3d direction(int axis) const {
    return axis == 5 ? scenes::direction_in_world(m_a, {0, 0, 1})
                     : scenes::direction_in_world(m_b, {0, 1, 0});
  }

  scenes::World m_world;
  btRigidBody& m_a;
  btRigidBody& m_b;
  Joint& m_joint;
  scenes::Unwrap m_turned_1, m_turned_2;
  double m_angle_1 = 0, m_angle_2 = 0;
};

TEST(DropInUniversal, MotorsGoStocksWayWithStocksTorque) {
  if (BT_BULLET_VERSION < 289) GTEST_SKIP() << "there a bound of a motor is an impulse in a step";
  for (const int axis : {4, 5}) {
    for (const double velocity : {2., -2.}) {
      SCOPED_TRACE(testing::Message() << "axis " << axis << ", " << velocity);
      const auto run = [&](auto& rig, double torque) {
        setFree(rig.joint());
        drive(rig.joint(), axis, velocity, torque);
        std::vector<double> rates;
        for (int i = 0; i < 30; ++i) {
          rig.step();
          rates.push_back(rig.rate(axis));
        }
        return rates;
      };
      for (const double torque : {100., 0.06}) {
        Rig<Stock> stock;
        Rig<Ours> ours;
        const auto expected = run(stock, torque), got = run(ours, torque);
        for (size_t i = 0; i < got.size(); ++i) EXPECT_NEAR(expected[i], got[i], 100 * rounding);
        // Saturated: the torque, not an impulse, of m_maxMotorForce.
        const double wanted = std::min(2., 30 * Rig<Ours>::dt * torque / Rig<Ours>::inertia);
        EXPECT_NEAR(got.back(), std::copysign(wanted, velocity), 100 * rounding);
      }
    }
  }
}

TEST(Universal, MotorOfAngle1DrivesTheAngleAtAnyBend) {
  for (const double bend : {0., 0.7, 1.3, 1.57, 2.5}) {
    Rig<Ours> rig;
    setFree(rig.joint());
    rig.place(0, bend);
    rig.joint().setLimit(4, scalar(bend), scalar(bend));
    rig.joint().enableMotor(5, true, 2, 100);
    for (int i = 0; i < 90; ++i) rig.step();
    EXPECT_NEAR(rig.angle(5), 3, 1e-3) << bend;
    EXPECT_NEAR(rig.angle(4), bend, 1e-3) << bend;
  }
}

TEST(DropInUniversal, LimitsHoldWhereStocksDoAndSooner) {
  for (const bool both : {false, true}) {
    for (const int axis : {4, 5}) {
      for (const double way : {1., -1.}) {
        SCOPED_TRACE(testing::Message() << "axis " << axis << ", way " << way << ", both " << both);
        const auto run = [&](auto& rig, double& overshoot) {
          rig.joint().setLimit(axis, scalar(-0.4), scalar(0.6));
          for (int i = 0; i < 120; ++i) {
            rig.push(axis, way * 0.5);
            rig.step();
            overshoot = std::max({overshoot, rig.angle(axis) - 0.6, -0.4 - rig.angle(axis)});
          }
          return rig.angle(axis);
        };
        Rig<Stock> stock(both);
        Rig<Ours> ours(both);
        double stock_overshoot = 0, overshoot = 0;
        const double expected = run(stock, stock_overshoot), got = run(ours, overshoot);
        const double limit = way > 0 ? 0.6 : -0.4;
        EXPECT_NEAR(got, limit, 1e-4);
        // Stock rests a little beyond.
        EXPECT_NEAR(expected, limit, 3e-3);
        EXPECT_LT(overshoot, 1e-4);
        EXPECT_GT(stock_overshoot, 1e-3) << "this test proves nothing";
      }
    }
  }
}

TEST(Universal, LimitsBeyondStocksRangeHold) {
  struct Range {
    double low, high;
  };
  for (const Range& range : {Range{-2.2, 2.2}, {-pi, pi}, {-1, 7}, {-20, 12}}) {
    for (const int axis : {4, 5}) {
      SCOPED_TRACE(testing::Message() << axis << ": " << range.low << " to " << range.high);
      Rig<Ours> rig;
      setFree(rig.joint());
      rig.joint().setAccumulatedLimit(axis, scalar(range.low), scalar(range.high));
      for (const double way : {1., -1.}) {
        double overshoot = 0, error = 0, away = 0;
        for (int i = 0; i < 400; ++i) {
          rig.push(axis, way * 0.3);
          rig.step();
          overshoot =
              std::max({overshoot, rig.angle(axis) - range.high, range.low - rig.angle(axis)});
          error = std::max(error, rig.error());
          away = std::max(away, std::abs(rig.angle(9 - axis)));
          EXPECT_NEAR(rig.joint().getAccumulatedAngle(axis), rig.angle(axis), 1e-4);
        }
        EXPECT_NEAR(rig.angle(axis), way > 0 ? range.high : range.low, 1e-3);
        EXPECT_LT(overshoot, 1e-3);
        EXPECT_LT(error, 1e-4);
        EXPECT_LT(away, 1e-3) << "the other angle moved";
      }
    }
  }
}

// At a quarter of a turn stock's angles have their pole: it throws the body about.
TEST(Universal, NothingHappensAtAQuarterTurnWhereStockKicks) {
  const auto run = [](auto& rig, double& fastest) {
    setFree(rig.joint());
    drive(rig.joint(), 4, 1, 100);
    for (int i = 0; i < 600; ++i) {
      rig.step();
      fastest = std::max(fastest, double(rig.b().getAngularVelocity().length()));
    }
    return rig.angle(4);
  };
  Rig<Stock> stock;
  Rig<Ours> ours;
  double stock_fastest = 0, fastest = 0;
  EXPECT_GT(std::abs(run(stock, stock_fastest) - 10), 1);
  EXPECT_GT(stock_fastest, 2);
  EXPECT_NEAR(run(ours, fastest), 10, 1e-3);
  EXPECT_NEAR(fastest, 1, 1e-3);
}

TEST(Universal, ALimitBeyondAQuarterTurnHoldsWhereStockTearsItsBodiesAbout) {
  const auto fastest = [](auto& rig) {
    rig.joint().setLimit(4, scalar(-2.2), scalar(2.2));
    double most = 0;
    for (int i = 0; i < 120; ++i) {
      rig.push(4, 0.3);
      rig.step();
      most = std::max(most, double(rig.b().getAngularVelocity().length()));
    }
    return most;
  };
  Rig<Stock> stock;
  Rig<Ours> ours;
  EXPECT_GT(fastest(stock), 10);
  EXPECT_LT(fastest(ours), 5);
  EXPECT_NEAR(ours.angle(4), 2.2, 1e-4);
}

TEST(Universal, ALimitOfLessThanATurnHoldsInTheTurnOfTheJoint) {
  Rig<Ours> rig;
  setFree(rig.joint());
  rig.joint().enableMotor(5, true, 6, 100);
  for (int i = 0; i < 180; ++i) rig.step();  // 18 rad
  rig.joint().enableMotor(5, false);
  const double within = std::remainder(rig.angle(5), 2 * pi);
  rig.joint().setLimit(5, scalar(within - 0.5), scalar(within + 0.5));
  EXPECT_NEAR(rig.joint().getAccumulatedAngle(5), within, 1e-3);
  const double before = rig.angle(5);
  for (int i = 0; i < 60; ++i) rig.step();
  EXPECT_NEAR(rig.angle(5), before + 0.5, 1e-3);
  // Told which turn it is in, the limit is taken as it stands.
  rig.joint().setAccumulatedAngle(5, scalar(within + 0.5 + 8 * pi));
  rig.joint().setLimit(5, scalar(within), scalar(within + 1));
  EXPECT_NEAR(rig.joint().getAccumulatedAngle(5), within + 0.5 + 8 * pi, 1e-3);
}

// One implicit Euler step of x'' = -w^2 x - 2 z w x'. On the exact solver the spring, which the step resolves, pulls by where it is.
void euler(double& x, double& v, double w, double z, double h) {
  const double share = onExactSolver() ? 0 : 1;
  v = (v - h * w * w * x) / (1 + 2 * z * w * h + share * w * w * h * h);
  x += h * v;
}

TEST(Universal, ServosAndLimitSpringsAreSpringsAboutTheTrueInertia) {
  for (const int axis : {4, 5}) {
    for (const bool servo : {true, false}) {
      SCOPED_TRACE(testing::Message() << axis << (servo ? ", servo" : ", limit spring"));
      Rig<Ours> rig;
      rig.place(axis == 5 ? 0.5 : 0, axis == 4 ? 0.5 : 0);
      if (servo) {
        rig.joint().setMotorServo(axis, 0, 2, scalar(0.3), infinite);
      } else {
        rig.joint().setLimit(axis, 0, 0);
        rig.joint().setLimitSpring(axis, 2, scalar(0.3));
      }
      double x = 0.5, v = 0;
      for (int i = 0; i < 120; ++i) {
        rig.step();
        euler(x, v, 4 * pi, 0.3, Rig<Ours>::dt);
        ASSERT_NEAR(rig.angle(axis), x, is_double ? 1e-6 : 1e-4) << i;
      }
    }
  }
}

TEST(Universal, ALimitsBounceIsThePartOfTheSpeedThatComesBack) {
  for (const double bounce : {0., 0.5, 1.}) {
    Rig<Ours> rig;
    rig.joint().setLimit(5, -1, scalar(0.5));
    rig.joint().setLimitBounce(5, scalar(bounce));
    rig.b().setAngularVelocity(vec(0, 0, -3));
    double back = 0;
    for (int i = 0; i < 20; ++i) {
      rig.step();
      back = std::max(back, -rig.rate(5));
    }
    EXPECT_NEAR(back, 3 * bounce, 1e-3) << bounce;
  }
}

TEST(Universal, FrictionHoldsUpToItsTorqueAndTakesItAwayBeyond) {
  for (const int axis : {4, 5}) {
    Rig<Ours> rig;
    setFree(rig.joint());
    rig.joint().setFriction(axis, scalar(0.2));
    for (int i = 0; i < 60; ++i) {
      rig.push(axis, 0.19);
      rig.step();
    }
    EXPECT_NEAR(rig.angle(axis), 0, 1e-5);
    for (int i = 0; i < 30; ++i) {
      rig.push(axis, 0.5);
      rig.step();
    }
    EXPECT_NEAR(rig.rate(axis), 0.5 * 0.3 / Rig<Ours>::inertia, 1e-3);
    EXPECT_NEAR(rig.joint().getFrictionImpulse(axis), -0.2 * Rig<Ours>::dt, 1e-5);
  }
}

// Everything acts on both axes at once: the parts are what Newton asks for.
TEST(Universal, ImpulsesOfThePartsAddUp) {
  Rig<Ours> rig;
  for (const int axis : {4, 5}) {
    rig.joint().setLimit(axis, -1, scalar(0.3));
    rig.joint().enableMotor(axis, true, 5, scalar(0.4));
    rig.joint().setFriction(axis, scalar(0.1));
  }
  for (int i = 0; i < 90; ++i) {
    const double before_4 = rig.rate(4), before_5 = rig.rate(5);
    rig.push(4, 0.05);
    rig.push(5, 0.05);
    rig.step();
    if (i < 3) {
      // Not bent yet, so that the axes do not feel each other.
      for (const auto& [axis, before] : {std::pair(4, before_4), {5, before_5}}) {
        const double sum = double(rig.joint().getMotorImpulse(axis)) +
                           double(rig.joint().getLimitImpulse(axis)) +
                           double(rig.joint().getFrictionImpulse(axis));
        EXPECT_NEAR(sum + 0.05 * Rig<Ours>::dt, Rig<Ours>::inertia * (rig.rate(axis) - before),
                    1e-4)
            << axis << ", step " << i;
      }
    }
  }
  // At rest on both limits, where the motor has slowed down as Bullet's do: against a push beyond
  // what friction holds, the limit has the rest.
  const double dt = Rig<Ours>::dt;
  for (int i = 0; i < 30; ++i) {
    rig.push(4, 0.7);
    rig.push(5, 0.7);
    rig.step();
  }
  for (const int axis : {4, 5}) {
    SCOPED_TRACE(axis);
    EXPECT_NEAR(rig.angle(axis), 0.3, 1e-4);
    EXPECT_LE(std::abs(rig.joint().getFrictionImpulse(axis)), 0.1 * dt + 1e-6);
    EXPECT_LE(std::abs(rig.joint().getMotorImpulse(axis)), 0.4 * dt + 1e-6);
    EXPECT_LE(rig.joint().getLimitImpulse(axis), -0.2 * dt + 2e-5);
    EXPECT_NEAR(rig.joint().getLimitImpulse(axis) + rig.joint().getFrictionImpulse(axis) +
                    rig.joint().getMotorImpulse(axis),
                -0.7 * dt, 2e-5);
  }
}

TEST(Universal, AngularOnlyLetsTheAnchorsGo) {
  Rig<Ours> rig;
  rig.joint().setAngularOnly(true);
  rig.b().setLinearVelocity(vec(1, 0, 0));
  rig.b().setAngularVelocity(vec(3, 0, 0));  // about the normal of both axes: held
  for (int i = 0; i < 60; ++i) rig.step();
  EXPECT_NEAR(rig.b().getCenterOfMassPosition().x(), 1, 1e-4);
  EXPECT_NEAR(rig.error(), 0, 1e-5);
  EXPECT_NEAR(rig.b().getAngularVelocity().x(), 0, 1e-5);
}

TEST(DropInUniversal, FeedbackAndBreakingAreStocks) {
  const auto feedback = [](auto& rig, btJointFeedback& out) {
    rig.joint().setJointFeedback(&out);
    rig.joint().enableFeedback(true);
    for (int i = 0; i < 60; ++i) {
      rig.b().applyCentralForce(vec(1, 2, 3));
      rig.b().applyTorque(vec(0.5, 0, 0));
      rig.step();
    }
  };
  Rig<Stock> stock;
  Rig<Ours> ours;
  btJointFeedback expected, got;
  feedback(stock, expected);
  feedback(ours, got);
  expectSame(expected.m_appliedForceBodyA, got.m_appliedForceBodyA, 1e-3);
  expectSame(expected.m_appliedForceBodyB, got.m_appliedForceBodyB, 1e-3);
  expectSame(expected.m_appliedTorqueBodyA, got.m_appliedTorqueBodyA, 1e-3);
  expectSame(expected.m_appliedTorqueBodyB, got.m_appliedTorqueBodyB, 1e-3);
  expectSame(got.m_appliedForceBodyB, vec(-1, -2, -3), 1e-3);

  const auto breaks = [](auto& rig, const btVector3& force, const btVector3& torque) {
    rig.joint().setBreakingImpulseThreshold(scalar(0.5));
    return support::stepOfBreaking(rig, rig.joint(), force, torque);
  };
  // A force along an axis of the world, and a torque about the normal of both axes.
  for (const auto& [force, torque] : {std::pair(vec(1, 0, 0), vec(0, 0, 0)),
                                      {vec(0, 0, -1), vec(0, 0, 0)},
                                      {vec(0, 0, 0), vec(1, 0, 0)}}) {
    Rig<Stock> stock_rig;
    Rig<Ours> our_rig;
    const int step = breaks(stock_rig, force, torque);
    EXPECT_GT(step, 10);
    EXPECT_NEAR(breaks(our_rig, force, torque), step, 1);
  }
}

// From any start, within the limits as constructed: soon, and gently.
TEST(Universal, ComesBackFromAnyStartWhereStockDoesNot) {
  const auto run = [](auto& rig, double& fastest) {
    int steps = -1;
    for (int i = 1; i <= 300; ++i) {
      rig.step();
      fastest = std::max({fastest, double(rig.b().getAngularVelocity().length()),
                          double(rig.a().getAngularVelocity().length())});
      const bool back =
          rig.error() < scenes::radians(1) &&
          std::abs(std::remainder(rig.angle(4), 2 * pi)) < pi / 2 - 0.01 + scenes::radians(1);
      if (!back) steps = -1;
      if (back && steps < 0) steps = i;
    }
    return steps;
  };
  Random random(6);
  int stock_never = 0;
  for (int n = 0; n < 100; ++n) {
    const btQuaternion turn(random.unit(), scalar(random.uniform(-pi, pi)));
    const auto start = [&](auto& rig) {
      rig.b().setCenterOfMassTransform(btTransform(turn));
      rig.joint().setFrames(btTransform::getIdentity(), btTransform::getIdentity());
      rig.look();
    };
    Rig<Stock> stock(true);
    Rig<Ours> ours(true);
    start(stock);
    start(ours);
    double stock_fastest = 0, fastest = 0;
    stock_never += run(stock, stock_fastest) < 0;
    const int steps = run(ours, fastest);
    EXPECT_GT(steps, 0) << n;
    EXPECT_LE(steps, 45) << n;
    EXPECT_LE(fastest, 12) << n;
  }
  EXPECT_GT(stock_never, 10);
}

TEST(Universal, DrawsFramesAndRangesAsTheModeSays) {
  Random random(7);
  Pair pair = randomPair(random);
  Ours joint(*pair.a, *pair.b, vec(0, 0, 0), vec(0, 0, 1), vec(0, 1, 0));
  joint.setDbgDrawSize(1);
  EXPECT_EQ(drawing::linesOf(joint, btIDebugDraw::DBG_NoDebug), 0);
  EXPECT_EQ(drawing::linesOf(joint, btIDebugDraw::DBG_DrawConstraints), 6);
  const int ranges = drawing::linesOf(joint, btIDebugDraw::DBG_DrawConstraintLimits);
  EXPECT_GT(ranges, 20);
  joint.setLimit(5, 0, 0);
  const int one = drawing::linesOf(joint, btIDebugDraw::DBG_DrawConstraintLimits);
  EXPECT_GT(one, 5);
  EXPECT_LT(one, ranges);
  joint.setLimit(4, -infinite, infinite);
  EXPECT_GT(drawing::linesOf(joint, btIDebugDraw::DBG_DrawConstraintLimits), 5);
}

// --- speed over a turn ---------------------------------------------------------------------------

// The ratio of the speeds is cos b / (1 - sin^2 b cos^2 th): its integral is how far the driven
// shaft has turned.
TEST(Universal, SpeedOverATurnIsTheClosedForm) {
  for (const double bend : {5., 20., 30., 45., 60.}) {
    scenes::DriveShaftSettings settings;
    settings.bend = scenes::radians(bend);
    settings.rpm = 20;  // 2 degrees a step
    const scenes::DriveShaftResult ours = scenes::drive_shaft<Ours>(settings);
    const scenes::DriveShaftResult stock = scenes::drive_shaft<Stock>(settings);
    SCOPED_TRACE(bend);
    // Second order in the step: the joint looks ahead by the curvature. Stock is of first order.
    EXPECT_LT(ours.universal_error, 1e-3);
    EXPECT_LT(ours.universal_error, 0.5 * stock.universal_error);
    const double b = settings.bend;
    EXPECT_NEAR(ours.min, std::cos(b), 2e-3);
    EXPECT_NEAR(ours.max, 1 / std::cos(b), 1e-2);
    EXPECT_LT(ours.max_gap, 1e-5);
  }
}

// A sixth to a half of a right angle a step, where the curvature is that of the step's middle no more.
TEST(Universal, FastShaftsAreNearerToTheClosedFormThanStocks) {
  for (const auto& [rpm, hz] : {std::pair(150., 60.), {300., 60.}, {400., 60.}, {1000., 240.}}) {
    for (const double bend : {5., 20., 40., 60.}) {
      scenes::DriveShaftSettings settings;
      settings.bend = scenes::radians(bend);
      settings.rpm = rpm;
      settings.dt = 1 / hz;
      const double ours = scenes::drive_shaft<Ours>(settings).universal_error;
      const double stock = scenes::drive_shaft<Stock>(settings).universal_error;
      EXPECT_LT(ours, 0.8 * stock) << rpm << " rpm, " << bend << " deg";
    }
  }
}

}  // namespace universal_joint_test
