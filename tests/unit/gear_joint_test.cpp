// Gears hold coordinates of joints, over any number of revolutions, on Bullet's solver and on the exact one. Angles are
// measured by the bodies' poses.
#include <gtest/gtest.h>
#include <pintle/joints/gear_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <string>
#include <vector>

#include "kinetic_energy.h"
#include "solver_of_tests.h"
#include "support.h"

namespace gear_joint_test {
namespace {

using pintle::GearCoordinate;
using pintle::GearJoint;
using pintle::QuaternionHinge;
using pintle::SliderJoint;
using scenes::pi;
using support::is_double;
using support::nan_value;
using support::refusal;
using support::scalar;
using support::vec;

constexpr double dt = 1. / 60;

// rad: how a body has turned about an axis of the world, revolutions counted, in double.
class Turns {
 public:
  Turns(const btRigidBody& body, const btVector3& axis) : m_body(body), m_axis(axis) {
    btPlaneSpace1(axis, m_x, m_y);
    m_in_body = body.getCenterOfMassTransform().getBasis().transpose() * m_x;
  }
  double operator()() {
    const btVector3 v = m_body.getCenterOfMassTransform().getBasis() * m_in_body;
    const double now = std::atan2(dot(v, m_axis.cross(m_x)), dot(v, m_x));
    m_angle += std::remainder(now - m_angle, 2 * pi);
    return m_angle;
  }

 private:
  static double dot(const btVector3& a, const btVector3& b) {
    return double(a.x()) * double(b.x()) + double(a.y()) * double(b.y()) +
           double(a.z()) * double(b.z());
  }
  const btRigidBody& m_body;
  btVector3 m_axis, m_x, m_y, m_in_body;
  double m_angle = 0;
};

const btVector3 z_axis = vec(0, 0, 1);

// Wheels about vertical axes on one frame, side by side.
struct Shop {
  scenes::World world;
  btRigidBody& frame;
  std::vector<btRigidBody*> wheels;
  std::vector<QuaternionHinge*> hinges;
  std::deque<Turns> turns;

