// The limit of an angle about an axis, alone and with the ball joint that it is made to go with; and
// what the document says of its problems, measured.
#include <pintle/joints/angular_limit.h>
#include <pintle/joints/ball_joint.h>

#include "free_joint_support.h"
#include "solver_of_tests.h"

namespace angular_limit_test {

using namespace free_joints;
using pintle::AngularLimit;
using pintle::Formulation;
using scenes::radians;
using scenes::World;
using support::infinite;
using support::Random;
using support::SolverRows;

constexpr double dt = 1.0 / 60;

// A cube that turns about its centre, against a fixed one.
struct Turning {
  World world;
  btRigidBody& fixed;
  btRigidBody& cube;
  AngularLimit& joint;

  explicit Turning(double angle = 0, double tilt = 0)
      : world(0),
        fixed(addCube(world, 0, vec(0, 0, 0))),
        cube(addCube(world, 3, vec(0, 0, 0))),
        joint(world.add_joint<AngularLimit>(fixed, cube, btTransform::getIdentity(),
                                            btTransform::getIdentity())) {
    // x of the cube leans out of the plane by `tilt`.
    const btQuaternion turn =
        btQuaternion(vec(0, 0, 1), scalar(angle)) * btQuaternion(vec(0, 1, 0), scalar(-tilt));
    cube.setCenterOfMassTransform(btTransform(turn, vec(0, 0, 0)));
    joint.setAccumulatedAngle(scalar(angle));
  }

