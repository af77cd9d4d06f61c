// How joints of six degrees of freedom move: springs by their closed form, rest as Bullet's, limits of each way to turn, and past the
// pole of Euler angles.
#include <gtest/gtest.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/generic_6dof_joint.h>
#include <pintle/joints/generic_6dof_spring_2_joint.h>
#include <pintle/joints/generic_6dof_spring_joint.h>
#include <pintle/joints/hinge_2_joint.h>
#include <pintle/joints/universal_joint.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "kinetic_energy.h"
#include "solver_of_tests.h"
#include "support.h"

namespace six_dof_joint_test {
namespace {

using pintle::Generic6DofJoint;
using pintle::Generic6DofSpring2Joint;
using pintle::Generic6DofSpringJoint;
using scenes::pi;
using support::is_double;
using support::scalar;
using support::vec;

constexpr double g = 9.81, dt = 1. / 60;

template <class J>
J& join(scenes::World& world, btRigidBody& a, btRigidBody& b, const btTransform& in_a,
        const btTransform& in_b, int order = RO_XYZ) {
  if constexpr (std::is_base_of_v<btGeneric6DofSpring2Constraint, J>)
    return world.add_joint<J>(a, b, in_a, in_b, RotateOrder(order));
  else
    return world.add_joint<J>(a, b, in_a, in_b, true);
}

// A body of 1 kg on a post. Positions are locked and angles free, until told otherwise.
template <class J>
struct Arm {
  scenes::World world;
  btRigidBody &post, &body;
  J& joint;

  explicit Arm(double gravity = g, const btVector3& lever = vec(0, 0, 0), int order = RO_XYZ,
               int iterations = 10)
      : world(gravity, iterations),
        post(world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)))),
        body(world.add_box(1, vec(0.1, 0.2, 0.3), scenes::pose_at(lever))),
        joint(join<J>(world, post, body, btTransform::getIdentity(), scenes::pose_at(-lever),
                      order)) {}
  void lock(std::initializer_list<int> axes, double at = 0) {
    for (const int i : axes) joint.setLimit(i, scalar(at), scalar(at));
  }
  void free(std::initializer_list<int> axes) {
    for (const int i : axes) joint.setLimit(i, 1, -1);
  }
  void limit(std::initializer_list<int> axes, double low, double high) {
    for (const int i : axes) joint.setLimit(i, scalar(low), scalar(high));
  }
  void run(double seconds) {
    for (int i = 0; i < std::lround(seconds / dt); ++i) world.step(dt);
    joint.calculateTransforms();
  }
  double angle(int i) { return double(joint.getAngle(i)); }
  double position(int i) { return double(joint.getRelativePivotPosition(i)); }
};

template <class J>
void spring(J& joint, int axis, double stiffness, double damping) {
  joint.enableSpring(axis, true);
  if constexpr (std::is_base_of_v<btGeneric6DofSpring2Constraint, J>) {
    joint.setStiffness(axis, scalar(stiffness), false);
    joint.setDamping(axis, scalar(damping), false);
  } else {
    joint.setStiffness(axis, scalar(stiffness));
    joint.setDamping(axis, scalar(damping));
  }
}

// --- springs ------------------------------------------------------------------------------------