  explicit Shop(double frame_mass = 0, int iterations = 10)
      : world(0, iterations),
        frame(world.add_box(frame_mass, vec(2, 2, 0.1), scenes::pose_at(vec(0, 0, 0)))) {}
  // kg m^2 about its axis.
  QuaternionHinge& addWheel(double inertia = 1) {
    const btVector3 x = vec(double(wheels.size()), 0, 0.5);
    btRigidBody& wheel = world.add_box(1, vec(0.4, 0.4, 0.1), scenes::pose_at(x));
    wheel.setMassProps(1, vec(inertia, inertia, inertia));
    wheel.updateInertiaTensor();
    wheels.push_back(&wheel);
    hinges.push_back(&world.join<QuaternionHinge>(frame, wheel, scenes::pose_at(x), true));
    turns.emplace_back(wheel, z_axis);
    return *hinges.back();
  }
  GearJoint& gear(int i, int j, double ratio) {
    return world.add_joint<GearJoint>(*hinges[size_t(i)], *hinges[size_t(j)], scalar(ratio));
  }
  double angle(int i) { return turns[size_t(i)](); }
  double speed(int i) { return double(wheels[size_t(i)]->getAngularVelocity().z()); }
  void spin(int i, double speed) { wheels[size_t(i)]->setAngularVelocity(vec(0, 0, speed)); }
  void step(int steps = 1) {
    for (int i = 0; i < steps; ++i) {
      world.step(dt);
      for (Turns& of : turns) of();
    }
  }
  double kinetic() const {
    double sum = 0;
    for (const btRigidBody* body : wheels)
      sum += support::kineticEnergy(*body, body->getCenterOfMassTransform().getBasis());
    return sum;
  }
};

// rad: what poses of single precision round, of an angle and its multiple.
double rounding(double ratio) { return (1 + std::abs(ratio)) * (is_double ? 1e-9 : 2e-6); }

// The tolerance of speeds. Gears close loops, of which the exact solver's rows are soft by 1e-8 of their K (SolverOptions::dependent_softness).
constexpr double of_speeds = is_double ? 1e-6 : 1e-4;

// A torque on the first wheel accelerates what both wheels weigh at it.
TEST(GearJoint, AcceleratesTheReflectedInertia) {
  for (const double ratio : {2.5, -double(scalar(1. / 3)), double(scalar(pi))}) {
    SCOPED_TRACE(ratio);
    Shop shop;
    shop.addWheel(1);
    shop.addWheel(2);
    shop.gear(0, 1, ratio);
    const double acceleration = 3 / (1 + 2 / (ratio * ratio));
    for (int i = 1; i <= 300; ++i) {
      shop.wheels[0]->applyTorque(vec(0, 0, 3));
      shop.step();
      ASSERT_NEAR(shop.speed(0) / (acceleration * dt * i), 1, of_speeds) << i;
      ASSERT_NEAR(shop.angle(0) + ratio * shop.angle(1), 0, rounding(ratio)) << i;
    }
  }
}

// 10^4 revolutions, from a count of 10^6.
TEST(GearJoint, DoesNotDriftOverManyRevolutions) {
  const double ratio = double(scalar(pi));
  Shop shop;
  shop.addWheel(1).setAccumulatedHingeAngle(scalar(2e6 * pi));
  shop.addWheel(2);
  GearJoint& gear = shop.gear(0, 1, ratio);
  EXPECT_NEAR(double(gear.getCoordinateA()) / (2e6 * pi), 1, 1e-7);
  shop.spin(0, 45);
  shop.spin(1, -45 / ratio);
  const double energy = shop.kinetic();
  double worst = 0;
  while (std::abs(shop.angle(0)) < 2e4 * pi) {
    shop.step();
    worst = std::max(worst, std::abs(shop.angle(0) + ratio * shop.angle(1)));
  }
  EXPECT_LT(worst, rounding(ratio));
  EXPECT_NEAR(shop.kinetic() / energy, 1, is_double ? 1e-11 : 1e-3);
  EXPECT_NEAR(double(gear.getCoordinateA()) / (2.02e6 * pi), 1, 1e-6);
}

// The coordinates of a hinge and of a body alone: 10^5 revolutions of poses that obey the gear, from a count of 10^6.
TEST(GearJoint, RoundsNoMoreAfterMoreRevolutions) {
  for (const bool has_hinges : {false, true}) {
    SCOPED_TRACE(has_hinges);
    Shop shop;
    shop.addWheel(1).setAccumulatedHingeAngle(scalar(2e6 * pi));
    shop.addWheel(1);
    const double ratio = scalar(0.3);
    GearJoint& gear = has_hinges ? shop.gear(0, 1, ratio)
                                 : shop.world.add_joint<GearJoint>(*shop.wheels[0], *shop.wheels[1],
                                                                   z_axis, z_axis, scalar(ratio));
    const auto turn = [&](int i, double angle) {
      btTransform pose = shop.wheels[size_t(i)]->getCenterOfMassTransform();
      pose.setRotation(btQuaternion(z_axis, scalar(std::remainder(angle, 2 * pi))));
      shop.wheels[size_t(i)]->setWorldTransform(pose);
    };
    // Body b, which turns faster, by 0.7 rad a step.
    const int steps = int(2e5 * pi / 0.7);
    for (int i = 1; i <= steps; ++i) {
      turn(0, -0.7 * ratio * i);
      turn(1, 0.7 * i);
      support::SolverRows().count(gear);
    }
    EXPECT_NEAR(double(gear.getCoordinateB()) / (0.7 * steps), 1, 1e-6);
    EXPECT_LT(std::abs(double(gear.getError())), is_double ? 1e-9 : 2e-6);
  }
}

// The last wheel of a chain of four gears, and what iterations leave of each.
TEST(GearJoint, HoldsThroughAChainOfFour) {
  const double ratios[] = {2.5, double(scalar(-0.4)), double(scalar(-pi)), double(scalar(1 / pi))};
  Shop shop;
  for (int i = 0; i < 5; ++i) shop.addWheel(1 + i);
  for (int i = 0; i < 4; ++i) shop.gear(i, i + 1, ratios[i]);
  double speed = 40;
  for (int i = 0; i < 5; ++i) {
    shop.spin(i, speed);
    if (i < 4) speed /= -ratios[i];
  }
  double worst = 0;
  while (std::abs(shop.angle(0)) < 2e4 * pi) {
    shop.step();
    for (int i = 0; i < 4; ++i)
      worst = std::max(
          worst, std::abs(shop.angle(i) + ratios[i] * shop.angle(i + 1)) / rounding(ratios[i]));
  }
  EXPECT_LT(worst, 1);
}

template <class Gear>
double driftOfLoadedChain() {
  Shop shop(0, 4);
  for (int i = 0; i < 5; ++i) {
    shop.addWheel(1);
    if (i > 0)
      shop.world.add_joint<Gear>(*shop.wheels[size_t(i - 1)], *shop.wheels[size_t(i)], z_axis,
                                 z_axis, 1);
  }
  for (int i = 0; i < 1200; ++i) {
    shop.wheels[0]->applyTorque(vec(0, 0, 5));
    shop.wheels[4]->applyTorque(vec(0, 0, -4));
    shop.step();
  }
  return std::abs(shop.angle(0) - shop.angle(4));
}

// The rest of a load that four iterations leave adds up in stock's. Here ERP takes it back.
TEST(GearJoint, KeepsBoundedWhatIterationsLeave) {
  PINTLE_SKIP_ON_EXACT_SOLVER(
      "a gear of Bullet's is compared, of which iterations leave something");
  const double stock = driftOfLoadedChain<btGearConstraint>(),
               ours = driftOfLoadedChain<GearJoint>();
  EXPECT_GT(stock, 0.5);
  EXPECT_LT(ours, 0.005);
}

// --- racks, screws and mimic joints --------------------------------------------------------------

// A body on a rail of the shop's frame, along x.
struct Rail {
  btRigidBody& body;
  SliderJoint& slider;

