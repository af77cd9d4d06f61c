// Stock joints of six degrees of freedom on solvers of Pintle's: fixed and universal ones move, to the bit, as Pintle's joints with the same
// settings. The others keep Bullet's rows.
#include <gtest/gtest.h>
#include <pintle/joints/generic_6dof_joint.h>
#include <pintle/joints/generic_6dof_spring_2_joint.h>
#include <pintle/joints/generic_6dof_spring_joint.h>
#include <pintle/joints/hinge_2_joint.h>

#include <memory>
#include <vector>

#include "support.h"
#include "upgraded_worlds.h"

namespace contract_test {
extern thread_local long allocations;  // by operator new
}

namespace upgraded_six_dof_test {
namespace {

using namespace upgraded_worlds;
using First = btGeneric6DofConstraint;
using Springs = btGeneric6DofSpringConstraint;
using Second = btGeneric6DofSpring2Constraint;

// Answers of a client's getters after a step.
template <class Joint>
std::vector<btScalar> readingsOf(btTypedConstraint& constraint) {
  auto& joint = static_cast<Joint&>(constraint);
  std::vector<btScalar> all;
  for (int i = 0; i < 3; ++i) {
    all.push_back(joint.getAngle(i));
    all.push_back(joint.getRelativePivotPosition(i));
    for (int k = 0; k < 3; ++k) all.push_back(joint.getAxis(i)[k]);
    all.push_back(joint.getRotationalLimitMotor(i)->m_currentPosition);
    all.push_back(joint.getTranslationalLimitMotor()->m_currentLinearDiff[i]);
  }
  return all;
}

// As Chain makes them: free about all axes, within small boxes.
template <class Joint>
Made make(btRigidBody& a, btRigidBody& b, const btTransform& in_a, const btTransform& in_b) {
  std::unique_ptr<Joint> joint;
  if constexpr (std::is_base_of_v<First, Joint>)
    joint = std::make_unique<Joint>(a, b, in_a, in_b, true);
  else
    joint = std::make_unique<Joint>(a, b, in_a, in_b);
  joint->setAngularLowerLimit(vec(-0.3, -0.2, -0.1));
  joint->setAngularUpperLimit(vec(0.2, 0.3, 0.2));
  return joint;
}

Made makeFixed(btRigidBody& a, btRigidBody& b, const btTransform& in_a, const btTransform& in_b) {
  return std::make_unique<btFixedConstraint>(a, b, in_a, in_b);
}
Made likeFixed(btRigidBody& a, btRigidBody& b, const btTransform& in_a, const btTransform& in_b) {
  auto joint = std::make_unique<pintle::Generic6DofSpring2Joint>(a, b, in_a, in_b);
  joint->setAngularLowerLimit(vec(0, 0, 0));
  joint->setAngularUpperLimit(vec(0, 0, 0));
  return joint;
}

std::unique_ptr<btUniversalConstraint> universal(btRigidBody& a, btRigidBody& b,
                                                 const btTransform& in_a) {
  const btTransform frame = a.getCenterOfMassTransform() * in_a;
  const btVector3 z = frame.getBasis().getColumn(2), y = frame.getBasis().getColumn(1);
  auto joint = std::make_unique<btUniversalConstraint>(a, b, frame.getOrigin(), z, y);
  joint->setLowerLimit(scalar(-0.2), scalar(-0.3));
  joint->setUpperLimit(scalar(0.3), scalar(0.2));
  return joint;
}
Made makeUniversal(btRigidBody& a, btRigidBody& b, const btTransform& in_a, const btTransform&) {
  return universal(a, b, in_a);
}
Made likeUniversal(btRigidBody& a, btRigidBody& b, const btTransform& in_a, const btTransform&) {
  const auto of = universal(a, b, in_a);
  auto joint = std::make_unique<pintle::Generic6DofJoint>(a, b, of->getFrameOffsetA(),
                                                          of->getFrameOffsetB(), true);
  btVector3 low, high;
  of->getAngularLowerLimit(low);
  of->getAngularUpperLimit(high);
  joint->setAngularLowerLimit(low);
  joint->setAngularUpperLimit(high);
  of->getLinearLowerLimit(low);
  of->getLinearUpperLimit(high);
  joint->setLinearLowerLimit(low);
  joint->setLinearUpperLimit(high);
  return joint;
}

template <class Joint>
Made makeWheel(btRigidBody& a, btRigidBody& b, const btTransform& in_a, const btTransform&) {
  const btTransform frame = a.getCenterOfMassTransform() * in_a;
  btVector3 anchor = frame.getOrigin(), z = frame.getBasis().getColumn(2),
            x = frame.getBasis().getColumn(0);
  return std::make_unique<Joint>(a, b, anchor, z, x);
}

const Class six_dof = {"btGeneric6DofConstraint", make<First>, make<pintle::Generic6DofJoint>,
                       readingsOf<First>};
const Class springs = {"btGeneric6DofSpringConstraint", make<Springs>,
                       make<pintle::Generic6DofSpringJoint>, readingsOf<First>};
const Class spring_2 = {"btGeneric6DofSpring2Constraint", make<Second>,
                        make<pintle::Generic6DofSpring2Joint>, readingsOf<Second>};
const Class fixed = {"btFixedConstraint", makeFixed, likeFixed, readingsOf<Second>};
const Class universals = {"btUniversalConstraint", makeUniversal, likeUniversal, readingsOf<First>};
const Class wheel = {"btHinge2Constraint", makeWheel<btHinge2Constraint>,
                     makeWheel<pintle::Hinge2Joint>, readingsOf<Second>};

/// Before the first step.
template <class Stock, class Act>
Use use(const Class& of, const char* name, Act act) {
  return {&of, name, [act](btTypedConstraint& joint, int i) {
            if (i == 0) act(static_cast<Stock&>(joint));
          }};
}

template <class Stock>
std::vector<Use> usesOfAll(const Class& of) {
  return {
      use<Stock>(of, "nothing", [](Stock&) {}),
      use<Stock>(of, "a hinge",
                 [](Stock& joint) {
                   joint.setLimit(3, 1, -1);
                   joint.setLimit(4, 0, 0);
                   joint.setLimit(5, 0, 0);
                 }),
      use<Stock>(of, "a slide with a motor",
                 [](Stock& joint) {
                   joint.setLimit(0, scalar(-0.1), scalar(0.2));
                   auto* const motor = joint.getTranslationalLimitMotor();
                   motor->m_enableMotor[0] = true;
                   motor->m_targetVelocity[0] = scalar(0.5);
                   motor->m_maxMotorForce[0] = 30;
                 }),
      use<Stock>(of, "a motor and parameters",
                 [](Stock& joint) {
                   auto* const motor = joint.getRotationalLimitMotor(0);
                   motor->m_enableMotor = true;
                   motor->m_targetVelocity = 1;
                   motor->m_maxMotorForce = 5;
                   motor->m_bounce = scalar(0.5);
                   joint.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.4), 3);
                   joint.setParam(BT_CONSTRAINT_CFM, scalar(0.01), 3);
                 }),
      {&of, "setters during the run",
       [](btTypedConstraint& constraint, int i) {
         auto& joint = static_cast<Stock&>(constraint);
         if (i == 20) joint.setLimit(4, 0, 0);
         if (i == 40) joint.setLimit(2, scalar(-0.05), scalar(0.05));
         if (i == 60) joint.getRotationalLimitMotor(1)->m_hiLimit = scalar(0.6);
         if (i == 80) joint.setLimit(3, 1, -1);
         if (i == 100) joint.setEnabled(false);
         if (i == 110) joint.setEnabled(true);
       }},
      {&of, "breaks",
       [](btTypedConstraint& joint, int i) {
         if (i == 0) joint.setBreakingImpulseThreshold(scalar(1.2));
       }},
  };
}