TEST(SixDofSpring, FollowsTheImplicitEulerRuleAtAnyStiffnessAndNumberOfIterations) {
  PINTLE_SKIP_ON_EXACT_SOLVER(
      "a spring that steps resolve swings without the damping of that rule");
  const double most = is_double ? 1e9 : 1e6;
  for (const int iterations : {1, 3, 10})
    for (double k = 1e-3; k <= most; k *= 10)
      for (const double damping : {0., 0.5}) {
        SCOPED_TRACE(testing::Message()
                     << iterations << " iterations, k = " << k << ", " << damping);
        Arm<Generic6DofSpring2Joint> arm(g, vec(0, 0, 0), RO_XYZ, iterations);
        arm.lock({0, 1, 3, 4, 5});
        arm.free({2});
        spring(arm.joint, 2, k, damping);
        double x = 0, v = 0, worst = 0, size = 0;
        for (int i = 0; i < 200; ++i) {
          v = (v - g * dt - dt * k * x) / (1 + dt * damping + dt * dt * k);
          x += dt * v;
          arm.world.step(dt);
          size = std::max(size, std::abs(x));
          worst = std::max(worst, std::abs(double(arm.body.getCenterOfMassPosition().z()) - x));
        }
        // The digits that are left of a load by a stiff spring are those of its body's speed in a step.
        EXPECT_LE(worst, (is_double ? 1e-12 : 2e-4) * size + (is_double ? 1e-15 : 1e-8));
      }
}

TEST(SixDofSpring, SagsByItsLoadAtAnyStep) {
  for (const double hertz : {30., 60., 240.})
    for (const double k : {100., 1000., 40000.}) {
      SCOPED_TRACE(testing::Message() << hertz << " Hz, k = " << k);
      Arm<Generic6DofSpring2Joint> arm;
      arm.lock({0, 1, 3, 4, 5});
      arm.free({2});
      spring(arm.joint, 2, k, std::sqrt(k));
      for (int i = 0; i < 5 * hertz; ++i) arm.world.step(1 / hertz);
      EXPECT_NEAR(-double(arm.body.getCenterOfMassPosition().z()) * k / g, 1,
                  is_double ? 1e-6 : 1e-3);
    }
}

// The number is Bullet's, which has no unit: the amplitude after a swing says what it does.
TEST(SixDofSpring, TheFirstKindIsDampedAsBulletsIs) {
  PINTLE_SKIP_ON_EXACT_SOLVER("Bullet's spring is compared on Bullet's solver");
  const auto swing = [](auto arm_type, double damping) {
    using J = decltype(arm_type);
    Arm<typename J::type> arm(0);
    arm.lock({0, 1, 3, 4, 5});
    arm.free({2});
    spring(arm.joint, 2, 1, damping);
    arm.body.setCenterOfMassTransform(scenes::pose_at(vec(0, 0, 1)));
    arm.run(2 * pi);
    return double(arm.body.getCenterOfMassPosition().z());
  };
  struct Stock {
    using type = btGeneric6DofSpringConstraint;
  };
  struct Ours {
    using type = Generic6DofSpringJoint;
  };
  for (const double damping : {0.05, 0.1, 0.2, 0.3, 0.5, 1.})
    EXPECT_NEAR(swing(Ours(), damping), swing(Stock(), damping), 0.07) << damping;
}

template <class J>
std::vector<double> rest(int order, int locked) {
  Arm<J> arm(g, vec(0.3, 0.4, -0.2), order, 50);
  for (int i = 0; i < 3; ++i) {
    arm.joint.setEquilibriumPoint(3 + i, scalar(0.1 + 0.1 * i));
    if ((locked >> i & 1) != 0)
      arm.lock({3 + i});
    else
      spring(arm.joint, 3 + i, 20, 1.5);
  }
  arm.body.setDamping(scalar(0.3), scalar(0.3));
  for (int i = 0; i < 3000; ++i) arm.world.step(1. / 240);
  arm.joint.calculateTransforms();
  return {arm.angle(0), arm.angle(1), arm.angle(2)};
}

TEST(SixDofSpring, AnglesRestWhereBulletsDo) {
  for (int order = RO_XYZ; order <= RO_ZYX; ++order)
    for (const int locked : {0, 1, 2, 4, 5}) {
      SCOPED_TRACE(testing::Message() << "order " << order << ", locked " << locked);
      const auto ours = rest<Generic6DofSpring2Joint>(order, locked),
                 stock = rest<btGeneric6DofSpring2Constraint>(order, locked);
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(ours[size_t(i)], stock[size_t(i)], 1e-3) << i;
    }
}