  explicit Rail(Shop& shop, double y, double mass = 2, double along = 1)
      : body(shop.world.add_box(mass, vec(0.5, 0.1, 0.1), scenes::pose_at(vec(0, y, 0.5)))),
        slider(shop.world.join<SliderJoint>(
            shop.frame, body,
            btTransform(btQuaternion(z_axis, scalar(along > 0 ? 0 : pi)), vec(0, y, 0.5)), true)) {
    free();
  }
  void free() {
    slider.setLowerLinLimit(1);
    slider.setUpperLinLimit(-1);
  }
  double position() const { return double(body.getCenterOfMassPosition().x()); }
  double speed() const { return double(body.getLinearVelocity().x()); }
};

TEST(GearJoint, IsARackOfAHingeAndASlider) {
  const double radius = 0.25;
  for (const bool is_rack_first : {false, true}) {
    SCOPED_TRACE(is_rack_first);
    Shop shop;
    QuaternionHinge& hinge = shop.addWheel(0.5);
    Rail rail(shop, -radius, 3);
    if (is_rack_first)
      shop.world.add_joint<GearJoint>(rail.slider, hinge, scalar(-radius));
    else
      shop.world.add_joint<GearJoint>(hinge, rail.slider, scalar(-1 / radius));
    const double acceleration = 6 / (3 + 0.5 / (radius * radius));
    for (int i = 1; i <= 240; ++i) {
      rail.body.applyCentralForce(vec(6, 0, 0));
      shop.step();
      ASSERT_NEAR(rail.speed() / (acceleration * dt * i), 1, of_speeds) << i;
      ASSERT_NEAR(rail.position() - radius * shop.angle(0), 0, is_double ? 1e-9 : 1e-5) << i;
    }
    // The wheel's bearing bears nothing of it.
    EXPECT_LT(double(shop.wheels[0]->getLinearVelocity().length()), is_double ? 1e-9 : 1e-4);
  }
}

TEST(GearJoint, IsAScrewOfOneSlider) {
  const double pitch = 0.05, per_turn = 2 * pi / pitch;
  Shop shop;
  Rail rail(shop, 0, 2);
  rail.slider.setLowerAngLimit(1);
  rail.slider.setUpperAngLimit(-1);
  GearJoint& screw = shop.world.add_joint<GearJoint>(GearCoordinate::angleOf(rail.slider),
                                                     rail.slider, scalar(-per_turn));
  EXPECT_EQ(&screw.getRigidBodyA(), &rail.body);
  EXPECT_EQ(&screw.getRigidBodyB(), &shop.frame);
  const double inertia = double(rail.body.getLocalInertia().x());
  const double acceleration = 0.3 / (inertia + 2 / (per_turn * per_turn));
  Turns turns(rail.body, vec(1, 0, 0));
  for (int i = 1; i <= 60; ++i) {
    rail.body.applyTorque(vec(0.3, 0, 0));
    shop.step();
    turns();
    const double speed = double(rail.body.getAngularVelocity().x());
    ASSERT_NEAR(speed / (acceleration * dt * i), 1, of_speeds) << i;
    ASSERT_NEAR(turns() - per_turn * rail.position(), 0, is_double ? 1e-9 : 2e-4) << i;
  }
}

// Two fingers of a gripper on opposite rails.
TEST(GearJoint, MovesTwoSlidersAlike) {
  Shop shop;
  Rail left(shop, 1, 1), right(shop, -1, 2, -1);
  shop.world.add_joint<GearJoint>(left.slider, right.slider, -1);
  for (int i = 1; i <= 120; ++i) {
    left.body.applyCentralForce(vec(1.5, 0, 0));
    shop.step();
    ASSERT_NEAR(left.speed(), 0.5 * dt * i, is_double ? 1e-9 : 1e-5);
    ASSERT_NEAR(left.position(), -right.position(), is_double ? 1e-9 : 1e-5);
  }
}

// A gear of an arm and a finger on it acts on both, and on nothing that it leaves out.
TEST(GearJoint, MimicsAJointOfTheSameArm) {
  Shop shop;
  QuaternionHinge& root = shop.addWheel(2);
  btRigidBody &arm = *shop.wheels[0],
              &finger = shop.world.add_box(1, vec(0.2, 0.1, 0.1), scenes::pose_at(vec(1, 0, 0.5)));
  finger.setMassProps(1, vec(0.1, 0.1, 0.1));
  finger.updateInertiaTensor();
  const auto& tip =
      shop.world.join<QuaternionHinge>(arm, finger, scenes::pose_at(vec(1, 0, 0.5)), true);
  GearJoint& mimic = shop.world.add_joint<GearJoint>(const_cast<QuaternionHinge&>(tip), root, -2);
  EXPECT_EQ(&mimic.getRigidBodyA(), &finger);
  EXPECT_EQ(&mimic.getRigidBodyB(), &arm);
  mimic.setOffset(scalar(0.25));
  Turns of_finger(finger, z_axis);
  for (int i = 0; i < 1200; ++i) {
    if (i < 300) arm.applyTorque(vec(0, 0, 1));
    shop.step();
    of_finger();
  }
  const double off = of_finger() - shop.angle(0) - 2 * shop.angle(0) - 0.25;
  EXPECT_NEAR(off, 0, is_double ? 1e-6 : 1e-4);
}

// --- carriers that turn --------------------------------------------------------------------------

// The coordinates are those against the carrier, whoever turns it.
TEST(GearJoint, HoldsTheAnglesAgainstACarrierThatItsOwnerTurns) {
  const double ratio = 2.5;
  Shop shop;
  shop.frame.setCollisionFlags(shop.frame.getCollisionFlags() |
                               btCollisionObject::CF_KINEMATIC_OBJECT);
  shop.addWheel(1);
  shop.addWheel(2);
  shop.gear(0, 1, ratio);
  // rad: what is lost in a step of 2 rad/s of that velocity, which Bullet has from an arc cosine near 1. ERP leaves five times as much.
  const double lost = 2 * double(SIMD_EPSILON) / std::sin(2 * dt / 2);
  double carrier = 0;
  for (int i = 0; i < 2000; ++i) {
    const int since = i % 1000;  // steps, at another speed
    carrier += (i < 1000 ? 3 : -2) * dt;
    btTransform pose = shop.frame.getWorldTransform();
    pose.setRotation(btQuaternion(z_axis, scalar(std::remainder(carrier, 2 * pi))));
    shop.frame.setWorldTransform(pose);
    // Bullet has it that a step goes on from where the owner has put the carrier, at the velocity with which it came there.
    const double off = shop.angle(0) - carrier + ratio * (shop.angle(1) - carrier);
    if (since > 150) {
      ASSERT_NEAR(off, 0, is_double ? 1e-8 : (1 + ratio) * lost / 0.2) << i;
    }
    shop.step();
  }
}

TEST(GearJoint, HoldsTheAnglesAgainstACarrierThatMovesFreely) {
  const double ratio = 2.5;
  Shop shop(10);
  shop.addWheel(1);
  shop.addWheel(2);
  shop.gear(0, 1, ratio);
  Turns frame(shop.frame, z_axis);
  double worst = 0;
  for (int i = 0; i < 2000; ++i) {
    shop.frame.applyTorque(vec(0, 0, i % 500 < 250 ? 20 : -20));
    shop.wheels[0]->applyTorque(vec(0, 0, 2));
    shop.step();
    const double carrier = frame();
    worst = std::max(worst, std::abs(shop.angle(0) - carrier + ratio * (shop.angle(1) - carrier)));
  }
  // In a step the carrier gains speed that no row foresees; ERP leaves five steps of that.
  const double inertia = 1 / double(shop.frame.getInvInertiaTensorWorld()[2].z());
  EXPECT_LT(worst, (1 + ratio) * 20 / inertia * dt * dt / 0.2);
}

// --- changes during a run ------------------------------------------------------------------------

TEST(GearJoint, KeepsTheAnglesWhereItsRatioChanges) {
  Shop shop;
  shop.addWheel(1);
  shop.addWheel(2);
  GearJoint& gear = shop.gear(0, 1, 2);
  shop.spin(0, 10);
  shop.step(300);
  for (const double ratio : {-1.5, 3., 0.5}) {
    SCOPED_TRACE(ratio);
    btGearConstraint& stock = gear;
    stock.setRatio(scalar(ratio));
    const double held = shop.angle(0) + ratio * shop.angle(1);
    for (int i = 0; i < 300; ++i) {
      const double speed = shop.speed(0);
      shop.step();
      EXPECT_NEAR(shop.angle(0) + ratio * shop.angle(1), held, rounding(10));
      // One blow, in the first step, which is the new ratio's.
      if (i > 0) {
        ASSERT_NEAR(shop.speed(0), speed, is_double ? 1e-6 : 1e-3);
      }
    }
  }
}

TEST(GearJoint, DoesNotJumpWhereAnAxisIsLockedLimitedAndFreed) {
  const double ratio = 2.5;
  Shop shop;
  QuaternionHinge& hinge = shop.addWheel(1);
  shop.addWheel(2);
  shop.gear(0, 1, ratio);
  double worst = 0, fastest = 0;
  const auto run = [&](double torque) {
    for (int i = 0; i < 120; ++i) {
      shop.wheels[0]->applyTorque(vec(0, 0, torque));
      shop.step();
      worst = std::max(worst, std::abs(shop.angle(0) + ratio * shop.angle(1)));
      fastest = std::max(fastest, std::abs(shop.speed(0)));
    }
  };
  for (int n = 0; n < 4; ++n) {
    run(3);
    const btScalar angle = hinge.getHingeAngle();  // of the revolution that it's in
    hinge.setLimit(angle, angle);
    run(3);
    hinge.setLimit(angle - scalar(0.5), angle + scalar(0.5));
    run(-3);
    hinge.setLimit(1, -1);
    run(-1);
    shop.spin(0, 10);
    shop.spin(1, -10 / ratio);
  }
  EXPECT_LT(worst, 1e-2);
  // 10 rad/s, and 2 s of 3 N m on 1 + 2 / 2.5^2 kg m^2.
  EXPECT_LT(fastest, 10 + 2 * 3 / (1 + 2 / (ratio * ratio)) + 0.5);
}

// Two bodies may turn against each other by more than half a turn in a step: then it is their velocities that tell.
TEST(GearJoint, CountsAFastTurnOnceHoweverOftenItIsLookedAt) {
  Shop shop;
  const btTransform place = scenes::pose_at(vec(5, 0, 0));
  btRigidBody &a = shop.world.add_box(1, vec(0.1, 0.1, 0.1), place),
              &b = shop.world.add_box(1, vec(0.1, 0.1, 0.1), place);
  auto& hinge = shop.world.add_joint<QuaternionHinge>(a, b, vec(0, 0, 0), vec(0, 0, 0),
                                                      vec(0, 0, 1), vec(0, 0, 1));
  auto& gear = shop.world.add_joint<GearJoint>(hinge, shop.addWheel(1), scalar(1));
  gear.setEnabled(false);
  double last = 0;
  for (int i = 0; i < 20; ++i) {
    a.setAngularVelocity(vec(0, 0, -300));
    b.setAngularVelocity(vec(0, 0, 300));
    shop.step();
    const double now = double(gear.getCoordinateA());
    EXPECT_EQ(double(gear.getCoordinateA()), now) << i;
    EXPECT_GT(std::abs(now - last), pi) << i;
    last = now;
  }
}

// A client puts both wheels where they were at the start, of which they are some revolutions off by then.
TEST(GearJoint, LetsBodiesBePutElsewhere) {
  const double ratio = 2.5;
  for (const bool sets_center : {false, true}) {
    SCOPED_TRACE(sets_center);
    Shop shop;
    shop.addWheel(1);
    shop.addWheel(2);
    GearJoint& gear = shop.gear(0, 1, ratio);
    shop.spin(0, 20);
    shop.step(100);
    const double speed = shop.speed(0);
    for (btRigidBody* wheel : shop.wheels) {
      btTransform pose = wheel->getCenterOfMassTransform();
      pose.setRotation(btQuaternion::getIdentity());
      if (sets_center)
        wheel->setCenterOfMassTransform(pose);
      else
        wheel->setWorldTransform(pose);
    }
    const double held = shop.angle(0) + ratio * shop.angle(1);
    for (int i = 0; i < 300; ++i) {
      shop.step();
      ASSERT_NEAR(shop.speed(0), speed, 1e-4 * speed);
      ASSERT_NEAR(shop.angle(0) + ratio * shop.angle(1), held, rounding(10));
    }
    EXPECT_NEAR(double(gear.getError()), 0, rounding(10));
  }
}

// A rack that is put 1 m further stays there; one that is 0.2 m off goes back, at 0.5 m/s at the most.
TEST(GearJoint, LetsARackBePutElsewhere) {
  const double radius = 0.5;
  for (const double by : {1., 0.2}) {
    SCOPED_TRACE(by);
    Shop shop;
    QuaternionHinge& hinge = shop.addWheel(1);
    Rail rail(shop, -radius, 2);
    GearJoint& rack = shop.world.add_joint<GearJoint>(rail.slider, hinge, scalar(-radius));
    rack.setMaxLinearCorrectionSpeed(scalar(0.5));
    shop.step(10);
    btTransform pose = rail.body.getCenterOfMassTransform();
    pose.getOrigin() += vec(by, 0, 0);
    rail.body.setCenterOfMassTransform(pose);
    double last = by;
    for (int i = 0; i < 200; ++i) {
      shop.step();
      const double off = rail.position() - radius * shop.angle(0);
      ASSERT_GT(off, last - 0.5 * dt - 1e-5) << i;
      last = off;
    }
    EXPECT_NEAR(last, by == 1 ? 1 : 0, 1e-5);
  }
}

// Less than 45 degrees is an error, which closes at the speed of corrections.
TEST(GearJoint, ClosesAnErrorAtABoundedSpeed) {
  Shop shop;
  shop.addWheel(1);
  shop.addWheel(2);
  GearJoint& gear = shop.gear(0, 1, 2);
  gear.setMaxCorrectionSpeed(scalar(0.5));
  btTransform pose = shop.wheels[1]->getCenterOfMassTransform();
  pose.setRotation(btQuaternion(z_axis, scalar(0.4)));
  shop.wheels[1]->setCenterOfMassTransform(pose);
  double last = 0.8;
  for (int i = 0; i < 200; ++i) {
    shop.step();
    const double off = shop.angle(0) + 2 * shop.angle(1);
    ASSERT_GT(off, last - 0.5 * dt - 1e-6) << i;
    ASSERT_LE(off, last + 1e-6) << i;
    last = off;
  }
  EXPECT_LT(last, 1e-3);
}

TEST(GearJoint, ThatIsDisabledIsAClutch) {
  Shop shop;
  shop.addWheel(1);
  shop.addWheel(2);
  GearJoint& gear = shop.gear(0, 1, 2);
  gear.setEnabled(false);
  shop.spin(0, 5);
  shop.step(100);
  EXPECT_NEAR(shop.speed(0), 5, 1e-4);
  EXPECT_NEAR(shop.speed(1), 0, 1e-4);
  gear.setEnabled(true);
  const double held = shop.angle(0) + 2 * shop.angle(1);
  for (int i = 0; i < 100; ++i) {
    shop.step();
    ASSERT_NEAR(shop.angle(0) + 2 * shop.angle(1), held, rounding(10)) << i;
  }
  EXPECT_LT(shop.speed(1), -1);
}

TEST(GearJoint, GoesToAnOffset) {
  Shop shop;
  shop.addWheel(1);
  shop.addWheel(2);
  GearJoint& gear = shop.gear(0, 1, 2);
  EXPECT_NEAR(double(gear.getOffset()), 0, 1e-6);
  gear.setOffset(3);
  EXPECT_NEAR(double(gear.getError()), -3, 1e-6);
  shop.step(240);
  EXPECT_NEAR(shop.angle(0) + 2 * shop.angle(1), 3, is_double ? 1e-8 : 1e-5);
  EXPECT_NEAR(double(gear.getOffset()), 3, 1e-5);
  EXPECT_NE(refusal([&] { gear.setOffset(nan_value); }).find("GearJoint: offset"),
            std::string::npos);
  EXPECT_NEAR(double(gear.getOffset()), 3, 1e-5);
}

}  // namespace
}  // namespace gear_joint_test
