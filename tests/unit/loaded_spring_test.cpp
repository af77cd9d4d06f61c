// A spring bears what rests on it by way of other joints, as it bears its own bodies.
#include <gtest/gtest.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>

#include <cmath>
#include <vector>

#include "solver_of_tests.h"
#include "support.h"

namespace loaded_spring_test {

using scenes::World;
using support::scalar;
using support::vec;

constexpr double pi = 3.14159265358979323846;

// A hub of 1 kg slides down a rail on a spring; a load hangs on it by a ball joint below its centre.
double sag(double frequency, double load, double dt) {
  World world(scenes::standard_gravity, 10);
  btRigidBody& hub = world.add_box(1, vec(0.1, 0.1, 0.1), btTransform::getIdentity());
  const btTransform below(btQuaternion::getIdentity(), vec(0, 0, -0.3));
  btRigidBody& hung = world.add_box(load, vec(0.1, 0.1, 0.1), below);
  // x up.
  const btTransform upwards(btQuaternion(vec(0, 1, 0), scalar(-pi / 2)));
  auto& rail = world.add_joint<pintle::SliderJoint>(hub, upwards, true);
  rail.setLowerLinLimit(0);
  rail.setUpperLinLimit(0);
  rail.setLinLimitSpring(scalar(frequency), 1);
  world.add_joint<pintle::BallJoint>(hub, hung, vec(0, 0, -0.1), vec(0, 0, 0.2));
  // It swings out with the time constant (1 + load) / omega.
  const double seconds = 10 * (1 + load) / (2 * pi * frequency) + 1;
  for (int i = 0; i < int(seconds / dt); ++i) world.step(dt);
  EXPECT_LT(hub.getLinearVelocity().length(), 1e-3);
  return -double(hub.getCenterOfMassPosition().z());
}

TEST(LoadedSpring, GivesByWhatItBearsInAll) {
  for (const double load : {0.1, 1., 10.}) {
    for (const double frequency : {0.5, 1.5, 4.}) {
      for (const double dt : {1. / 60, 1. / 240}) {
        SCOPED_TRACE(testing::Message() << load << " kg, " << frequency << " Hz, " << dt << " s");
        // The spring is that of the hub alone.
        const double stiffness = std::pow(2 * pi * frequency, 2);
        const double expected = (1 + load) * scenes::standard_gravity / stiffness;
        EXPECT_NEAR(sag(frequency, load, dt), expected, (onExactSolver() ? 1e-3 : 0.01) * expected);
      }
    }
  }
}

// The same of six servos in a row: an arm of 1.8 m holds 20 kg level.
TEST(LoadedSpring, AnArmOfServosIsLevel) {
  if (!onExactSolver()) GTEST_SKIP() << "a servo of one joint does not know of the others there";
  World world(scenes::standard_gravity, 10);
  constexpr double length = 0.3;
  btRigidBody* last = &world.add_box(0, vec(0.15, 0.05, 0.05), btTransform::getIdentity());
  std::vector<pintle::QuaternionHinge*> hinges;
  for (int i = 1; i <= 6; ++i) {
    const btTransform pose(btQuaternion::getIdentity(), vec(length * i, 0, 0));
    btRigidBody& link = world.add_box(i < 6 ? 2 : 20, vec(0.15, 0.05, 0.05), pose);
    const btVector3 end = vec(length / 2, 0, 0), y = vec(0, 1, 0);
    hinges.push_back(&world.add_joint<pintle::QuaternionHinge>(*last, link, end, -end, y, y));
    hinges.back()->setMotorServo(0, 5000, 1, support::infinite);
    last = &link;
  }
  for (int step = 0; step < 120; ++step) {
    world.step(1. / 60);
    for (pintle::QuaternionHinge* const hinge : hinges)
      ASSERT_LT(std::abs(double(hinge->getHingeAngle())), 1e-3) << step;
  }
}

}  // namespace loaded_spring_test