TEST(SixDofSpring, ActsBesideALimitAndAMotor) {
  Arm<Generic6DofSpring2Joint> arm;
  arm.lock({0, 1, 3, 4, 5});
  arm.limit({2}, -0.05, 1);
  spring(arm.joint, 2, 100, 20);  // would sag by 0.098
  arm.run(3);
  EXPECT_NEAR(arm.position(2), -0.05, 1e-3);
  arm.joint.enableMotor(2, true);
  arm.joint.setTargetVelocity(2, -1);  // as in Bullet of a against b
  arm.joint.setMaxMotorForce(2, 12);
  arm.run(3);
  EXPECT_NEAR(arm.position(2), (12 - g) / 100, 1e-3);
}

// --- locks ---------------------------------------------------------------------------------------

template <class J>
class SixDof : public testing::Test {};
using Types = testing::Types<Generic6DofJoint, Generic6DofSpringJoint, Generic6DofSpring2Joint>;
TYPED_TEST_SUITE(SixDof, Types);

TYPED_TEST(SixDof, ALockedAxisHoldsFromTheFirstStep) {
  Arm<TypeParam> arm;
  arm.lock({0, 1, 2, 3, 4, 5});
  arm.world.step(dt);
  EXPECT_LT(double(arm.body.getCenterOfMassPosition().length()), is_double ? 1e-12 : 1e-6);
  if (onExactSolver()) return;
  Arm<btGeneric6DofConstraint> stock;  // Bullet's falls
  stock.lock({0, 1, 2, 3, 4, 5});
  stock.world.step(dt);
  EXPECT_GT(double(stock.body.getCenterOfMassPosition().length()), 2e-3);
}

TYPED_TEST(SixDof, AxesAreLockedAtAnyValue) {
  for (int free = 0; free < 4; ++free) {
    Arm<TypeParam> arm(g, vec(0.3, 0.4, -0.2));
    const double values[] = {0.1, 0.2, -0.3, 0.3, -0.4, 0.5};
    for (int i = 0; i < 6; ++i) arm.lock({i}, values[i]);
    if (free < 3) arm.free({3 + free});
    arm.run(6);
    for (int i = 0; i < 6; ++i) {
      if (i == 3 + free) continue;
      EXPECT_NEAR(i < 3 ? arm.position(i) : arm.angle(i - 3), values[i], 2e-3) << i << ", " << free;
    }
  }
}

// By its settings it is a fixed joint, or a universal one.
TYPED_TEST(SixDof, MovesAsTheJointThatItsSettingsAre) {
  const auto drop = [](auto& joint, btRigidBody& body, scenes::World& world) {
    (void)joint;
    std::vector<double> all;
    for (int i = 0; i < 60; ++i) {
      world.step(dt);
      for (int k = 0; k < 3; ++k) all.push_back(double(body.getCenterOfMassPosition()[k]));
    }
    return all;
  };
  for (const bool fixed : {true, false}) {
    Arm<TypeParam> arm(g, vec(0.3, 0.4, -0.2));
    fixed ? arm.lock({3, 4, 5}) : arm.lock({3});
    if (!fixed) arm.limit({4, 5}, -0.5, 0.5);
    const auto got = drop(arm.joint, arm.body, arm.world);
    scenes::World world(g);
    btRigidBody &post = world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0))),
                &body = world.add_box(1, vec(0.1, 0.2, 0.3), scenes::pose_at(vec(0.3, 0.4, -0.2)));
    const btTransform in_b = scenes::pose_at(vec(-0.3, -0.4, 0.2));
    std::vector<double> expected;
    if (fixed) {
      expected =
          drop(world.add_joint<pintle::FixedJoint>(post, body, btTransform::getIdentity(), in_b),
               body, world);
    } else {
      auto& joint =
          world.add_joint<pintle::UniversalJoint>(post, body, btTransform::getIdentity(), in_b);
      for (const int i : {4, 5}) joint.setLimit(i, scalar(-0.5), scalar(0.5));
      expected = drop(joint, body, world);
    }
    for (size_t i = 0; i < got.size(); ++i)
      EXPECT_NEAR(got[i], expected[i], is_double ? 1e-3 : 1e-2) << i;
  }
}