std::vector<Use> allUses() {
  std::vector<Use> all;
  const auto add = [&](const std::vector<Use>& of) { all.insert(all.end(), of.begin(), of.end()); };
  add(usesOfAll<First>(six_dof));
  add(usesOfAll<First>(springs));
  add(usesOfAll<Second>(spring_2));
  all.push_back(use<Springs>(springs, "springs", [](Springs& joint) {
    joint.setLimit(0, scalar(-0.1), scalar(0.2));
    for (const int axis : {0, 3, 5}) {
      joint.enableSpring(axis, true);
      joint.setStiffness(axis, 50);
      joint.setDamping(axis, scalar(0.6));
    }
    joint.setEquilibriumPoint(3, scalar(0.1));
  }));
  all.push_back(use<Second>(spring_2, "springs and a servo", [](Second& joint) {
    joint.setLimit(0, 1, -1);
    for (const int axis : {0, 4}) {
      joint.enableSpring(axis, true);
      joint.setStiffness(axis, 100);
      joint.setDamping(axis, 1);
      joint.setEquilibriumPoint(axis, scalar(0.1));
    }
    joint.enableMotor(3, true);
    joint.setServo(3, true);
    joint.setServoTarget(3, scalar(0.15));
    joint.setTargetVelocity(3, 2);
    joint.setMaxMotorForce(3, 20);
  }));
  for (const Class* of : {&fixed, &universals, &wheel})
    all.push_back({of, "nothing", [](btTypedConstraint&, int) {}});
  all.push_back(use<Second>(wheel, "driven and steered", [](Second& joint) {
    joint.enableMotor(3, true);
    joint.setTargetVelocity(3, 5);
    joint.setMaxMotorForce(3, 2);
    joint.setLimit(5, scalar(0.2), scalar(0.2));
  }));
  return all;
}

