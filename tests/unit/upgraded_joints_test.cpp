// Stock joints on solvers of Pintle's: a world that knows Bullet's classes alone moves, to the bit, as one of Pintle's joints with the
// same settings, and reads the same from its objects.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <typeinfo>
#include <vector>

#include "support.h"
#include "upgraded_worlds.h"

namespace upgraded_joints_test {
namespace {

using namespace upgraded_worlds;

template <class Stock, class Act>
std::function<void(btTypedConstraint&, int)> atStart(Act act) {
  return [act](btTypedConstraint& joint, int i) {
    if (i == 0) act(static_cast<Stock&>(joint));
  };
}
template <class Stock, class Act>
std::function<void(btTypedConstraint&, int)> always(Act act) {
  return [act](btTypedConstraint& joint, int i) { act(static_cast<Stock&>(joint), i); };
}

std::vector<Use> usesOfHinges(const Class& of) {
  using H = btHingeConstraint;
  return {
      {&of, "nothing", [](btTypedConstraint&, int) {}},
      {&of, "limit", atStart<H>([](H& h) { h.setLimit(scalar(-0.2), scalar(0.3)); })},
      {&of, "soft limit", atStart<H>([](H& h) {
         h.setLimit(scalar(-0.1), scalar(0.1), scalar(0.9), scalar(0.5), 0);
       })},
      {&of, "locked", atStart<H>([](H& h) { h.setLimit(0, 0); })},
      {&of, "half a turn either way is free",
       atStart<H>([](H& h) { h.setLimit(-SIMD_PI, SIMD_PI); })},
      {&of, "motor", atStart<H>([](H& h) { h.enableAngularMotor(true, 2, scalar(0.5)); })},
      {&of, "motor towards a limit", atStart<H>([](H& h) {
         h.setLimit(scalar(-0.2), scalar(0.3));
         h.enableAngularMotor(true, -1, 10);
       })},
      {&of, "ERP and CFM", atStart<H>([](H& h) {
         h.setLimit(scalar(-0.1), scalar(0.1));
         h.setParam(BT_CONSTRAINT_ERP, scalar(0.4));
         h.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.3));
         h.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.01));
       })},
      {&of, "angular only", atStart<H>([](H& h) { h.setAngularOnly(true); })},
      {&of, "plain rows", atStart<H>([](H& h) { h.setUseFrameOffset(false); })},
      {&of, "setters during the run", always<H>([](H& h, int i) {
         if (i == 20) h.setLimit(scalar(-0.1), scalar(0.2));
         if (i == 40) h.enableAngularMotor(true, 3, 1);
         if (i == 60) h.setMotorTarget(scalar(0.1), scalar(0.1));
         if (i == 80) h.enableMotor(false);
         if (i == 90) h.setLimit(1, -1);
         if (i == 100)
           h.setFrames(h.getAFrame(),
                       btTransform(btQuaternion(vec(0, 0, 1), 1), h.getBFrame().getOrigin()));
       })},
  };
}

std::vector<Use> usesOfBalls() {
  using B = btPoint2PointConstraint;
  return {
      {&ball, "nothing", [](btTypedConstraint&, int) {}},
      {&ball, "damping", atStart<B>([](B& b) { b.m_setting.m_damping = scalar(0.7); })},
      {&ball, "clamp", atStart<B>([](B& b) { b.m_setting.m_impulseClamp = scalar(0.3); })},
      {&ball, "ERP and CFM", atStart<B>([](B& b) {
         b.setParam(BT_CONSTRAINT_ERP, scalar(0.5));
         b.setParam(BT_CONSTRAINT_CFM, scalar(0.05));
       })},
      {&ball, "dragged", always<B>([](B& b, int i) {
         if (i >= 30) b.setPivotB(b.getPivotInB() + vec(0.001, 0, 0));
       })},
  };
}