// --- limits --------------------------------------------------------------------------------------

TYPED_TEST(SixDof, AHingeCountsItsTurns) {
  for (int axis = 3; axis < 6; ++axis) {
    Arm<TypeParam> arm(0);
    arm.lock({3, 4, 5});
    arm.limit({axis}, -pi, pi);
    btVector3 turn(0, 0, 0);
    turn[axis - 3] = -10;  // of b: Bullet's angle is that of a
    arm.body.setAngularVelocity(turn);
    arm.run(3);
    EXPECT_NEAR(double(arm.joint.getAccumulatedAngle(axis)), 30, 0.1);
    EXPECT_NEAR(double(arm.body.getAngularVelocity().length()), 10, 1e-2);
    const double here = double(arm.joint.getAccumulatedAngle(axis));
    // A limit holds in the turn that the joint is in, which is counted as the limit's.
    const double middle = std::remainder(here, 2 * pi);
    arm.limit({axis}, middle - 0.3, middle + 0.3);
    arm.run(1);
    EXPECT_NEAR(double(arm.joint.getAccumulatedAngle(axis)), middle, 0.31);
  }
}

TYPED_TEST(SixDof, LimitsHoldWhateverIsLocked) {
  for (int locked = 0; locked < 8; ++locked) {
    SCOPED_TRACE(locked);
    Arm<TypeParam> arm(g, vec(0.3, 0.4, -0.2));
    for (int i = 0; i < 3; ++i) {
      if ((locked >> i & 1) != 0)
        arm.lock({3 + i});
      else
        arm.limit({3 + i}, -0.2, 0.3);
    }
    arm.run(4);
    for (int i = 0; i < 3; ++i) {
      EXPECT_LE(arm.angle(i), 0.301) << i;
      EXPECT_GE(arm.angle(i), -0.201) << i;
    }
    EXPECT_LT(double(arm.body.getAngularVelocity().length()), 0.02);
  }
}

TYPED_TEST(SixDof, ABoxOfPositionsHolds) {
  Arm<TypeParam> arm(g);
  arm.lock({3, 4, 5});
  arm.limit({0, 1, 2}, -0.2, 0.3);
  arm.body.setLinearVelocity(vec(2, -3, 1));
  arm.run(3);
  EXPECT_NEAR(arm.position(0), 0.3, 1e-3);
  EXPECT_NEAR(arm.position(1), -0.2, 1e-3);
  EXPECT_NEAR(arm.position(2), -0.2, 1e-3);
}

// --- past the pole --------------------------------------------------------------------------------

double energyOf(const btRigidBody& body) {
  return support::kineticEnergy(body, body.getCenterOfMassTransform().getBasis());
}

// As a body with small limits about x and z that turns freely about y.
template <class J>
double topEnergy(double start_x, double start_z, double& top_speed) {
  Arm<J> arm(0);
  arm.limit({3, 5}, -0.1, 0.1);
  arm.body.setAngularVelocity(vec(start_x, 2, start_z));
  const double before = energyOf(arm.body);
  double top = 0;
  for (int i = 0; i < 1200; ++i) {
    arm.world.step(dt);
    top = std::max(top, energyOf(arm.body));
    top_speed = std::max(top_speed, double(arm.body.getAngularVelocity().length()));
  }
  return top / before;
}

TYPED_TEST(SixDof, TurnsOnPastNinetyDegreesWithoutAJump) {
  for (const double x : {0., 0.01, 0.2})
    for (const double z : {0., -0.03, 0.3}) {
      double speed = 0;
      EXPECT_LT(topEnergy<TypeParam>(x, z, speed), 1.02) << x << ", " << z;
      EXPECT_LT(speed, 2.1);
    }
  if (onExactSolver()) return;
  double stock = 0;
  EXPECT_GT(topEnergy<btGeneric6DofConstraint>(0.01, -0.03, stock), 100);
  EXPECT_GT(stock, 20);
}

