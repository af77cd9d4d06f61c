// getAppliedImpulse: Bullet hands out the impulse of a joint's last row. Where that is of the same thing, it
// has the sign that it has for the stock joint, and the value.
#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <BulletDynamics/ConstraintSolver/btUniversalConstraint.h>
#include <gtest/gtest.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/universal_joint.h>

#include "support.h"

namespace applied_impulse_test {

using support::scalar;
using support::vec;

constexpr double dt = 1.0 / 60;
constexpr double mass = 2;

// A body that weighs on a joint to one that does not move: its centre from the joint, m, and gravity, m/s^2,
// along the axes of the joint frames, which are those of the world.
struct Load {
  btVector3 centre, gravity;
  bool a_moves = true;  ///< or b
};

// What the joint says when all has come to rest: the mean of a tenth of a second.
template <class Joint, class Set, class... Arguments>
double applied(const Load& load, Set set, Arguments... arguments) {
  scenes::World world(0, 50);
  world.bullet().setGravity(load.gravity);
  btRigidBody& moving = world.add_box(mass, vec(0.3, 0.2, 0.1), scenes::pose_at(load.centre));
  btRigidBody& still = world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
  moving.setDamping(scalar(0.5), scalar(0.5));
  const btTransform centre = scenes::pose_at(-load.centre), origin = scenes::pose_at(vec(0, 0, 0));
  const auto make = [&](auto& a, auto& b, const btTransform& frame_a, const btTransform& frame_b) -> Joint& {
    if constexpr (std::is_constructible_v<Joint, btRigidBody&, btRigidBody&, btTransform, btTransform, Arguments...>)
      return world.add_joint<Joint>(a, b, frame_a, frame_b, arguments...);
    else if constexpr (std::is_constructible_v<Joint, btRigidBody&, btRigidBody&, btVector3, btVector3>)
      return world.add_joint<Joint>(a, b, frame_a.getOrigin(), frame_b.getOrigin());
    else
      return world.add_joint<Joint>(a, b, vec(0, 0, 0), vec(0, 0, 1), vec(0, 1, 0));
  };
  Joint& joint = load.a_moves ? make(moving, still, centre, origin) : make(still, moving, origin, centre);
  set(joint);
  joint.enableFeedback(true);
  for (int i = 0; i < 600; ++i) world.step(dt);
  double sum = 0;
  constexpr int n = 6;
  for (int i = 0; i < n; ++i) {
    world.step(dt);
    sum += double(joint.getAppliedImpulse());
  }
  return sum / n;
}

template <class Ours, class Stock, class Set, class... Arguments>
void expectAsStock(const char* what, Load load, Set set, Arguments... arguments) {
  for (const bool a_moves : {true, false}) {
    SCOPED_TRACE(testing::Message() << what << (a_moves ? ", a moves" : ", b moves"));
    load.a_moves = a_moves;
    const double stock = applied<Stock>(load, set, arguments...);
    const double ours = applied<Ours>(load, set, arguments...);
    std::printf("%-40s %d  stock %10.5f ours %10.5f\n", what, a_moves, stock, ours);
    EXPECT_GT(std::abs(stock), 0.01 * mass * dt);
    EXPECT_NEAR(ours, stock, 0.03 * std::abs(stock));
  }
}

const auto as_made = [](auto&) {};

TEST(AppliedImpulse, OfABallIsStocks) {
  for (const double z : {-10, 10})
    expectAsStock<pintle::BallJoint, btPoint2PointConstraint>("ball", {vec(0, 0, 0), vec(1, 2, z)}, as_made);
}

TEST(AppliedImpulse, OfAHingeIsStocks) {
  const auto expectSame = [](const char* what, const Load& load, auto set) {
    expectAsStock<pintle::QuaternionHinge, btHingeConstraint>(what, load, set, false);
  };
  for (const double down : {-10, 10}) {
    const Load load{vec(0.5, 0.1, 0.2), vec(0, down, 1)};
    expectSame("hinge limit", load, [](auto& j) { j.setLimit(scalar(-0.02), scalar(0.02)); });
    expectSame("hinge motor", load, [](auto& j) { j.enableAngularMotor(true, 0, 100); });
    expectSame("hinge free", {vec(0.5, 0, 0.2), vec(10, 0, down)}, as_made);
  }
}

TEST(AppliedImpulse, OfASliderIsStocks) {
  for (const bool reference_a : {true, false}) {
    const auto expectSame = [=](const char* what, const Load& load, auto set) {
      expectAsStock<pintle::SliderJoint, btSliderConstraint>(what, load, set, reference_a);
    };
    for (const double down : {-10, 10}) {
      const auto lin = [](auto& j) { j.setLowerLinLimit(scalar(-0.02)); j.setUpperLinLimit(scalar(0.02));
        j.setLowerAngLimit(1); j.setUpperAngLimit(-1); };
      const auto linmotor = [](auto& j) { j.setPoweredLinMotor(true); j.setMaxLinMotorForce(1000); j.setLowerAngLimit(1); j.setUpperAngLimit(-1); };
      const auto ang = [](auto& j) { j.setLowerLinLimit(scalar(-0.02)); j.setUpperLinLimit(scalar(0.02));
        j.setLowerAngLimit(scalar(-0.02)); j.setUpperAngLimit(scalar(0.02)); };
      const auto angmotor = [](auto& j) { j.setLowerLinLimit(scalar(-0.02)); j.setUpperLinLimit(scalar(0.02));
        j.setLowerAngLimit(1); j.setUpperAngLimit(-1); j.setPoweredAngMotor(true); j.setMaxAngMotorForce(1000); };
      expectSame("slider lin limit", {vec(0, 0, 0), vec(down, 1, 2)}, lin);
      expectSame("slider lin motor", {vec(0, 0, 0), vec(down, 1, 2)}, linmotor);
      expectSame("slider ang limit", {vec(0, 0.5, 0), vec(1, 0, down)}, ang);
      expectSame("slider ang motor", {vec(0, 0.5, 0), vec(1, 0, down)}, angmotor);
    }
  }
}

TEST(AppliedImpulse, OfAConeTwistJointIsStocks) {
  const auto expectSame = [](const char* what, const Load& load, auto set) {
    expectAsStock<pintle::ConeTwistJoint, btConeTwistConstraint>(what, load, set);
  };
  for (const double down : {-10, 10}) {
    expectSame("cone free", {vec(0, 0, 0), vec(1, 2, down)}, as_made);
    const auto swing = [](auto& j) { j.setLimit(scalar(0.1), scalar(0.2), 3); };
    expectSame("cone swing 1", {vec(0.5, 0, 0), vec(0, down, 0)}, swing);
    expectSame("cone swing 2", {vec(0.5, 0, 0), vec(0, 0, down)}, swing);
    expectSame("cone swing both", {vec(0.5, 0, 0), vec(0, down, down)}, swing);
    const auto twist = [](auto& j) { j.setLimit(1, 1, scalar(0.1)); };
    expectSame("cone twist", {vec(0, 0.5, 0), vec(0, 0, down)}, twist);
    expectSame("cone swing 1 only", {vec(0.5, 0, 0), vec(0, down, 0)}, [](auto& j) { j.setLimit(scalar(0.1), 0, 3); });
    expectSame("cone swing 2 only", {vec(0.5, 0, 0), vec(0, 0, down)}, [](auto& j) { j.setLimit(0, scalar(0.1), 3); });
    const auto motor = [](auto& j) { j.enableMotor(true); j.setMaxMotorImpulse(100); j.setMotorTarget(btQuaternion::getIdentity()); };
    expectSame("cone motor swing1", {vec(0.5, 0, 0), vec(0, down, 0)}, motor);
    expectSame("cone motor swing2", {vec(0.5, 0, 0), vec(0, 0, down)}, motor);
    expectSame("cone motor twist", {vec(0, 0.5, 0), vec(0, 0, down)}, motor);
    const auto far = [](auto& j) { j.enableMotor(true); j.setMaxMotorImpulse(scalar(0.05)); j.setMotorTarget(btQuaternion(btVector3(0,0,1), scalar(0.5))); };
    expectSame("cone motor held back", {vec(0.5, 0, 0), vec(0, down, 0)}, far);
  }
}

TEST(AppliedImpulse, OfAUniversalJointIsStocks) {
  const auto expectSame = [](const char* what, const Load& load, auto set) {
    expectAsStock<pintle::UniversalJoint, btUniversalConstraint>(what, load, set);
  };
  for (const double down : {-10, 10}) {
    expectSame("universal free", {vec(0, 0, 0), vec(1, 2, down)}, as_made);
    const auto limits = [](auto& j) { j.setLowerLimit(scalar(-0.1), scalar(-0.1)); j.setUpperLimit(scalar(0.1), scalar(0.1)); };
    expectSame("universal angle 1", {vec(0.5, 0, 0), vec(0, down, 1)}, limits);
    expectSame("universal angle 2", {vec(0.5, 0, 0), vec(0, 1, down)}, limits);
  }
}

TEST(AppliedImpulse, OfAFixedJointIsStocks) {
  for (const double down : {-10, 10})
    expectAsStock<pintle::FixedJoint, btFixedConstraint>("fixed", {vec(0.5, 0.1, 0.2), vec(1, 2, down)}, as_made);
}

}  // namespace applied_impulse_test