std::vector<Use> usesOfSliders() {
  using S = btSliderConstraint;
  return {
      {&slider, "nothing", [](btTypedConstraint&, int) {}},
      {&slider, "limits", atStart<S>([](S& s) {
         s.setLowerLinLimit(scalar(-0.1));
         s.setUpperLinLimit(scalar(0.05));
         s.setLowerAngLimit(scalar(-0.2));
         s.setUpperAngLimit(scalar(0.1));
       })},
      {&slider, "soft limits", atStart<S>([](S& s) {
         s.setLowerLinLimit(scalar(-0.1));
         s.setUpperLinLimit(scalar(0.05));
         s.setSoftnessLimLin(scalar(0.5));
         s.setDampingLimLin(scalar(0.6));
         s.setSoftnessOrthoLin(scalar(0.8));
         s.setRestitutionLimLin(scalar(0.5));
       })},
      {&slider, "motors", atStart<S>([](S& s) {
         s.setLowerLinLimit(1);
         s.setUpperLinLimit(-1);
         s.setLowerAngLimit(1);
         s.setUpperAngLimit(-1);
         s.setPoweredLinMotor(true);
         s.setTargetLinMotorVelocity(1);
         s.setMaxLinMotorForce(40);
         s.setPoweredAngMotor(true);
         s.setTargetAngMotorVelocity(2);
         s.setMaxAngMotorForce(10);
       })},
      {&slider, "ERP and CFM", atStart<S>([](S& s) {
         s.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.4), 1);
         s.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.01), 1);
         s.setParam(BT_CONSTRAINT_CFM, scalar(0.01), 0);
       })},
      {&slider, "setters during the run", always<S>([](S& s, int i) {
         if (i == 20) s.setLowerLinLimit(scalar(-0.2));
         if (i == 40) s.setUpperAngLimit(scalar(0.3));
         if (i == 60) s.setPoweredLinMotor(true);
         if (i == 60) s.setTargetLinMotorVelocity(-1);
         if (i == 60) s.setMaxLinMotorForce(20);
         if (i == 80) s.setUseFrameOffset(false);
       })},
  };
}

std::vector<Use> usesOfCones() {
  using C = btConeTwistConstraint;
  return {
      {&cone, "nothing", [](btTypedConstraint&, int) {}},
      {&cone, "limits",
       atStart<C>([](C& c) { c.setLimit(scalar(0.2), scalar(0.3), scalar(0.1)); })},
      {&cone, "soft limits", atStart<C>([](C& c) {
         c.setLimit(scalar(0.2), scalar(0.3), scalar(0.1), scalar(0.9), scalar(0.5), scalar(0.8));
       })},
      {&cone, "swing locked",
       atStart<C>([](C& c) { c.setLimit(scalar(0.01), scalar(0.01), scalar(0.4)); })},
      {&cone, "motor", atStart<C>([](C& c) {
         c.setLimit(1, 1, 1);
         c.setMaxMotorImpulse(scalar(0.5));
         c.setMotorTarget(btQuaternion(vec(0, 1, 0), scalar(0.4)));
         c.enableMotor(true);
       })},
      {&cone, "ERP and CFM", atStart<C>([](C& c) {
         c.setLimit(scalar(0.2), scalar(0.3), scalar(0.1));
         c.setParam(BT_CONSTRAINT_ERP, scalar(0.3), 0);
         c.setParam(BT_CONSTRAINT_CFM, scalar(0.01), 0);
         c.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.01), 3);
       })},
      {&cone, "setters during the run", always<C>([](C& c, int i) {
         if (i == 20) c.setLimit(scalar(0.3), scalar(0.2), scalar(0.2));
         if (i == 40) c.setMotorTarget(btQuaternion(vec(0, 0, 1), scalar(0.1)));
         if (i == 40) c.setMaxMotorImpulse(1);
         if (i == 40) c.enableMotor(true);
         if (i == 80) c.enableMotor(false);
         if (i == 90) c.setAngularOnly(true);
       })},
  };
}

/// Uses that any constraint has.
std::vector<Use> usesOf(const Class& of) {
  return {
      {&of, "breaks",
       [](btTypedConstraint& c, int i) {
         if (i == 0) c.setBreakingImpulseThreshold(scalar(1.2));
       }},
      {&of, "is disabled and enabled",
       [](btTypedConstraint& c, int i) {
         if (i == 30) c.setEnabled(false);
         if (i == 50) c.setEnabled(true);
       }},
      {&of, "has other iterations",
       [](btTypedConstraint& c, int i) {
         if (i == 0) c.setOverrideNumSolverIterations(25);
         if (i == 60) c.setOverrideNumSolverIterations(4);
       }},
  };
}

std::vector<Use> allUses() {
  std::vector<Use> all;
  const auto add = [&](const std::vector<Use>& of) { all.insert(all.end(), of.begin(), of.end()); };
  for (const Class* of : {&hinge, &accumulated}) add(usesOfHinges(*of));
  add(usesOfBalls());
  add(usesOfSliders());
  add(usesOfCones());
  for (const Class* of : {&hinge, &ball, &slider, &cone}) add(usesOf(*of));
  return all;
}

class UpgradedJoints : public testing::TestWithParam<Worlds> {};

TEST_P(UpgradedJoints, MoveAsPintlesToTheSameBits) {
  for (const Use& use : allUses()) {
    SCOPED_TRACE(testing::Message() << use.of->name << ": " << use.name);
    // Bullet's getter of this class loses count where joints whirl, as they do before they end in NaN.
    if (use.of == &accumulated && GetParam().name == std::string("NNCG")) continue;
    const MadeWorld upgraded = GetParam().upgraded(), ours = GetParam().ours();
    Chain stock_chain(upgraded->world(), *use.of, false), our_chain(ours->world(), *use.of, true);
    const std::vector<btScalar> stock = stock_chain.run(use);
    expectSame(stock, our_chain.run(use));
  }
}