// At the pole itself the turn about it is that of both outer angles.
TYPED_TEST(SixDof, HoldsTheTurnAboutThePole) {
  Arm<TypeParam> arm(0);
  arm.limit({3, 5}, -0.1, 0.1);
  arm.body.setAngularVelocity(vec(0, 2, 0));
  while (double(arm.body.getCenterOfMassTransform().getBasis().getColumn(0).z()) > -0.9999)
    arm.world.step(dt);
  arm.body.setAngularVelocity(vec(0, 0, 0));
  const btMatrix3x3 before = arm.body.getCenterOfMassTransform().getBasis();
  for (int i = 0; i < 300; ++i) {
    arm.body.applyTorque(vec(0, 0, 0.2));
    arm.world.step(dt);
  }
  const btVector3 y = arm.body.getCenterOfMassTransform().getBasis().getColumn(1);
  EXPECT_LT(double(y.angle(before.getColumn(1))), 0.35);
}

// As a game does, which puts a body back to where it began.
TYPED_TEST(SixDof, ABodyThatIsPutBackFromBeyondThePoleStaysThere) {
  for (const double seconds : {0.75, 0.8, 1.2, 2.5}) {
    Arm<TypeParam> arm(0);
    arm.limit({3, 5}, -0.1, 0.1);
    arm.body.setAngularVelocity(vec(0, 2, 0));
    arm.run(seconds);
    arm.body.setCenterOfMassTransform(scenes::pose_at(vec(0, 0, 0)));
    arm.body.setAngularVelocity(vec(0, 0, 0));
    arm.run(1);
    EXPECT_LT(double(arm.body.getAngularVelocity().length()), 1e-3) << seconds;
    EXPECT_NEAR(arm.angle(1), 0, 1e-3) << seconds;
  }
}

TYPED_TEST(SixDof, ALimitThatComesAfterOthersWereFreeFindsTheAngles) {
  Arm<TypeParam> arm(0);
  arm.body.setAngularVelocity(vec(0.3, 2, 0.5));
  arm.run(4);
  const double here = arm.angle(0);
  arm.limit({3}, here - 0.5, here + 0.5);
  double top = 0;
  for (int i = 0; i < 60; ++i) {
    arm.world.step(dt);
    top = std::max(top, double(arm.body.getAngularVelocity().length()));
  }
  EXPECT_LT(top, 3.5);
}

TYPED_TEST(SixDof, SwitchingAnAxisMovesNothing) {
  Arm<TypeParam> arm(0, vec(0.1, 0, 0));
  arm.body.setAngularVelocity(vec(0.1, -0.2, 0.3));
  support::Random random(5);
  double top = 0;
  for (int i = 0; i < 300; ++i) {
    arm.joint.calculateTransforms();
    // Where it is, or around.
    const int axis = 3 + i % 3, kind = i / 3 % 3;
    const double here = arm.angle(axis - 3);
    kind == 0   ? arm.lock({axis}, here)
    : kind == 1 ? arm.limit({axis}, here - 0.1, here + 0.2)
                : arm.free({axis});
    if (i % 20 == 0) arm.body.setAngularVelocity(random.vector(0.3));
    arm.world.step(dt);
    top = std::max(top, double(arm.body.getAngularVelocity().length()));
  }
  EXPECT_LT(top, 0.6);
}

// --- motors --------------------------------------------------------------------------------------

