// A limit bears its load whatever else acts along its axis: 20 kg hang by a ball from what the limit holds, and a motor,
// a servo, friction or nothing acts beside it.
#include <gtest/gtest.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/universal_joint.h>

#include <algorithm>
#include <functional>
#include <ostream>

#include "support.h"

namespace loaded_limit_test {

using support::scalar;
using support::vec;

constexpr double limit = 0.1, load = 20, arm = 1, dt = 1. / 60, slack = 5e-3;

enum class Beside { nothing, motor, servo, friction };

struct Case {
  Beside beside;
  double part;  ///< of what holds the load
  int way;      ///< +1: out of the limit, -1: into it
};
std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << int(c.beside) << ", " << c.part << " of the load, " << c.way;
}

// How far beyond its limit the axis is at the most in 5 s. `beyond` is 0 at the limit, positive past it.
double farthest(scenes::World& world, const std::function<double()>& beyond) {
  double most = 0;
  for (int i = 0; i < 300; ++i) {
    world.step(dt);
    most = std::max(most, beyond());
  }
  return most;
}

// A horizontal arm on a hinge along y, z of its frame; it falls towards positive turns about y.
double hinge(const Case& c) {
  scenes::World world;
  btRigidBody& body = world.add_box(1, vec(0.5, 0.05, 0.05), scenes::pose_at(vec(0.5, 0, 0)));
  btRigidBody& hung = world.add_box(load, vec(0.2, 0.2, 0.2), scenes::pose_at(vec(arm, 0, -0.5)));
  auto& joint = world.add_joint<pintle::QuaternionHinge>(body, vec(-0.5, 0, 0), vec(0, 1, 0));
  world.add_joint<pintle::BallJoint>(body, hung, vec(0.5, 0, 0), vec(0, 0, 0.5));
  // The sign of the angle by which the arm falls.
  const btScalar side = joint.getHingeAngle(btTransform(btQuaternion(vec(0, 1, 0), scalar(0.1))),
                                            btTransform::getIdentity()) > 0
                            ? btScalar(1)
                            : btScalar(-1);
  if (side > 0)
    joint.setLimit(-1, scalar(limit), scalar(0.9), scalar(0.3), 0);
  else
    joint.setLimit(scalar(-limit), 1, scalar(0.9), scalar(0.3), 0);
  const double torque = c.part * 9.81 * (load * arm + 0.5);
  switch (c.beside) {
    case Beside::nothing: break;
    case Beside::motor:
      joint.enableAngularMotor(true, scalar(-3 * c.way) * side, scalar(torque * dt));
      break;
    case Beside::servo: joint.setMotorServo(scalar(-c.way) * side, 2, 1, scalar(torque)); break;
    case Beside::friction: joint.setFriction(scalar(torque)); break;
  }
  return farthest(world, [&] { return double(side * joint.getHingeAngle()) - limit; });
}

// A carriage on a vertical rail, x of its frame, positive down.
double slider(const Case& c) {
  scenes::World world;
  btRigidBody& body = world.add_box(1, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
  btRigidBody& hung = world.add_box(load, vec(0.2, 0.2, 0.2), scenes::pose_at(vec(0, 0, -0.5)));
  const btTransform rail(btQuaternion(vec(0, 1, 0), SIMD_HALF_PI));
  auto& joint = world.add_joint<pintle::SliderJoint>(body, rail, true);
  world.add_joint<pintle::BallJoint>(body, hung, vec(0, 0, 0), vec(0, 0, 0.5));
  joint.setLowerLinLimit(-1);
  joint.setUpperLinLimit(scalar(limit));
  const double force = c.part * 9.81 * (load + 1);
  switch (c.beside) {
    case Beside::nothing: break;
    case Beside::motor:
      joint.setPoweredLinMotor(true);
      joint.setTargetLinMotorVelocity(scalar(-3 * c.way));
      joint.setMaxLinMotorForce(scalar(force));
      break;
    case Beside::servo: joint.setLinMotorServo(scalar(-c.way), 2, 1, scalar(force)); break;
    case Beside::friction: joint.setLinFriction(scalar(force)); break;
  }
  return farthest(world, [&] { return -scenes::position(body).z() - limit; });
}

class LoadedLimit : public testing::TestWithParam<Case> {};

TEST_P(LoadedLimit, HoldsOfAHinge) {
  EXPECT_LE(hinge(GetParam()), hinge({Beside::nothing, 0, 1}) + slack) << "rad";
}

TEST_P(LoadedLimit, HoldsOfASlider) {
  EXPECT_LE(slider(GetParam()), slider({Beside::nothing, 0, 1}) + slack) << "m";
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const Beside beside : {Beside::motor, Beside::servo, Beside::friction})
    for (const double part : {0.3, 0.6, 0.9})
      for (const int way : {1, -1}) all.push_back({beside, part, way});
  return all;
}
INSTANTIATE_TEST_SUITE_P(All, LoadedLimit, testing::ValuesIn(cases()));

// The load is there: without the limit it falls.
TEST(LoadedLimit, IsNeeded) {
  EXPECT_GT(9.81 * load * arm, 100 * slack);
  EXPECT_LT(hinge({Beside::nothing, 0, 1}), slack);
  EXPECT_LT(slider({Beside::nothing, 0, 1}), slack);
}

}  // namespace loaded_limit_test