  double inertia() const { return double(cube.getLocalInertia().z()); }
  void steps(int n) {
    for (int i = 0; i < n; ++i) world.step(dt);
  }
  /// By the pose alone.
  double angle() const {
    const Eigen::Vector3d x = scenes::direction_in_world(cube, {1, 0, 0});
    return std::atan2(x.y(), x.x());
  }
  double spin() const { return double(cube.getAngularVelocity().z()); }
};

// --- the angle -----------------------------------------------------------------------------------

TEST(AngularLimit, CountsItsTurnsBothWays) {
  for (const double speed : {3., 18., 100., -18., -100.}) {
    Turning t;
    t.cube.setAngularVelocity(vec(0, 0, speed));
    scenes::Unwrap unwrap(0);
    for (int i = 0; i < 300; ++i) {
      t.steps(1);
      const double angle = unwrap(t.angle());
      ASSERT_NEAR(double(t.joint.getAccumulatedAngle()), angle, rounding(1e-4, 1e-10));
      ASSERT_NEAR(double(t.joint.getAngle()), t.angle(), rounding(1e-6, 1e-14));
    }
    EXPECT_GT(std::abs(double(t.joint.getAccumulatedAngle())), 14);
  }
}

TEST(AngularLimit, StopsAfterAnyNumberOfTurnsWithinAStepsMotion) {
  Random random(1);
  for (int n = 0; n < 60; ++n) {
    const double low = random.uniform(-20, -0.1), high = random.uniform(0.1, 20);
    Turning t;
    t.joint.setLimit(scalar(low), scalar(high));
    const double speed = (n % 2 ? 1 : -1) * random.uniform(1, 30);
    t.cube.setAngularVelocity(vec(0, 0, speed));
    scenes::Unwrap unwrap(0);
    double angle = 0, fastest = 0;
    for (int i = 0; i < 60 * 22; ++i) {
      t.steps(1);
      angle = unwrap(t.angle());
      ASSERT_LE(std::max(low - angle, angle - high), rounding(1e-4, 1e-9)) << n;
      fastest = std::max(fastest, std::abs(t.spin()));
    }
    EXPECT_LE(fastest, std::abs(speed) * (1 + 1e-5));
    // A limit takes what comes within a tenth of a step for there.
    EXPECT_NEAR(angle, speed > 0 ? high : low, 0.1 * std::abs(speed) * dt + 1e-4) << n;
    EXPECT_NEAR(t.spin(), 0, 1e-3);
  }
}

TEST(AngularLimit, ANewLimitHoldsInTheTurnThatTheJointIsIn) {
  Turning t(radians(-170));
  AngularLimit joint(t.fixed, t.cube, btTransform::getIdentity(), btTransform::getIdentity());
  joint.setLimit(scalar(radians(180)), scalar(radians(200)));
  EXPECT_NEAR(double(joint.getAccumulatedAngle()), radians(190), 1e-5);
  EXPECT_EQ(SolverRows::ofStep(joint).announced(), 0);
  joint.setAccumulatedAngle(scalar(radians(550)));
  EXPECT_NEAR(double(joint.getAccumulatedAngle()), radians(550), 1e-5);
  joint.setLimit(scalar(radians(180)), scalar(radians(200)));
  EXPECT_EQ(SolverRows::ofStep(joint).announced(), 1);
  EXPECT_EQ(joint.getLowerLimit(), scalar(radians(180)));
  EXPECT_EQ(joint.getUpperLimit(), scalar(radians(200)));
}

// --- what acts -----------------------------------------------------------------------------------

TEST(AngularLimit, HasARowForWhatActsAndNoneForThePoint) {
  const auto rows = [](const std::function<void(AngularLimit&, btRigidBody&)>& set) {
    Turning t;
    set(t.joint, t.cube);
    return SolverRows::ofStep(t.joint).announced();
  };
  EXPECT_EQ(rows([](auto&, auto&) {}), 0);
  EXPECT_EQ(rows([](auto& j, auto&) { j.setLimit(-1, 1); }), 0);
  EXPECT_EQ(rows([](auto& j, auto&) { j.setLimit(scalar(0.1), 1); }), 1);
  EXPECT_EQ(rows([](auto& j, auto&) { j.setLimit(1, -1); }), 0);
  EXPECT_EQ(rows([](auto& j, auto&) { j.setLimit(-infinite, infinite); }), 0);
  EXPECT_EQ(rows([](auto& j, auto& b) {
              j.setLimit(-1, scalar(0.09));
              b.setAngularVelocity(vec(0, 0, 6));
            }),
            1);
  EXPECT_EQ(rows([](auto& j, auto& b) {
              j.setLimit(-1, scalar(0.09));
              b.setAngularVelocity(vec(0, 0, -6));
            }),
            0);
  EXPECT_EQ(rows([](auto& j, auto&) { j.enableAngularMotor(true, 1, 1); }), 1);
  EXPECT_EQ(rows([](auto& j, auto&) { j.enableAngularMotor(false, 1, 1); }), 0);
  EXPECT_EQ(rows([](auto& j, auto&) { j.setMotorServo(1, 1, 1, 1); }), 1);
  EXPECT_EQ(rows([](auto& j, auto&) { j.setFriction(1); }), 1);
}

TEST(AngularLimit, AMotorTurnsAndAServoHolds) {
  Turning t;
  t.joint.enableAngularMotor(true, 2, 1);
  t.steps(60);
  EXPECT_NEAR(t.spin(), 2, 1e-5);
  // As weak as it may be: max impulse over inertia, a step.
  t.joint.enableAngularMotor(true, -100, scalar(0.1 * t.inertia()));
  t.steps(10);
  EXPECT_NEAR(t.spin(), 1, 1e-4);
  EXPECT_NEAR(double(t.joint.getMotorImpulse()), -0.1 * t.inertia(), 1e-6);
  // Through whole turns to its target.
  t.joint.setMotorServo(20, 2, 1, 100);
  t.steps(300);
  EXPECT_NEAR(double(t.joint.getAccumulatedAngle()), 20, 1e-3);
  t.joint.enableMotor(false);
  EXPECT_FALSE(t.joint.getEnableAngularMotor());
}

TEST(AngularLimit, FrictionSlowsAtItsTorque) {
  Turning t;
  t.cube.setAngularVelocity(vec(0, 0, 2));
  t.joint.setFriction(scalar(t.inertia()));  // 1 rad/s^2
  t.steps(60);
  EXPECT_NEAR(t.spin(), 1, 1e-4);
  EXPECT_NEAR(double(t.joint.getFrictionImpulse()), -t.inertia() * dt, 1e-7);
  t.steps(120);
  EXPECT_NEAR(t.spin(), 0, 1e-6);
}

TEST(AngularLimit, ALimitsSpringGivesByItsFrequencyAndImpulsesAddUp) {
  Turning t;
  t.joint.setLimit(-1, 0);
  t.joint.setLimitSpring(3, 1);
  t.joint.setFriction(scalar(0.25 * t.inertia()));
  double before = 0;
  for (int i = 0; i < 300; ++i) {
    t.cube.applyTorque(vec(0, 0, 2 * t.inertia()));
    t.steps(1);
    const double parts = double(t.joint.getLimitImpulse() + t.joint.getFrictionImpulse() +
                                t.joint.getMotorImpulse());
    EXPECT_NEAR(t.inertia() * (t.spin() - before - 2 * dt), parts, 1e-6);
    before = t.spin();
  }
  const double w = 6 * pi;
  EXPECT_NEAR(t.angle(), 1.75 / (w * w), 1e-4 + 0.5 / (w * w));  // friction may hold part of it
  EXPECT_NEAR(double(t.joint.getLimitImpulse() + t.joint.getFrictionImpulse()),
              -2 * t.inertia() * dt, 1e-7);
}

TEST(AngularLimit, GoesWithABallJoint) {
  // An arm that swings about any axis, but not beyond a heading. (With the pivot near its centre: the
  // solver sees the limit without the pivot, and a long arm's inertia only by and by.)
  Random random(2);
  for (int n = 0; n < 30; ++n) {
    World world(0);
    btRigidBody &fixed = addCube(world, 0, vec(0, 0, 0)), &arm = addCube(world, 1, vec(0.03, 0, 0));
    world.add_joint<pintle::BallJoint>(fixed, arm, vec(0, 0, 0), vec(-0.03, 0, 0));
    auto& limit = world.add_joint<AngularLimit>(fixed, arm, btTransform::getIdentity(),
                                                btTransform::getIdentity());
    limit.setLimit(scalar(-0.5), scalar(0.5));
    btVector3 w = random.vector(2);
    w.setZ(4);
    arm.setAngularVelocity(w);
    arm.setLinearVelocity(w.cross(vec(0.03, 0, 0)));
    const double speed = double(w.length());
    for (int i = 0; i < 120; ++i) {
      world.step(dt);
      const Eigen::Vector3d x = scenes::direction_in_world(arm, {1, 0, 0});
      if (std::hypot(x.x(), x.y()) < 0.3) break;  // the angle means little
      ASSERT_LT(std::abs(std::atan2(x.y(), x.x())), 0.5 + speed * dt / std::hypot(x.x(), x.y()))
          << n << " step " << i;
      ASSERT_LT((scenes::position(arm) - 0.03 * x).norm(), 2e-3);
    }
  }
}

// --- the document's problems ---------------------------------------------------------------------

TEST(AngularLimit, ThePrintedRowIsWrongByTheTangentOfTheTilt) {
  for (const double tilt : {0., 10., 45., 80., 85.}) {
    for (const Formulation formulation : {Formulation::conditioned, Formulation::document}) {
      // A spin about the world's y lets x of the cube lean, and the angle stands; one about x turns it.
      const auto rate = [&](const btVector3& w) {
        Turning t(0, radians(tilt));
        t.joint.setFormulation(formulation);
        t.joint.setFriction(1);
        const SolverRows rows = SolverRows::ofStep(t.joint);
        EXPECT_EQ(rows.announced(), 1);
        // Bullet's row has the opposite sign.
        double said = 0;
        for (int k = 0; k < 3; ++k) said -= double(rows[0].fields[9 + k]) * double(w[k]);
        return said;
      };
      const auto measured = [&](const btVector3& w) {
        // In double, of x of the cube at a unit's turn rate.
        const Eigen::Vector3d x(std::cos(radians(tilt)), 0, std::sin(radians(tilt)));
        const Eigen::Vector3d v = scenes::to_eigen(w).cross(x);
        return v.y() / x.x();
      };
      double error = 0;
      for (const btVector3& w : {vec(1, 0, 0), vec(0, 1, 0), vec(0, 0, 1)})
        error = std::max(error, std::abs(rate(w) - measured(w)));
      const double expected = formulation == Formulation::document ? std::tan(radians(tilt)) : 0;
      EXPECT_NEAR(error, expected, rounding(1e-4, 1e-12)) << tilt;
    }
  }
}

TEST(AngularLimit, AtATiltTheExactRowHoldsAndThePrintedOneLeaks) {
  // A cube whose x leans is pushed about its own long way round: the angle is to stand.
  const auto leak = [](Formulation formulation, double tilt) {
    Turning t(0, radians(tilt));
    t.joint.setFormulation(formulation);
    t.joint.setLimit(-1, 0);
    double worst = 0;
    for (int i = 0; i < 60; ++i) {
      t.cube.applyTorque(vec(-0.02, 0, 0));
      t.steps(1);
      worst = std::max(worst, t.angle());
    }
    return worst;
  };
  for (const double tilt : {20., 60., 80.}) {
    EXPECT_LT(leak(Formulation::conditioned, tilt), 2e-3) << tilt;
    if (onExactSolver()) continue;  // of which poses close what leaks
    EXPECT_GT(leak(Formulation::document, tilt), 5 * leak(Formulation::conditioned, tilt)) << tilt;
  }
}

TEST(AngularLimit, AlongItsAxisItLetsGoAndTakesUpAgain) {
  // x of the cube passes through z of the other: the angle jumps by half a turn in no time.
  for (const Formulation formulation : {Formulation::conditioned, Formulation::document}) {
    Turning t(0, radians(60));
    t.joint.setFormulation(formulation);
    t.joint.setLimit(scalar(-0.3), scalar(0.3));
    t.cube.setAngularVelocity(vec(0.01, -2, 0));
    double fastest = 0;
    int without = 0;
    for (int i = 0; i < 120; ++i) {
      t.steps(1);
      fastest = std::max(fastest, double(t.cube.getAngularVelocity().length()));
      const Eigen::Vector3d x = scenes::direction_in_world(t.cube, {1, 0, 0});
      if (std::hypot(x.x(), x.y()) < 0.049) {
        ++without;
        EXPECT_EQ(SolverRows::ofStep(t.joint).announced(), 0);
      }
      ASSERT_TRUE(support::is_finite(t.cube));
    }
    EXPECT_GT(without, 0);
    // Past it the limit is broken by most of half a turn, and brought back no faster than it may.
    EXPECT_LT(fastest, 2 + 8 + 2);
  }
  // Exactly along the axis: nothing at all.
  Turning t(0, pi / 2);
  t.joint.setLimit(1, 2);
  t.joint.enableAngularMotor(true, 1, 1);
  EXPECT_EQ(SolverRows::ofStep(t.joint).announced(), 0);
}

// --- as any of Bullet's joints -------------------------------------------------------------------

TEST(AngularLimit, FeedbackIsTheLoadAndABreakingThresholdBreaksIt) {
  Turning t;
  btJointFeedback feedback;
  t.joint.setJointFeedback(&feedback);
  t.joint.setLimit(-1, 0);
  for (int i = 0; i < 30; ++i) {
    t.cube.applyTorque(vec(0, 0, 1));
    t.steps(1);
  }
  EXPECT_NEAR(double(feedback.m_appliedTorqueBodyB.z()), -1, 1e-3);
  struct Rig {
    Turning t;
    btRigidBody& free() { return t.cube; }
    void step() { t.steps(1); }
  } rig;
  rig.t.joint.setLimit(-1, 0);
  rig.t.joint.setBreakingImpulseThreshold(scalar(50.5 * dt));
  EXPECT_NEAR(support::stepOfBreaking(rig, rig.t.joint, vec(0, 0, 0), vec(0, 0, 1)), 51, 1);
}

TEST(AngularLimit, ConstructorsAgree) {
  Random random(3);
  const auto a = support::body(1, vec(1, 1, 1), random.pose(1));
  const auto b = support::body(1, vec(1, 1, 1), btTransform::getIdentity());
  const btTransform frame = random.pose(1);
  AngularLimit one(*a, frame);
  EXPECT_NEAR(double(one.getAngle()), 0, 1e-5);
  EXPECT_EQ(&one.getRigidBodyB(), &btTypedConstraint::getFixedBody());
  AngularLimit two(*a, btTypedConstraint::getFixedBody(), frame,
                   a->getCenterOfMassTransform() * frame);
  for (AngularLimit* joint : {&one, &two}) joint->setFriction(1);
  EXPECT_EQ(SolverRows::ofStep(one), SolverRows::ofStep(two));
}

TEST(AngularLimit, RefusesBadSettingsAndStaysAsItWas) {
  Turning t(0.5);
  using A = AngularLimit;
  const auto make = [&] {
    auto joint = std::make_unique<A>(t.fixed, t.cube, btTransform::getIdentity(),
                                     btTransform::getIdentity());
    joint->setLimit(0, scalar(0.4));
    return joint;
  };
  expectChecked<A>(
      {{"motor target velocity", [](A& a, btScalar v) { a.enableAngularMotor(true, v, 1); }, true,
        true, false},
       {"max motor impulse", [](A& a, btScalar v) { a.enableAngularMotor(true, 1, v); }, false,
        true, true},
       {"servo target", [](A& a, btScalar v) { a.setMotorServo(v, 1, 1, 1); }, true, true, false},
       {"servo frequency", [](A& a, btScalar v) { a.setMotorServo(1, v, 1, 1); }, false, false,
        false},
       {"damping ratio", [](A& a, btScalar v) { a.setMotorServo(1, 1, v, 1); }, false, true, false},
       {"torque", [](A& a, btScalar v) { a.setMotorServo(1, 1, 1, v); }, false, true, true},
       {"friction max torque", [](A& a, btScalar v) { a.setFriction(v); }, false, true, true},
       {"spring frequency", [](A& a, btScalar v) { a.setLimitSpring(v, 1); }, false, true, false},
       {"damping ratio", [](A& a, btScalar v) { a.setLimitSpring(1, v); }, false, true, false},
       {"accumulated", [](A& a, btScalar v) { a.setAccumulatedAngle(v); }, true, true, false}},
      make);
  const auto joint = make(), twin = make();
  expectRefused(
      *joint, *twin, [](A& a, btScalar v) { a.setLimit(v, 1); }, "limit", nan_value);
  expectRefused(
      *joint, *twin, [](A& a, btScalar v) { a.setLimit(0, v); }, "limit", nan_value);
}

TEST(AngularLimit, IsDrawn) {
  Turning t;
  t.joint.setLimit(-1, 1);
  expectDrawn(t.joint, 6, true);
  t.joint.setLimit(1, 1);
  expectDrawn(t.joint, 6, false);
}

}  // namespace angular_limit_test