INSTANTIATE_TEST_SUITE_P(, UpgradedJoints, testing::ValuesIn(all_worlds),
                         [](const auto& of) { return std::string(of.param.name); });

// --- what stays as it is -------------------------------------------------------------------------

/// A client's hinge: it counts, and asks for the rows of Bullet's.
class Counting : public btHingeConstraint {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();
  using btHingeConstraint::btHingeConstraint;
  void getInfo2(btConstraintInfo2* info) override {
    ++count;
    btHingeConstraint::getInfo2(info);
  }
  int count = 0;
};

const Class client = {"a client's hinge", make<Counting>, make<Counting>, readHinge};

TEST(UpgradedJointsOff, AreBulletsToTheSameBits) {
  std::vector<Use> uses = allUses();
  uses.push_back({&client, "nothing", [](btTypedConstraint&, int) {}});
  for (const Use& use : uses) {
    SCOPED_TRACE(testing::Message() << use.of->name << ": " << use.name);
    PlainWorld<pintle::SequentialJointSolver> off;
    PlainWorld<btSequentialImpulseConstraintSolver> stock;
    const bool is_clients = use.of == &client;
    off.its().setUpgradesBulletJoints(is_clients);
    EXPECT_EQ(off.its().getUpgradesBulletJoints(), is_clients);
    Chain a(off.world(), *use.of, false), b(stock.world(), *use.of, false);
    const std::vector<btScalar> numbers = a.run(use);
    expectSame(numbers, b.run(use));
    if (!is_clients) continue;
    EXPECT_EQ(static_cast<Counting&>(*a.joints[0]).count, steps);
    EXPECT_EQ(off.its().whyIgnored(*a.joints[0]), "");
  }
}

TEST(UpgradedJointsOff, TakesHoldFromTheNextStepOn) {
  PlainWorld<pintle::ExactJointSolver> of;
  Chain chain(of.world(), ball, false);
  chain.step();
  of.its().setUpgradesBulletJoints(false);
  chain.step();
  of.its().setUpgradesBulletJoints(true);
  chain.step();
  EXPECT_EQ(of.its().lastStep().tier, 1);
}

// A step of Bullet's leaves in the object what it has seen of the bodies at the step's start. So does one of an upgraded joint.
TEST(UpgradedReadings, AreThoseOfAStepOfBullets) {
  for (const Class* of : {&hinge, &slider, &cone}) {
    SCOPED_TRACE(of->name);
    PlainWorld<pintle::SequentialJointSolver> upgraded;
    PlainWorld<btSequentialImpulseConstraintSolver> stock;
    Chain a(upgraded.world(), *of, false), b(stock.world(), *of, false);
    for (Chain* chain : {&a, &b}) {
      for (const auto& joint : chain->joints) {
        if (of == &slider) {
          auto& its = static_cast<btSliderConstraint&>(*joint);
          its.setLowerLinLimit(scalar(-0.01));
          its.setUpperLinLimit(scalar(0.01));
          its.setLowerAngLimit(scalar(-0.01));
          its.setUpperAngLimit(scalar(0.01));
        } else if (of == &cone) {
          static_cast<btConeTwistConstraint&>(*joint).setLimit(scalar(0.1), scalar(0.1),
                                                               scalar(0.02));
        } else {
          static_cast<btHingeConstraint&>(*joint).setLimit(scalar(-0.01), scalar(0.01));
        }
      }
      const btQuaternion turn(vec(0.36, 0.48, 0.8), scalar(0.03));
      for (size_t i = 1; i < chain->bodies.size(); i += 2)
        chain->bodies[i]->setCenterOfMassTransform(
            btTransform(turn, chain->bodies[i]->getCenterOfMassPosition() + vec(0.01, 0.03, 0)));
      chain->step();
    }
    for (size_t i = 0; i < a.joints.size(); ++i) {
      const auto seen = of->readings(*a.joints[i]), expected = of->readings(*b.joints[i]);
      // (Bullet's hinge tells its angle as of now.)
      for (size_t k = of == &hinge ? 1 : 0; k < seen.size(); ++k)
        EXPECT_NEAR(double(seen[k]), double(expected[k]), support::is_double ? 1e-9 : 3e-5)
            << i << ", " << k;
    }
  }
}

TEST(UpgradedObjects, StayBulletsInTheirWorld) {
  PlainWorld<pintle::SequentialJointSolver> of;
  Chain chain(of.world(), hinge, false);
  const btTypedConstraint* const joint = chain.joints[0].get();
  chain.step();
  EXPECT_EQ(of.world().getConstraint(0), joint);
  EXPECT_EQ(joint->getConstraintType(), HINGE_CONSTRAINT_TYPE);
  EXPECT_EQ(typeid(*joint), typeid(btHingeConstraint));
}
}  // namespace
}  // namespace upgraded_joints_test
