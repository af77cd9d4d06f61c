// Bullet's gears on solvers of Pintle's: they move, to the bit, as Pintle's with the same settings, and hold their angles.
#include <gtest/gtest.h>
#include <pintle/joints/gear_joint.h>

#include <string>
#include <vector>

#include "support.h"
#include "upgraded_worlds.h"

namespace upgraded_gear_test {
namespace {

using namespace upgraded_worlds;

// About the axes of the frames, which are not those of inertia.
template <class Gear>
Made makeGear(btRigidBody& a, btRigidBody& b, const btTransform& in_a, const btTransform& in_b) {
  return std::make_unique<Gear>(a, b, in_a.getBasis().getColumn(2), in_b.getBasis().getColumn(1),
                                scalar(-1.5));
}

const Class gear = {"btGearConstraint", makeGear<btGearConstraint>, makeGear<pintle::GearJoint>,
                    [](btTypedConstraint&) { return std::vector<btScalar>(); }};

// The bodies whirl about, and so do their axes.
void spin(btTypedConstraint& joint, int i) {
  if (i % 30 == 0) joint.getRigidBodyB().setAngularVelocity(vec(3, scalar(0.1 * i), -2));
}

std::vector<Use> uses() {
  return {
      {&gear, "bodies that whirl", spin},
      {&gear, "setters during the run",
       [](btTypedConstraint& joint, int i) {
         spin(joint, i);
         auto& of = static_cast<btGearConstraint&>(joint);
         btVector3 axis = vec(1, 0, 0);
         if (i == 20) of.setRatio(3);
         if (i == 40) of.setAxisA(axis);
         if (i == 60) of.setAxisB(axis);
       }},
      {&gear, "disabled for a while",
       [](btTypedConstraint& joint, int i) {
         spin(joint, i);
         if (i == 40) joint.setEnabled(false);
         if (i == 70) joint.setEnabled(true);
       }},
      {&gear, "breaks",
       [](btTypedConstraint& joint, int i) {
         spin(joint, i);
         joint.setBreakingImpulseThreshold(scalar(0.05));
       }},
  };
}

class UpgradedGears : public testing::TestWithParam<Worlds> {};

TEST_P(UpgradedGears, MoveAsPintlesToTheSameBits) {
  for (const Use& use : uses()) {
    SCOPED_TRACE(use.name);
    const MadeWorld upgraded = GetParam().upgraded(), ours = GetParam().ours();
    Chain stock_chain(upgraded->world(), *use.of, false), our_chain(ours->world(), *use.of, true);
    expectSame(stock_chain.run(use), our_chain.run(use));
  }
}

INSTANTIATE_TEST_SUITE_P(, UpgradedGears, testing::ValuesIn(all_worlds),
                         [](const auto& of) { return std::string(of.param.name); });

// rad: by how much two wheels are off after one of them was turned by 0.1 rad.
double leftOfAnError(btDiscreteDynamicsWorld& world) {
  support::Bodies bodies(world);
  world.setGravity(vec(0, 0, 0));
  btRigidBody &a = bodies.add(1, vec(0.3, 0.3, 0.1), vec(0, 0, 0)),
              &b = bodies.add(1, vec(0.3, 0.3, 0.1), vec(1, 0, 0));
  bodies.join(std::make_unique<btGearConstraint>(a, b, vec(0, 0, 1), vec(0, 0, 1), scalar(2)));
  const auto step = [&] { world.stepSimulation(scalar(dt), 0, scalar(dt)); };
  step();
  b.setWorldTransform(btTransform(btQuaternion(vec(0, 0, 1), scalar(0.1)), vec(1, 0, 0)));
  for (int i = 0; i < 100; ++i) step();
  const auto angle = [](const btRigidBody& body) {
    const btMatrix3x3& R = body.getCenterOfMassTransform().getBasis();
    return std::atan2(double(R[1].x()), double(R[0].x()));
  };
  return std::abs(angle(a) + 2 * angle(b));
}

TEST_P(UpgradedGears, HoldTheirAngles) {
  EXPECT_LT(leftOfAnError(GetParam().upgraded()->world()), 1e-5);
}

TEST(UpgradedGearsOff, HoldTheirRatesAlone) {
  PlainWorld<btSequentialImpulseConstraintSolver> stock;
  EXPECT_NEAR(leftOfAnError(stock.world()), 0.2, 1e-5);
}

}  // namespace
}  // namespace upgraded_gear_test
