// Rods, ropes and struts against closed forms, measured from the bodies' poses.
#include <pintle/joints/distance_joint.h>
#include <scenes/pendulum.h>

#include "free_joint_support.h"
#include "solver_of_tests.h"

namespace distance_joint_test {

using namespace free_joints;
using pintle::DistanceJoint;
using pintle::Formulation;
using scenes::standard_gravity;
using scenes::World;
using support::infinite;
using support::SolverRows;

constexpr double dt = 1.0 / 60;

// A cube on a joint to a point of the world, with or without weight.
struct Hanging {
  World world;
  btRigidBody& fixed;
  btRigidBody& cube;
  DistanceJoint& joint;

  explicit Hanging(const btVector3& at, double length, double gravity = standard_gravity,
                   double mass = 2)
      : world(gravity),
        fixed(addCube(world, 0, vec(0, 0, 0))),
        cube(addCube(world, mass, at)),
        joint(world.add_joint<DistanceJoint>(fixed, cube, vec(0, 0, 0), vec(0, 0, 0),
                                             scalar(length))) {}

  btRigidBody& free() { return cube; }
  void step() { world.step(dt); }
  void steps(int n) {
    for (int i = 0; i < n; ++i) step();
  }
  double distance() const { return scenes::position(cube).norm(); }
  double energy() const { return scenes::energy(cube, standard_gravity); }
};

// --- rod -----------------------------------------------------------------------------------------

struct Swing {
  double period_error, stretch, energy_error;
};

// A cube that swings from 60 degrees; spin (rad/s) about its own centre does not matter to it.
Swing swing(Formulation formulation, double step, double spin = 0) {
  const double amplitude = pi / 3;
  Hanging h(vec(std::sin(amplitude), 0, -std::cos(amplitude)), 1);
  h.joint.setFormulation(formulation);
  h.cube.setAngularVelocity(vec(0, spin, 0));
  const double start = h.energy(), swing_energy = 2 * standard_gravity * (1 - std::cos(amplitude));
  Swing result = {};
  double last = amplitude, first_pass = -1, last_pass = -1;
  int passes = 0;
  for (int i = 1; i * step < 20; ++i) {
    h.world.step(step);
    const Eigen::Vector3d p = scenes::position(h.cube);
    const double angle = std::atan2(p.x(), -p.z());
    if (last < 0 && angle >= 0) {
      last_pass = (i - 1 - last / (angle - last)) * step;
      if (passes++ == 0) first_pass = last_pass;
    }
    last = angle;
    result.stretch = std::max(result.stretch, std::abs(p.norm() - 1));
    result.energy_error =
        std::max(result.energy_error, std::abs(h.energy() - start) / swing_energy);
  }
  const double exact = scenes::pendulum_period(2, 2 * standard_gravity, amplitude);
  result.period_error = (last_pass - first_pass) / (passes - 1) / exact - 1;
  return result;
}

TEST(DistanceJoint, APendulumOnARodHasThePeriodOfTheClosedForm) {
  const Swing swings = swing(Formulation::conditioned, dt);
  // Bullet's integrator is symplectic Euler, here in the angle: its period is wrong by (w dt)^2 / 24
  // of the small swing (1.1e-4 at 3.1 rad/s) and some times that of a large one.
  EXPECT_LT(std::abs(swings.period_error), 5e-4);
  // What is left of the curvature is of the fourth order, v^4 dt^4 / (8 l^3) = 9e-7 m at most, and
  // adds up over the steps that erp takes: five times that.
  EXPECT_LT(swings.stretch, 6e-6);
  // Symplectic Euler's energy swings to and fro by v g dt at most, here 0.05 of the whole.
  EXPECT_LT(swings.energy_error, 0.06);
  // A spin of 30 rad/s is none of the rod's business, but that the exact solver makes up for the steps of what turns
  // fast.
  const Swing spinning = swing(Formulation::conditioned, dt, 30);
  if (onExactSolver())
    EXPECT_LT(std::abs(spinning.period_error), std::abs(swings.period_error));
  else
    EXPECT_NEAR(spinning.period_error, swings.period_error, 1e-4);
  EXPECT_LT(spinning.stretch, 6e-6);
  // The document's row stretches by the whole of v^2 dt^2 / 2 over erp, and loses energy by it.
  if (onExactSolver()) return;  // on which it does not
  const Swing document = swing(Formulation::document, dt);
  EXPECT_GT(document.stretch, 1000 * swings.stretch);
  EXPECT_LT(document.period_error, 3 * -std::abs(swings.period_error));
}

TEST(DistanceJoint, ThePeriodConvergesWithTheStep) {
  const double coarse = std::abs(swing(Formulation::conditioned, dt).period_error);
  const double fine = std::abs(swing(Formulation::conditioned, dt / 4).period_error);
  EXPECT_LT(fine, coarse / 3 + rounding(1e-5, 0));
}

TEST(DistanceJoint, ARodWhosePointsCoincideReachesItsLengthAndHolds) {
  for (const bool weight : {false, true}) {
    Hanging h(vec(0, 0, 0), 1, weight ? standard_gravity : 0);
    h.steps(240);
    EXPECT_NEAR(h.distance(), 1, 1e-3);
    if (weight) continue;
    // It leaves along the fixed direction, and without weight stays there.
    EXPECT_NEAR(scenes::position(h.cube).x(), 1, 1e-4);
    EXPECT_LT(double(h.cube.getLinearVelocity().length()), 1e-3);
    for (int i = 0; i < 120; ++i) {
      h.step();
      EXPECT_NEAR(h.distance(), 1, rounding(1e-5, 1e-9));
    }
  }
}

TEST(DistanceJoint, PointsThatCoincidePartAlongTheirLastDirection) {
  const btVector3 direction = vec(0.6, -0.64, 0.48);
  Hanging h(direction, 1, 0);
  h.steps(2);
  h.cube.setCenterOfMassTransform(scenes::pose_at(vec(0, 0, 0)));
  h.cube.setLinearVelocity(vec(0, 0, 0));
  h.steps(120);
  EXPECT_LT((scenes::position(h.cube) - scenes::to_eigen(direction)).norm(), 1e-3);
}

TEST(DistanceJoint, PointsThatPassCloseAndFastAreNotThrown) {
  // A rod of a millimetre, whose ends pass at a hundred times that a step: v^2 / |d| would be 1e5
  // m/s^2, and half of it in a step 800 m/s.
  for (const double length : {1e-3, 1e-2, 0.1}) {
    Hanging h(vec(length, 0, 0), length, 0);
    h.cube.setLinearVelocity(vec(0, 10, 0));
    double top = 0;
    for (int i = 0; i < 120; ++i) {
      h.step();
      top = std::max(top, double(h.cube.getLinearVelocity().length()));
    }
    EXPECT_LT(top, 15);
    // What moves by more than the rod in a step is held to within half a step.
    EXPECT_LT(std::abs(h.distance() - length), 10 * dt / 2);
  }
}

TEST(DistanceJoint, TwoFreeBodiesKeepTheirMomentum) {
  World world(0);
  btRigidBody &a = addCube(world, 1, vec(0, 0, 0)), &b = addCube(world, 3, vec(0.8, 0.3, 0));
  // Of a rod that closes, the exact solver moves poses, and moments with them.
  const double length = onExactSolver() ? double(vec(0.5, 0.2, 0.1).length()) : 1;
  auto& rod =
      world.add_joint<DistanceJoint>(a, b, vec(0.1, 0.2, 0), vec(-0.2, 0.1, 0.1), scalar(length));
  // And it makes what swings faster than a step resolves resist that.
  const double slow = onExactSolver() ? 0.1 : 1;
  a.setLinearVelocity(scalar(slow) * vec(1, 2, -1));
  b.setAngularVelocity(scalar(slow) * vec(3, -2, 1));
  const auto momentum = [&] {
    Eigen::Vector3d p = Eigen::Vector3d::Zero(), L = p;
    for (const btRigidBody* body : {&a, &b}) {
      const double m = 1 / double(body->getInvMass());
      const Eigen::Vector3d v = scenes::to_eigen(body->getLinearVelocity());
      p += m * v;
      // A cube's inertia is one number.
      L += m * scenes::position(*body).cross(v) +
           double(body->getLocalInertia().x()) * scenes::to_eigen(body->getAngularVelocity());
    }
    return std::pair(p, L);
  };
  const auto [p, L] = momentum();
  for (int i = 0; i < 300; ++i) world.step(dt);
  EXPECT_LT((momentum().first - p).norm(), rounding(1e-5, 1e-12));
  EXPECT_LT((momentum().second - L).norm(), rounding(1e-4, onExactSolver() ? 1e-7 : 1e-11));
  EXPECT_NEAR(double(rod.getDistance()), length, 0.01);
}

TEST(DistanceJoint, ASpringRodSagsAndSwingsAsItsFrequencySays) {
  const double frequency = 2, w = 2 * pi * frequency;
  Hanging h(vec(0, 0, -1), 1);
  h.joint.setLimitSpring(scalar(frequency), 1);
  h.steps(300);
  // At rest w^2 sag = g.
  EXPECT_NEAR(h.distance() - 1, standard_gravity / (w * w), 1e-4);
  EXPECT_NEAR(double(h.joint.getLimitImpulse()), -2 * standard_gravity * dt, 1e-4);
}

// --- rope and strut ------------------------------------------------------------------------------

TEST(DistanceJoint, ARopeLetsFallAndStopsDeadWithoutABounce) {
  Hanging h(vec(0, 0, -0.3), 1);
  h.joint.setLimit(0, 1);
  double last_energy = h.energy();
  int taut_at = -1;
  for (int i = 1; i <= 300; ++i) {
    h.step();
    if (taut_at < 0) {
      // Free fall in Bullet's steps: g dt^2 i (i + 1) / 2.
      const double fallen = 0.3 + standard_gravity * dt * dt * i * (i + 1) / 2;
      if (fallen < 1) {
        EXPECT_NEAR(h.distance(), fallen, rounding(1e-5, 1e-12));
        EXPECT_EQ(h.joint.getLimitImpulse(), 0);
      } else {
        taut_at = i;
        // The momentum that it had is in the impulse of this step and the next.
        EXPECT_LT(h.joint.getLimitImpulse(), 0);
      }
    }
    EXPECT_LT(h.distance(), 1 + rounding(1e-5, 1e-12));
    if (taut_at > 0) {
      EXPECT_NEAR(h.distance(), 1, rounding(1e-5, 1e-12));
    }
    // Kinetic energy of a step is counted before its height: half a step's fall.
    EXPECT_LT(h.energy(), last_energy + rounding(1e-5, 1e-12));
    last_energy = h.energy();
  }
  EXPECT_GT(taut_at, 0);
  EXPECT_LT(double(h.cube.getLinearVelocity().length()), rounding(1e-5, 1e-12));
}

TEST(DistanceJoint, ARopeThatGoesTautInFlightSwingsOnAsAPendulum) {
  // Thrown sideways it falls in a parabola, is caught, and from then on swings with what it kept.
  Hanging h(vec(0.2, 0, 0), 1);
  h.joint.setLimit(0, 1);
  h.cube.setLinearVelocity(vec(1, 0.5, 0));
  const double start = h.energy();
  double longest = 0, highest = -1e9, after = 0;
  int rows = 0;
  for (int i = 0; i < 600; ++i) {
    h.step();
    rows += h.joint.getLimitImpulse() != 0;
    longest = std::max(longest, h.distance());
    highest = std::max(highest, h.energy());
    if (i == 200) after = h.energy();
  }
  EXPECT_GT(rows, 300);
  EXPECT_LT(longest, 1 + 2e-4);
  // Bullet's steps count a swing's energy wrong by m v g dt / 2 at most: v < 5 m/s.
  EXPECT_LT(highest, start + 2 * 5 * standard_gravity * dt / 2);
  EXPECT_NEAR(h.energy(), after, 2 * 5 * standard_gravity * dt / 2);
}

TEST(DistanceJoint, ARopeHasARowOnlyWhenTheStepMayTautenIt) {
  const auto rows = [](double distance, double speed, double gravity) {
    Hanging h(vec(0, 0, -distance), 1, gravity);
    h.joint.setLimit(0, 1);
    h.cube.setLinearVelocity(vec(0, 0, -speed));
    h.cube.applyCentralForce(vec(0, 0, -2 * gravity));
    return SolverRows::ofStep(h.joint).announced();
  };
  EXPECT_EQ(rows(0.5, 0, standard_gravity), 0);
  EXPECT_EQ(rows(0.901, 3, 0), 1);  // 0.05 m a step, and twice that in a step twice as long
  EXPECT_EQ(rows(0.899, 3, 0), 0);
  EXPECT_EQ(rows(0.99, -3, 0), 0);                 // on its way back
  EXPECT_EQ(rows(0.998, 0, standard_gravity), 1);  // g dt^2 is 2.7 mm
  EXPECT_EQ(rows(0.9, 0, standard_gravity), 0);
  EXPECT_EQ(rows(1.1, 0, 0), 1);    // overstretched
  EXPECT_EQ(rows(1.1, -10, 0), 0);  // the same, but slack again after the step
  // At the very point of suspension a rope is slack: nothing holds it on one side.
  EXPECT_EQ(rows(0, -1, 0), 0);
  // A fast pass lengthens the rope across its direction.
  Hanging h(vec(0, 0, -1 + 1e-3), 1, 0);
  h.joint.setLimit(0, 1);
  EXPECT_EQ(SolverRows::ofStep(h.joint).announced(), 0);
  h.cube.setLinearVelocity(vec(6, 0, 0));  // 0.1 m across: 5 mm
  EXPECT_EQ(SolverRows::ofStep(h.joint).announced(), 1);
}

TEST(DistanceJoint, LimitsHoldWhateverIsThrownAtThem) {
  support::Random random(5);
  for (int n = 0; n < 60; ++n) {
    const double low = random.uniform(0.1, 1), high = low + random.uniform(0.01, 1);
    const btVector3 at = random.unit() * scalar(random.uniform(low, high));
    Hanging h(at, 1, 0);
    h.joint.setLimit(scalar(low), n % 3 == 0 ? infinite : scalar(high));
    const double speed = random.uniform(1, 5);
    h.cube.setLinearVelocity(random.unit() * scalar(speed));
    for (int i = 0; i < 120; ++i) {
      h.step();
      // Without weight only the curvature is left: half of (v dt)^2 / |d|, less what is foreseen; and
      // below |d| = v dt nothing is.
      const double passes = std::min(1., speed * dt / low);
      ASSERT_GT(h.distance(), low - 0.5 * low * passes * passes * passes - 1e-4) << n;
      if (n % 3 != 0) {
        ASSERT_LT(h.distance(), high + 1e-3) << n;
      }
      ASSERT_LT(double(h.cube.getLinearVelocity().length()), speed * (1 + 1e-3) + 1e-3);
    }
  }
}

TEST(DistanceJoint, AStrutCarriesAndDoesNotPull) {
  Hanging h(vec(0, 0, 1), 1);
  h.joint.setLimit(1, infinite);
  EXPECT_EQ(h.joint.getUpperLimit(), infinite);
  h.cube.setLinearFactor(vec(0, 0, 1));  // it stands
  h.steps(60);
  // The exact solver's joints of loops are softer than nothing, by a part of 1e-8.
  const double near = rounding(1e-5, onExactSolver() ? 1e-8 : 1e-12);
  EXPECT_NEAR(h.distance(), 1, near);
  EXPECT_NEAR(double(h.joint.getLimitImpulse()), 2 * standard_gravity * dt, near);
  h.cube.setLinearVelocity(vec(0, 0, 5));
  h.step();
  EXPECT_EQ(h.joint.getLimitImpulse(), 0);
  EXPECT_NEAR(double(h.cube.getLinearVelocity().z()), 5 - standard_gravity * dt, 1e-5);
}

TEST(DistanceJoint, LimitsMayBeFreedAndChanged) {
  Hanging h(vec(0, 0, -1), 1);
  EXPECT_EQ(h.joint.getLowerLimit(), 1);
  EXPECT_EQ(h.joint.getUpperLimit(), 1);
  EXPECT_NEAR(double(h.joint.getDistance()), 1, 1e-6);
  h.joint.setLimit(2, 1);
  EXPECT_EQ(SolverRows::ofStep(h.joint).announced(), 0);
  h.joint.setLimit(-5, 1);
  EXPECT_EQ(h.joint.getLowerLimit(), 0);
  EXPECT_EQ(SolverRows::ofStep(h.joint).announced(), 1);
}

// --- motor, servo, friction ----------------------------------------------------------------------

TEST(DistanceJoint, AMotorReelsARopeInAtItsSpeedAndStopsAtTheLimit) {
  Hanging h(vec(0, 0, -2), 1);
  h.joint.setLimit(1, 3);
  h.joint.enableMotor(true, -1, 10);
  h.steps(30);
  EXPECT_NEAR(double(h.cube.getLinearVelocity().z()), 1, 1e-4);
  EXPECT_NEAR(h.distance(), 2 - 30 * dt, 1e-4);
  EXPECT_NEAR(double(h.joint.getMotorImpulse()), -2 * standard_gravity * dt, 1e-4);
  h.steps(120);
  EXPECT_NEAR(h.distance(), 1, 1e-3);
  // Too weak, and it is lowered at what is left of its weight; off, it falls.
  Hanging weak(vec(0, 0, -1), 1);
  weak.joint.setLimit(0, 10);
  weak.joint.enableMotor(true, -1, scalar(0.5 * standard_gravity * dt * 2));
  weak.steps(30);
  EXPECT_NEAR(double(weak.cube.getLinearVelocity().z()), -0.5 * standard_gravity * 30 * dt, 1e-3);
  weak.joint.enableMotor(false);
  EXPECT_FALSE(weak.joint.getEnableMotor());
  weak.steps(10);
  EXPECT_EQ(weak.joint.getMotorImpulse(), 0);
  EXPECT_NEAR(double(weak.cube.getLinearVelocity().z()), -standard_gravity * (15 + 10) * dt, 1e-3);
}

TEST(DistanceJoint, AServoHoldsADistance) {
  Hanging h(vec(0, 0, -1), 1);
  h.joint.setLimit(0, 10);
  h.joint.setMotorServo(2, 2, 1, 1000);
  h.steps(300);
  const double w = 4 * pi;
  EXPECT_NEAR(h.distance(), 2 + standard_gravity / (w * w), 1e-3);
  h.joint.setMotorServo(2, 2, 1, scalar(standard_gravity));  // half its weight
  h.step();
  EXPECT_NEAR(double(h.joint.getMotorImpulse()), -standard_gravity * dt, 1e-4);
}

TEST(DistanceJoint, FrictionHoldsUpToItsForceAndNoFurther) {
  for (const double part : {0.5, 1.1}) {
    Hanging h(vec(0, 0, -1), 1);
    h.joint.setLimit(0, 10);
    h.joint.setFriction(scalar(part * 2 * standard_gravity));
    h.steps(30);
    const double falls = std::max(0., 1 - part) * standard_gravity * 30 * dt;
    EXPECT_NEAR(double(h.cube.getLinearVelocity().z()), -falls, rounding(1e-4, 1e-9));
    EXPECT_NEAR(double(h.joint.getFrictionImpulse()),
                -std::min(1., part) * 2 * standard_gravity * dt, rounding(1e-4, 1e-9));
  }
}

TEST(DistanceJoint, PartsOfTheImpulseAddUpToWhatTheBodyFeels) {
  Hanging h(vec(0, 0, -1), 1);
  h.joint.setLimit(scalar(0.5), scalar(1.2));
  h.joint.enableMotor(true, 2, scalar(0.1));
  h.joint.setFriction(3);
  double before = 0;
  for (int i = 0; i < 60; ++i) {
    h.step();
    const double v = double(h.cube.getLinearVelocity().z());
    const double parts = double(h.joint.getMotorImpulse() + h.joint.getLimitImpulse() +
                                h.joint.getFrictionImpulse());
    EXPECT_NEAR(2 * (v - before) + 2 * standard_gravity * dt, -parts, rounding(1e-4, 1e-10)) << i;
    before = v;
  }
  EXPECT_NE(h.joint.getLimitImpulse(), 0);
  // On the limit the motor only holds, as Bullet's do.
  EXPECT_NEAR(double(h.joint.getMotorImpulse()), -0.1, 1e-6);
}

// --- as any of Bullet's joints -------------------------------------------------------------------

TEST(DistanceJoint, FeedbackIsTheLoadAndABreakingThresholdBreaksIt) {
  Hanging h(vec(0, 0, -1), 1);
  btJointFeedback feedback;
  h.joint.setJointFeedback(&feedback);
  h.steps(60);
  EXPECT_NEAR(double(feedback.m_appliedForceBodyB.z()), 2 * standard_gravity, 1e-3);
  EXPECT_NEAR(double(feedback.m_appliedForceBodyA.z()), -2 * standard_gravity, 1e-3);

  Hanging breaking(vec(0, 0, -1), 1);
  breaking.joint.setBreakingImpulseThreshold(scalar((50.5 + 2 * standard_gravity) * dt));
  EXPECT_NEAR(support::stepOfBreaking(breaking, breaking.joint, vec(0, 0, -1), vec(0, 0, 0)), 51,
              1);
}

TEST(DistanceJoint, ConstructorsAgree) {
  World world(0);
  btRigidBody &a = addCube(world, 1, vec(1, 2, 3)), &b = addCube(world, 1, vec(2, 0, 1));
  const btVector3 p = vec(0.1, 0.2, 0.3), q = vec(-0.2, 0, 0.1);
  const double apart =
      (scenes::point_in_world(a, {0.1, 0.2, 0.3}) - scenes::point_in_world(b, {-0.2, 0, 0.1}))
          .norm();
  DistanceJoint frames(a, b, scenes::pose_at(p), scenes::pose_at(q));
  EXPECT_NEAR(double(frames.getUpperLimit()), apart, 1e-6);
  EXPECT_EQ(frames.getLowerLimit(), frames.getUpperLimit());
  DistanceJoint pivots(a, b, p, q, frames.getDistance());
  EXPECT_EQ(SolverRows::ofStep(frames), SolverRows::ofStep(pivots));
  DistanceJoint tether(a, scenes::pose_at(p));
  EXPECT_NEAR(double(tether.getDistance()), 0, 1e-6);
  EXPECT_EQ(tether.getUpperLimit(), 0);
  EXPECT_EQ(&tether.getRigidBodyB(), &btTypedConstraint::getFixedBody());
  tether.setLimit(0, 1);
  EXPECT_EQ(SolverRows::ofStep(tether).announced(), 0);
}

TEST(DistanceJoint, RefusesBadSettingsAndStaysAsItWas) {
  Hanging h(vec(0, 0, -1), 1);
  const auto make = [&] {
    auto joint = std::make_unique<DistanceJoint>(h.fixed, h.cube, vec(0, 0, 0), vec(0, 0, 0), 1);
    joint->setLimit(scalar(0.2), scalar(0.9));
    return joint;
  };
  using D = DistanceJoint;
  expectChecked<D>(
      {{"motor target velocity", [](D& d, btScalar v) { d.enableMotor(true, v, 1); }, true, true,
        false},
       {"max motor impulse", [](D& d, btScalar v) { d.enableMotor(true, 1, v); }, false, true,
        true},
       {"servo target", [](D& d, btScalar v) { d.setMotorServo(v, 1, 1, 1); }, true, true, false},
       {"servo frequency", [](D& d, btScalar v) { d.setMotorServo(1, v, 1, 1); }, false, false,
        false},
       {"damping ratio", [](D& d, btScalar v) { d.setMotorServo(1, 1, v, 1); }, false, true, false},
       {"force", [](D& d, btScalar v) { d.setMotorServo(1, 1, 1, v); }, false, true, true},
       {"friction max force", [](D& d, btScalar v) { d.setFriction(v); }, false, true, true},
       {"spring frequency", [](D& d, btScalar v) { d.setLimitSpring(v, 1); }, false, true, false},
       {"damping ratio", [](D& d, btScalar v) { d.setLimitSpring(1, v); }, false, true, false},
       {"ERP", [](D& d, btScalar v) { d.setParam(BT_CONSTRAINT_ERP, v); }, false, true, false},
       {"CFM", [](D& d, btScalar v) { d.setParam(BT_CONSTRAINT_STOP_CFM, v); }, false, true,
        false}},
      make);
  const auto joint = make(), twin = make();
  expectRefused(
      *joint, *twin, [](D& d, btScalar v) { d.setLimit(v, 1); }, "limit", nan_value);
  expectRefused(
      *joint, *twin, [](D& d, btScalar v) { d.setLimit(0, v); }, "limit", nan_value);
  expectRefused(
      *joint, *twin, [](D& d, btScalar v) { d.setLimit(-2, v); }, "limit", -1);
  for (const btScalar value : {nan_value, infinite, scalar(-1)}) {
    expectRefusal(refusal([&] { D(h.fixed, h.cube, vec(0, 0, 0), vec(0, 0, 0), value); }),
                  "DistanceJoint", "length", value);
    if (value == -1) continue;
    const btVector3 bad(0, value, 0);
    expectRefusal(refusal([&] { D(h.fixed, h.cube, bad, vec(0, 0, 0), 1); }), "DistanceJoint",
                  "pivotInA", value);
    expectRefusal(refusal([&] { D(h.fixed, h.cube, vec(0, 0, 0), bad, 1); }), "DistanceJoint",
                  "pivotInB", value);
  }
}

TEST(DistanceJoint, IsDrawn) {
  const Hanging h(vec(0, 0, -1), 1);
  expectDrawn(h.joint, 6, true);
}

}  // namespace distance_joint_test
