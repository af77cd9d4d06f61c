// Rows with bounds on ExactJointSolver: motors, softness, limits, what they do to momentum and energy, and how contacts take them.
#include <pintle/joints/angular_limit.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/solver/exact_joint_solver.h>
#include <pintle/solver/uses_exact_solver.h>

#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpringConstraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <gtest/gtest.h>
#include <scenes/angles.h>
#include <scenes/world.h>

#include "exact_support.h"
#include "support.h"

namespace exact_bounds_test {
namespace {

using pintle::BallJoint;
using pintle::FixedJoint;
using pintle::QuaternionHinge;
using scenes::World;
using support::scalar;
using support::vec;
using namespace exact_support;

// --- rows with bounds --------------------------------------------------------------------------------

// A motor turns an arm that has ten times its mass fixed to its end.
struct Driven {
  Driven(double torque, double gravity) : world(gravity, 4, exact) {
    arm = &world.add_box(1, vec(0.5, 0.1, 0.1), at(0.5, 0, 0));
    btRigidBody& end = world.add_box(10, vec(0.1, 0.1, 0.1), at(1.1, 0, 0));
    hinge = &world.add_joint<QuaternionHinge>(*arm, vec(-0.5, 0, 0), vec(0, 1, 0));
    world.add_joint<FixedJoint>(*arm, end, at(0.5, 0, 0), at(-0.1, 0, 0));
    hinge->enableAngularMotor(true, scalar(speed), scalar(torque / 60));
    hinge->enableFeedback(true);
    // About the hinge: the boxes' own, and what they have off it.
    inertia = 1.04 / 12 + 0.25 + 10 * (0.08 / 12 + 1.1 * 1.1);
  }
  double turned() {
    const Eigen::Vector3d x = scenes::direction_in_world(*arm, {1, 0, 0});
    return std::abs(unwrap(std::atan2(x.z(), x.x())));
  }
  static constexpr double speed = 2;  // rad/s
  World world;
  btRigidBody* arm;
  QuaternionHinge* hinge;
  double inertia;
  scenes::Unwrap unwrap{0};
};

// In every step, whatever the load, the gravity and the end of the step ask of the joints.
TEST(ExactJointSolver, AStrongMotorTurnsByItsSpeed) {
  Driven driven(1e6, 9.81);
  for (int i = 1; i <= 300; ++i) {
    driven.world.step(1. / 60);
    ASSERT_NEAR(driven.turned(), Driven::speed * i / 60, 1e-4) << i;
  }
}

// Neither more nor less: it is at its bound in the first steps, and within it when the speed is reached.
TEST(ExactJointSolver, AWeakMotorGivesItsTorque) {
  const double torque = 10;
  Driven driven(torque, 0);
  const int steps = int(Driven::speed * driven.inertia / torque * 60);
  for (int i = 1; i <= 2 * steps; ++i) {
    driven.world.step(1. / 60);
    const double speed = std::abs(double(driven.arm->getAngularVelocity().y()));
    const double of = std::min(torque * i / 60 / driven.inertia, Driven::speed);
    ASSERT_NEAR(speed, of, 1e-3) << i;
    const double impulse = std::abs(double(driven.hinge->getAppliedImpulse()));
    ASSERT_NEAR(impulse, i < steps ? torque / 60 : std::min(impulse, torque / 60), 1e-6) << i;
  }
}

// Its bounds then take all rows of the AngularLimit out of the system. (A step turns by a sixth of a rad, and its chord is
// short by half a percent: the closed form is that of short steps.)
TEST(ExactJointSolver, AMotorAtItsBoundBesideAHingeThatSpinsGivesItsImpulse) {
  constexpr double radius = 0.5, speed = 10, impulse = 0.02;
  World world(0, 10, exact);
  btRigidBody& post = world.add_box(0, vec(0.1, 0.1, 0.1), at(0, 0, 0));
  btRigidBody& arm = world.add_box(1, vec(radius, 0.05, 0.05), at(radius, 0, 0));
  world.add_joint<QuaternionHinge>(post, arm, at(0, 0, 0), at(-radius, 0, 0));
  auto& motor = world.add_joint<pintle::AngularLimit>(post, arm, at(0, 0, 0), at(-radius, 0, 0));
  motor.enableAngularMotor(true, -100, scalar(impulse));
  arm.setAngularVelocity(vec(0, 0, speed));
  arm.setLinearVelocity(vec(0, radius * speed, 0));
  const double inertia = 1 / double(arm.getInvInertiaTensorWorld()[2][2]) + radius * radius;
  // It starts on the tangent, and goes on along chords: the first two steps take what lies between.
  double start = speed;
  for (int i = 1; i <= 60; ++i) {
    world.step(1. / 60);
    ASSERT_NEAR(double(motor.getMotorImpulse()), -impulse, 1e-6) << i;
    ASSERT_LT(double((arm.getCenterOfMassTransform() * vec(-radius, 0, 0)).length()), 1e-5) << i;
    const double now = double(arm.getAngularVelocity().z()),
                 expected = start - i * impulse / inertia;
    if (i == 2) {
      start += now - expected;
      ASSERT_NEAR(now, expected, 0.035 * expected);
    }
    if (i > 2) {
      ASSERT_NEAR(now, expected, 0.01 * expected) << i;
    }
  }
}

// --- softness --------------------------------------------------------------------------------------

// lambda of one step against a row of any softness: K (1 + cfm) lambda = -v, with K = 1 / m.
TEST(ExactJointSolver, SoftRowsAreExact) {
  for (const double cfm : {0., 0.5, 2., 100.}) {
    World world(0, 10, exact);
    btRigidBody& body = world.add_box(2, vec(0.1, 0.1, 0.1), at(0, 0, 0));
    auto& joint = world.add_joint<BallJoint>(body, vec(0, 0, 0));
    joint.setParam(BT_CONSTRAINT_CFM, scalar(cfm));
    body.setLinearVelocity(vec(1, 2, 3));
    world.step(1. / 60);
    const double left = cfm / (1 + cfm);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(double(body.getLinearVelocity()[k]), left * (k + 1), 1e-6) << cfm;
  }
}

// --- momentum and energy -----------------------------------------------------------------------------

// Two rods on a hinge at their ends that fly at each other, with limits on both sides.
struct ThrownPair {
  World world{0, 10, exact};
  btRigidBody& a = world.add_box(2, vec(0.2, 0.1, 0.05), at(0.3, 0, 0));
  btRigidBody& b = world.add_box(2, vec(0.2, 0.1, 0.05), at(0, -0.3, 0));
  QuaternionHinge& hinge =
      world.add_joint<QuaternionHinge>(a, b, at(-0.3, 0, 0), at(0, 0.3, 0), false);