class UpgradedSixDof : public testing::TestWithParam<Worlds> {};

bool isOnIterationsToo(const Class* of) { return of == &fixed || of == &universals; }
bool isExact(const Worlds& of) { return std::string(of.name).find("exact") == 0; }

TEST_P(UpgradedSixDof, MovesAsPintlesToTheSameBits) {
  std::vector<Use> uses;
  if (isExact(GetParam())) uses = allUses();
  for (const Class* of : {&fixed, &universals}) {
    uses.push_back({of, "nothing", [](btTypedConstraint&, int) {}});
    uses.push_back({of, "breaks", [](btTypedConstraint& joint, int i) {
                      if (i == 0) joint.setBreakingImpulseThreshold(scalar(1.2));
                    }});
    uses.push_back({of, "is disabled and enabled", [](btTypedConstraint& joint, int i) {
                      if (i == 30) joint.setEnabled(false);
                      if (i == 50) joint.setEnabled(true);
                    }});
  }
  uses.push_back(use<First>(universals, "a motor", [](First& joint) {
    joint.getRotationalLimitMotor(2)->m_enableMotor = true;
    joint.getRotationalLimitMotor(2)->m_targetVelocity = 1;
    joint.getRotationalLimitMotor(2)->m_maxMotorForce = 5;
  }));
  for (const Use& one : uses) {
    SCOPED_TRACE(testing::Message() << one.of->name << ": " << one.name);
    const MadeWorld upgraded = GetParam().upgraded(), ours = GetParam().ours();
    Chain stock_chain(upgraded->world(), *one.of, false), our_chain(ours->world(), *one.of, true);
    const std::vector<btScalar> stock = stock_chain.run(one);
    expectSame(stock, our_chain.run(one));
  }
}

TEST_P(UpgradedSixDof, AllocatesNothingOnceASolverHasSeenIt) {
  for (const Class* of : {&fixed, &universals, &six_dof, &springs, &spring_2, &wheel}) {
    if (!isOnIterationsToo(of) && !isExact(GetParam())) continue;
    SCOPED_TRACE(of->name);
    const MadeWorld world = GetParam().upgraded();
    Chain chain(world->world(), *of, false);
    for (int i = 0; i < steps; ++i) chain.step();
    const long before = contract_test::allocations;
    for (int i = 0; i < 60; ++i) chain.step();
    EXPECT_EQ(contract_test::allocations - before, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(, UpgradedSixDof, testing::ValuesIn(all_worlds),
                         [](const auto& of) { return std::string(of.param.name); });

// Turned off, or of a class that iterations leave as it is.
TEST(UpgradedSixDofOff, IsBulletsToTheSameBits) {
  for (const Use& one : allUses()) {
    for (const bool on : {false, true}) {
      if (on && isOnIterationsToo(one.of)) continue;
      SCOPED_TRACE(testing::Message() << one.of->name << ": " << one.name);
      PlainWorld<pintle::SequentialJointSolver> of;
      PlainWorld<btSequentialImpulseConstraintSolver> stock;
      of.its().setUpgradesBulletJoints(on);
      Chain a(of.world(), *one.of, false), b(stock.world(), *one.of, false);
      const std::vector<btScalar> numbers = a.run(one);
      expectSame(numbers, b.run(one));
    }
  }
}

}  // namespace
}  // namespace upgraded_six_dof_test