template <class J>
std::vector<double> drive(int axis, double velocity, double force) {
  Arm<J> arm(0);
  arm.lock({0, 1, 2, 3, 4, 5});
  arm.free({axis});
  if (axis < 3) {
    auto& motor = *arm.joint.getTranslationalLimitMotor();
    motor.m_enableMotor[axis] = true;
    motor.m_targetVelocity[axis] = scalar(velocity);
    motor.m_maxMotorForce[axis] = scalar(force);
  } else {
    auto& motor = *arm.joint.getRotationalLimitMotor(axis - 3);
    motor.m_enableMotor = true;
    motor.m_targetVelocity = scalar(velocity);
    motor.m_maxMotorForce = scalar(force);
  }
  arm.run(0.5);
  return {double(arm.body.getLinearVelocity().dot(vec(1, 1, 1))),
          double(arm.body.getAngularVelocity().dot(vec(1, 1, 1)))};
}

TEST(SixDofMotor, DrivesAsBulletsDoes) {
  for (int axis = 0; axis < 6; ++axis)
    for (const double force : {0.01, 100.}) {
      SCOPED_TRACE(testing::Message() << axis << ", " << force);
      const auto stock = drive<btGeneric6DofConstraint>(axis, 0.7, force),
                 ours = drive<Generic6DofJoint>(axis, 0.7, force),
                 stock_2 = drive<btGeneric6DofSpring2Constraint>(axis, 0.7, force),
                 ours_2 = drive<Generic6DofSpring2Joint>(axis, 0.7, force);
      for (size_t i = 0; i < 2; ++i) {
        EXPECT_NEAR(ours[i], stock[i], 1e-5);
        EXPECT_NEAR(ours_2[i], stock_2[i], 1e-5);
      }
    }
}

template <class J>
std::vector<double> serve(int axis, double target, double low, double high) {
  Arm<J> arm(0);
  arm.lock({0, 1, 2, 3, 4, 5});
  arm.limit({axis}, low, high);
  arm.joint.enableMotor(axis, true);
  arm.joint.setServo(axis, true);
  arm.joint.setServoTarget(axis, scalar(target));
  arm.joint.setTargetVelocity(axis, 1);
  arm.joint.setMaxMotorForce(axis, 1000);
  std::vector<double> all;
  for (int i = 0; i < 20; ++i) {
    arm.run(0.1);
    all.push_back(axis < 3 ? arm.position(axis) : arm.angle(axis - 3));
  }
  return all;
}

TEST(SixDofMotor, AServoGoesToItsTargetAsBulletsDoes) {
  for (const int axis : {1, 3, 5})
    for (const double target : {0.7, -0.4})
      for (const auto& [low, high] : {std::pair(1., -1.), {-0.2, 0.3}}) {
        SCOPED_TRACE(testing::Message() << axis << ", " << target << ", " << low);
        const auto stock = serve<btGeneric6DofSpring2Constraint>(axis, target, low, high),
                   ours = serve<Generic6DofSpring2Joint>(axis, target, low, high);
        for (size_t i = 0; i < ours.size(); ++i) EXPECT_NEAR(ours[i], stock[i], 3e-3) << i;
      }
}

// --- a wheel --------------------------------------------------------------------------------------

TEST(Hinge2, CarriesAndTurns) {
  scenes::World world(g);
  btRigidBody &car = world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0))),
              &wheel = world.add_box(1, vec(0.1, 0.3, 0.3), scenes::pose_at(vec(0, 0, 0)));
  btVector3 anchor(0, 0, 0), steering(0, 0, 2), axle(3, 0, 0);
  auto& joint = world.add_joint<pintle::Hinge2Joint>(car, wheel, anchor, steering, axle);
  EXPECT_EQ(steering.length(), 1);
  joint.setStiffness(2, 100);
  joint.setDamping(2, 10);
  wheel.setAngularVelocity(vec(10, 0, 0));
  for (int i = 0; i < 300; ++i) world.step(dt);
  EXPECT_NEAR(double(wheel.getCenterOfMassPosition().z()), -g / 100, 1e-3);
  EXPECT_NEAR(double(wheel.getAngularVelocity().x()), 10, 0.05);
  EXPECT_NEAR(double(joint.getAccumulatedAngle(3)), -50, 0.5);
}

}  // namespace
}  // namespace six_dof_joint_test