  explicit ThrownPair(double speed) {
    for (btRigidBody* body : {&a, &b}) {
      const btVector3 w(0, 0, scalar(body == &a ? speed : -speed));
      body->setAngularVelocity(w);
      body->setLinearVelocity(w.cross(body->getCenterOfMassPosition()));
    }
  }
  double spin(const btRigidBody& body) const {
    return double(body.getAngularVelocity().z() / body.getInvInertiaTensorWorld()[2][2] +
                  body.getCenterOfMassPosition().cross(body.getLinearVelocity()).z() /
                      body.getInvMass());
  }
};

TEST(ExactJointSolver, AFreePairThatHitsItsLimitsKeepsItsAngularMomentum) {
  for (const double speed : {10., 30., 60.}) {
    ThrownPair pair(speed);
    pair.hinge.setLimit(scalar(-1.5), scalar(1.5), scalar(0.9), scalar(0.3), 1);
    const double one = std::abs(pair.spin(pair.a));
    double worst = 0;
    for (int i = 0; i < 120; ++i) {
      pair.world.step(1. / 60);
      worst = std::max(worst, std::abs(pair.spin(pair.a) + pair.spin(pair.b)));
    }
    EXPECT_LT(worst, 0.02 * one) << speed;
  }
}

// For a minute, at up to a radian a step against each other.
TEST(ExactJointSolver, AFreePairThatSpinsGainsNoEnergy) {
  for (const double speed : {5., 10., 20., 30.}) {
    ThrownPair pair(speed);
    const auto energy = [&] { return scenes::energy(pair.a, 0) + scenes::energy(pair.b, 0); };
    const double start = energy();
    double least = HUGE_VAL, most = 0, top = 0;
    for (int i = 0; i < 3600; ++i) {
      pair.world.step(1. / 60);
      least = std::min(least, energy() / start);
      most = std::max(most, energy() / start);
      top = std::max(
          top, std::abs(double(pair.a.getAngularVelocity().z() - pair.b.getAngularVelocity().z())));
    }
    // The chord's speed differs from the circle's by half of the turn of a step, squared.
    const double chord = std::pow(top / 60 / 2, 2);
    EXPECT_LT(most, 1 + chord) << speed;
    // Beyond that an end that would feed the spin is done without, which takes from it: in the first seconds, down
    // to where half a radian a step is left.
    EXPECT_GT(least, speed <= 10 ? 1 - chord : speed <= 20 ? 0.5 : 0.4) << speed;
  }
}

// Plates in a ring, each linked with the one above it and the one beside it by joints with limits, under a body that its owner swings. Many
// limits are met at once: which of them act takes no more factors than there are. Where they are in the way of what holds the plates together, this
// comes first.
TEST(ExactJointSolver, ASkirtHoldsTogetherWithABudgetOfFactors) {
  constexpr int columns = 12, rows = 4;
  World world(9.81, 10, exact);
  btRigidBody& hip = world.add_box(0, vec(0.8, 0.6, 0.5), at(0, 0, 0));
  hip.setCollisionFlags(hip.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
  const auto about = [](int half_columns) {
    return btQuaternion(vec(0, 0, 1), scalar(scenes::pi * half_columns / columns));
  };
  std::vector<btGeneric6DofSpringConstraint*> joints;
  const auto join = [&](btRigidBody& a, btRigidBody& b, const btTransform& frame, double swing) {
    auto& joint = world.join<btGeneric6DofSpringConstraint>(a, b, frame, true);
    // (Bullet makes no row of an axis that is locked at where it is just now.)
    joint.setLinearLowerLimit(vec(1e-6, 1e-6, 1e-6));
    joint.setLinearUpperLimit(vec(1e-6, 1e-6, 1e-6));
    joints.push_back(&joint);
    joint.setAngularLowerLimit(vec(-swing, -swing, -swing));
    joint.setAngularUpperLimit(vec(swing, swing, swing));
  };
  btRigidBody* plates[columns][rows];
  for (int c = 0; c < columns; ++c)
    for (int r = 0; r < rows; ++r) {
      const btQuaternion turn = about(2 * c);
      const auto place = [&](double below) {
        return at(quatRotate(turn, vec(1 + 0.15 * below, 0, -0.9 * below)), turn);
      };
      plates[c][r] = &world.add_box(1 - 0.1 * r, vec(0.05, 0.22, 0.42), place(r + 0.5));
      plates[c][r]->setDamping(scalar(0.9), scalar(0.9));
      join(r > 0 ? *plates[c][r - 1] : hip, *plates[c][r], place(r), 0.3);
    }
  for (int c = 0; c < columns; ++c)
    for (int r = 1; r < rows; ++r) {
      const btQuaternion turn = about(2 * c + 1);
      join(*plates[c][r], *plates[(c + 1) % columns][r],
           at(quatRotate(turn, vec(1 + 0.15 * r, 0, -0.9 * (r + 0.5))), turn), 0.35);
    }
  int most = 0;
  double gap = 0;
  for (int i = 0; i < 240; ++i) {
    const double t = i / 60.;
    hip.setWorldTransform(at(vec(2 * std::sin(9 * t), 0, 0),
                             btQuaternion(vec(0, 0, 1), scalar(1.2 * std::sin(9 * t)))));
    world.step(1. / 60);
    most = std::max(most, pintle::lastStep(world.bullet()).factorisations);
    for (btGeneric6DofSpringConstraint* joint : joints) {
      if (&joint->getRigidBodyA() == &hip) continue;  // the hip's velocity is not that of its pose
      joint->calculateTransforms();
      for (int k = 0; k < 3; ++k)
        gap = std::max(gap, std::abs(double(joint->getRelativePivotPosition(k)) - 1e-6));
    }
    for (const auto& column : plates)
      for (const btRigidBody* plate : column) ASSERT_TRUE(support::is_finite(*plate)) << i;
  }
  // Velocities are solved for by the set, by passes, and again where the load swings; poses come after them.
  EXPECT_LE(most, 3 * pintle::SolverOptions().max_factors);
  EXPECT_LE(gap, 0.01) << "m";
}

// A boom of two arms lies on the limits of its hinges, and its foot on the ground. What is iterated begins with what
// it had in the last step: so few iterations bear it.
template <class Hinge>
struct Boom {
  explicit Boom(const scenes::SolverFactory& make_solver) : world(9.81, 4, make_solver) {
    addFloor(world);
    btRigidBody* const bodies[] = {&world.add_box(50, vec(1, 1, 1), at(0, 0, 1), true),
                                   &world.add_box(1, vec(0.5, 0.1, 0.1), at(1.5, 0, 1.9), true),
                                   &world.add_box(1, vec(0.5, 0.1, 0.1), at(2.5, 0, 1.9), true)};
    for (int i = 0; i < 2; ++i) {
      btTransform frame = at(1 + i, 0, 1.9);
      frame.setRotation(
          btQuaternion(vec(1, 0, 0), scalar(-scenes::pi / 2)));  // z along the world's y
      hinges[i] = &world.join<Hinge>(*bodies[i], *bodies[i + 1], frame);
      hinges[i]->setLimit(scalar(-0.1), scalar(0.1));
    }
  }
  /// The furthest that they are beyond their limits in a second from now, rad.
  double furthest() {
    double most = 0;
    for (int step = 0; step < 60; ++step) {
      world.step(1. / 60);
      for (Hinge* hinge : hinges)
        most = std::max(most, std::abs(double(hinge->getHingeAngle())) - 0.1);
    }
    return most;
  }
  World world;
  Hinge* hinges[2];
};

TEST(ExactJointSolver, AmongContactsLimitsAreBorneOverTheSteps) {
  Boom<QuaternionHinge> boom(exact);
  for (int step = 0; step < 240; ++step) boom.world.step(1. / 60);
  EXPECT_LT(boom.furthest(), 1e-4);
}

TEST(ExactJointSolver, AmongContactsLimitsOfBulletsHingesAreBorneOverTheSteps) {
  Boom<btHingeConstraint> boom(exact), stock({});
  for (Boom<btHingeConstraint>* each : {&boom, &stock})
    for (int step = 0; step < 240; ++step) each->world.step(1. / 60);
  // In each of them: a limit that closes has no row of Bullet's in the next step. In single precision, what contacts leave may close
  // one once in a minute: then it falls for a step.
  for (int second = 0; second < 60; ++second)
    EXPECT_LT(boom.furthest(), stock.furthest() / (support::is_double ? 100 : 20)) << second;
}

// Of seven rows and more.
TEST(ExactJointSolver, AMotorAboutThreeAxesPressesOnALimit) {
  World world(0, 10, exact);
  btRigidBody& frame = world.add_box(0, vec(0.2, 0.3, 0.25), at(0, 0, 0));
  btRigidBody& limb = world.add_box(1, vec(0.3, 0.06, 0.08), at(0, 0, 0));
  auto& joint = world.add_joint<pintle::ConeTwistJoint>(limb, frame, at(0, 0, 0), at(0, 0, 0));
  joint.enableMotor(true);
  const btVector3 target = vec(0.5, 0.3, 0.2);
  joint.setMotorTargetInConstraintSpace(btQuaternion(target.normalized(), target.length()));
  for (int i = 0; i < 120; ++i) world.step(1. / 60);
  EXPECT_GT(double(joint.getTwist()), 0.505);
  joint.setLimit(1, 1, scalar(0.5));
  joint.setMotorVelocity(vec(3, 0, 0));
  joint.setMaxMotorImpulse(scalar(0.1));
  for (int i = 0; i < 120; ++i) world.step(1. / 60);
  EXPECT_NEAR(double(joint.getTwist()), 0.5, 1e-3);
}

}  // namespace
}  // namespace exact_bounds_test
