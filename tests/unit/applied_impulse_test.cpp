// getAppliedImpulse: Bullet hands out the impulse of a joint's last row. Wherever stock's last row is of the same
// thing as ours it has the sign that it has for the stock joint, and the value. It is of another thing for a hinge
// without limit or motor (stock's is a moment, ours the pivot's along z), for a universal joint with a limit unless
// setUseFrameOffset(false) (stock's is the pivot's along z, ours the limit's), and for the motor of a cone-twist joint
// within 0.1 rad of its target.
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

#include <type_traits>

#include "support.h"

namespace applied_impulse_test {

using support::scalar;
using support::vec;

constexpr double dt = 1.0 / 60;
constexpr double mass = 2, weight = 20, arm = 0.5;

// What pulls at a body that hangs on one that does not move, along the axes of the joint frames, which are those of
// the world: where its centre is from the joint (m), gravity (m/s^2), and a torque (N m).
struct Load {
  btVector3 centre, gravity, torque;
};
Load gravity(const btVector3& centre, const btVector3& g) { return {centre, g, vec(0, 0, 0)}; }
Load torque(const btVector3& torque) { return {vec(0, 0, 0), vec(0, 0, 0), torque}; }

// From its frames, or from what says the same.
template <class Joint, class... More>
Joint& makeJoint(scenes::World& world, btRigidBody& a, btRigidBody& b, const btTransform& frame_a,
                 const btTransform& frame_b, More... more) {
  if constexpr (std::is_constructible_v<Joint, btRigidBody&, btRigidBody&, btTransform, btTransform,
                                        More...>)
    return world.add_joint<Joint>(a, b, frame_a, frame_b, more...);
  else if constexpr (std::is_constructible_v<Joint, btRigidBody&, btRigidBody&, btVector3,
                                             btVector3>)
    return world.add_joint<Joint>(a, b, frame_a.getOrigin(), frame_b.getOrigin());
  else
    return world.add_joint<Joint>(a, b, vec(0, 0, 0), vec(0, 0, 1), vec(0, 1, 0));
}

// What the joint says when all has come to rest: the mean of two seconds.
template <class Joint, class Set, class... More>
double applied(const Load& load, bool a_moves, Set set, More... more) {
  scenes::World world(0, 50);
  world.bullet().setGravity(load.gravity);
  btRigidBody& moving = world.add_box(mass, vec(0.3, 0.2, 0.1), scenes::pose_at(load.centre));
  btRigidBody& still = world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
  moving.setDamping(scalar(0.5), scalar(0.5));
  const btTransform centre = scenes::pose_at(-load.centre), origin = scenes::pose_at(vec(0, 0, 0));
  Joint& joint = a_moves ? makeJoint<Joint>(world, moving, still, centre, origin, more...)
                         : makeJoint<Joint>(world, still, moving, origin, centre, more...);
  set(joint);
  joint.enableFeedback(true);
  const auto step = [&] {
    moving.applyTorque(load.torque);
    world.step(dt);
    return double(joint.getAppliedImpulse());
  };
  for (int i = 0; i < 600; ++i) step();
  double sum = 0;
  constexpr int n = 120;
  for (int i = 0; i < n; ++i) sum += step();
  return sum / n;
}

// `size`: what it has to be (N s, N m s), whatever its sign.
template <class Ours, class Stock, class Set, class... More>
void expectAsStock(const char* what, double size, const Load& load, Set set, More... more) {
  for (const bool a_moves : {true, false}) {
    SCOPED_TRACE(testing::Message() << what << (a_moves ? ", a moves" : ", b moves"));
    const double stock = applied<Stock>(load, a_moves, set, more...);
    EXPECT_NEAR(std::abs(stock), size, 0.04 * size);
    EXPECT_NEAR(applied<Ours>(load, a_moves, set, more...), stock, 0.04 * size);
  }
}

const auto as_made = [](auto&) {};

TEST(AppliedImpulse, OfABallIsStocks) {
  for (const double g : {-10, 10})
    expectAsStock<pintle::BallJoint, btPoint2PointConstraint>(
        "pivot", weight * dt, gravity(vec(0, 0, 0), vec(1, 2, g)), as_made);
}

TEST(AppliedImpulse, OfAHingeIsStocks) {
  const auto expectSame = [](const char* what, double moment, auto set) {
    expectAsStock<pintle::QuaternionHinge, btHingeConstraint>(
        what, std::abs(moment) * dt, torque(vec(1, 2, moment)), set, false);
  };
  for (const double moment : {-8, 8}) {  // onto the low limit, and the high one
    expectSame("limit", moment,
               [](auto& j) { j.setLimit(scalar(-0.1), scalar(0.1), 1, scalar(0.3), 0); });
    expectSame("motor", moment, [](auto& j) { j.enableAngularMotor(true, 0, 100); });
    expectSame("weak motor, on a limit", moment, [](auto& j) {
      j.setLimit(scalar(-0.1), scalar(0.1), 1, scalar(0.3), 0);
      j.enableAngularMotor(true, 0, scalar(0.003));
    });
  }
}

TEST(AppliedImpulse, OfASliderIsStocks) {
  for (const bool reference_a : {true, false}) {
    const auto expectSame = [=](const char* what, double size, const Load& load, auto set) {
      SCOPED_TRACE(reference_a);
      expectAsStock<pintle::SliderJoint, btSliderConstraint>(what, size, load, set, reference_a);
    };
    const auto turns = [](auto& j) {
      j.setLowerAngLimit(1);
      j.setUpperAngLimit(-1);
    };
    const auto linear_limits = [](auto& j) {
      j.setLowerLinLimit(scalar(-0.1));
      j.setUpperLinLimit(scalar(0.1));
    };
    for (const double sign : {-1, 1}) {
      const Load along = gravity(vec(0, 0, 0), vec(sign * 10, 1, 2));
      expectSame("linear limit", weight * dt, along, [&](auto& j) { linear_limits(j), turns(j); });
      expectSame("linear motor", weight * dt, along, [&](auto& j) {
        turns(j);
        j.setPoweredLinMotor(true);
        j.setMaxLinMotorForce(1000);
      });
      // The angle's row is the last one, also where the slide is at its limit.
      Load about = torque(vec(sign * 8, 1, 2));
      about.gravity = vec(10, 0, 0);
      expectSame("angular limit", 8 * dt, about, [&](auto& j) {
        linear_limits(j);
        j.setLowerAngLimit(scalar(-0.1));
        j.setUpperAngLimit(scalar(0.1));
      });
      expectSame("angular motor", 8 * dt, about, [&](auto& j) {
        linear_limits(j), turns(j);
        j.setPoweredAngMotor(true);
        j.setMaxAngMotorForce(1000);
      });
    }
  }
}

TEST(AppliedImpulse, OfAConeTwistJointIsStocks) {
  const auto expectSame = [](const char* what, double size, const Load& load, auto set) {
    expectAsStock<pintle::ConeTwistJoint, btConeTwistConstraint>(what, size, load, set);
  };
  const btVector3 x = vec(arm, 0, 0), y = vec(0, arm, 0);
  const double moment = weight * arm * dt;
  for (const double g : {-10, 10}) {
    expectSame("pivot", weight * dt, gravity(vec(0, 0, 0), vec(1, 2, g)), as_made);
    const Load swing_1 = gravity(x, vec(0, g, 0)), swing_2 = gravity(x, vec(0, 0, g));
    const auto cone = [](auto& j) { j.setLimit(scalar(0.1), scalar(0.15), 3); };
    expectSame("swing 1", moment, swing_1, cone);
    expectSame("swing 2", moment, swing_2, cone);
    expectSame("swing 1, the other one locked", moment, swing_1,
               [](auto& j) { j.setLimit(scalar(0.1), 0, 3); });
    expectSame("swing 2, the other one locked", moment, swing_2,
               [](auto& j) { j.setLimit(0, scalar(0.1), 3); });
    expectSame("twist", moment, gravity(y, vec(0, 0, g)),
               [](auto& j) { j.setLimit(1, 1, scalar(0.1)); });
    expectSame("a motor that cannot lift", 0.05, swing_1, [&](auto& j) {
      j.enableMotor(true);
      j.setMaxMotorImpulse(scalar(0.05));
      j.setMotorTarget(btQuaternion(vec(0, 0, 1), scalar(g > 0 ? -0.5 : 0.5)));
    });
  }
}

TEST(AppliedImpulse, OfAUniversalJointIsStocks) {
  const auto expectSame = [](const char* what, double size, const Load& load, auto set) {
    expectAsStock<pintle::UniversalJoint, btUniversalConstraint>(what, size, load, set);
  };
  const double moment = weight * arm * dt;
  for (const double g : {-10, 10}) {
    expectSame("pivot", weight * dt, gravity(vec(0, 0, 0), vec(1, 2, g)), as_made);
    // Rows as they stand, in which stock's limit comes last, too.
    expectSame("angle 1", moment, gravity(vec(arm, 0, 0), vec(0, g, 0)), [](auto& j) {
      j.setUseFrameOffset(false);
      j.setLowerLimit(1, scalar(-0.1));
      j.setUpperLimit(-1, scalar(0.1));
    });
    expectSame("angle 2", moment, gravity(vec(arm, 0, 0), vec(0, 0, g)), [](auto& j) {
      j.setUseFrameOffset(false);
      j.setLowerLimit(scalar(-0.1), 1);
      j.setUpperLimit(scalar(0.1), -1);
    });
  }
}

TEST(AppliedImpulse, OfAFixedJointIsStocks) {
  for (const double g : {-10, 10})
    expectAsStock<pintle::FixedJoint, btFixedConstraint>(
        "pivot", weight * dt, gravity(vec(arm, 0.1, 0.2), vec(1, 2, g)), as_made);
}

}  // namespace applied_impulse_test
