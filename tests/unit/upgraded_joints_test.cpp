// Stock joints on solvers of Pintle's: a world that knows Bullet's classes alone moves, to the bit, as one of Pintle's joints with the
// same settings, and reads the same from its objects.
#include <BulletDynamics/ConstraintSolver/btNNCGConstraintSolver.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorldMt.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/solver/exact_joint_solver.h>
#include <pintle/solver/exact_joint_solver_pool.h>
#include <pintle/solver/exact_multi_body_joint_solver.h>
#include <pintle/solver/sequential_multi_body_joint_solver.h>

#include <functional>
#include <memory>
#include <new>
#include <ostream>
#include <string>
#include <vector>

#include "bodies.h"
#include "support.h"

namespace upgraded_joints_test {
namespace {

using support::scalar;
using support::vec;

constexpr double dt = 1. / 60;
constexpr int steps = 120;

// --- joints --------------------------------------------------------------------------------------

using Made = std::unique_ptr<btTypedConstraint>;

/// A class of Bullet's, and Pintle's that replaces it.
struct Class {
  const char* name;
  std::function<Made(btRigidBody&, btRigidBody&, const btTransform&, const btTransform&)> stock,
      ours;
  /// What its getters tell.
  std::function<std::vector<btScalar>(btTypedConstraint&)> readings;
};

template <class Joint>
Made make(btRigidBody& a, btRigidBody& b, const btTransform& in_a, const btTransform& in_b) {
  if constexpr (std::is_base_of_v<btSliderConstraint, Joint>)
    return std::make_unique<Joint>(a, b, in_a, in_b, true);
  else if constexpr (std::is_base_of_v<btPoint2PointConstraint, Joint>)
    return std::make_unique<Joint>(a, b, in_a.getOrigin(), in_b.getOrigin());
  else
    return std::make_unique<Joint>(a, b, in_a, in_b);
}

std::vector<btScalar> readHinge(btTypedConstraint& joint) {
  auto& hinge = static_cast<btHingeConstraint&>(joint);
  return {hinge.getHingeAngle(), btScalar(hinge.getSolveLimit()), hinge.getLimitSign()};
}
std::vector<btScalar> readAccumulated(btTypedConstraint& joint) {
  std::vector<btScalar> all = readHinge(joint);
  all.push_back(static_cast<btHingeAccumulatedAngleConstraint&>(joint).getAccumulatedHingeAngle());
  return all;
}
std::vector<btScalar> readSlider(btTypedConstraint& joint) {
  auto& slider = static_cast<btSliderConstraint&>(joint);
  // Bullet leaves a free angle as the memory was.
  const bool is_free = slider.getLowerAngLimit() > slider.getUpperAngLimit();
  return {slider.getLinearPos(),
          is_free ? 0 : slider.getAngularPos(),
          slider.getLinDepth(),
          slider.getAngDepth(),
          btScalar(slider.getSolveLinLimit()),
          btScalar(slider.getSolveAngLimit())};
}
std::vector<btScalar> readCone(btTypedConstraint& joint) {
  auto& cone = static_cast<btConeTwistConstraint&>(joint);
  return {cone.getTwistAngle(), btScalar(cone.getSolveTwistLimit()),
          btScalar(cone.getSolveSwingLimit())};
}

const Class hinge = {"btHingeConstraint", make<btHingeConstraint>, make<pintle::QuaternionHinge>,
                     readHinge};
const Class accumulated = {"btHingeAccumulatedAngleConstraint",
                           make<btHingeAccumulatedAngleConstraint>, make<pintle::QuaternionHinge>,
                           readAccumulated};
const Class ball = {"btPoint2PointConstraint", make<btPoint2PointConstraint>,
                    make<pintle::BallJoint>,
                    [](btTypedConstraint&) { return std::vector<btScalar>(); }};
const Class slider = {"btSliderConstraint", make<btSliderConstraint>, make<pintle::SliderJoint>,
                      readSlider};
const Class cone = {"btConeTwistConstraint", make<btConeTwistConstraint>,
                    make<pintle::ConeTwistJoint>, readCone};

/// What a client does to each joint, by a pointer to Bullet's class: before step number i.
struct Use {
  const Class* of;
  const char* name;
  std::function<void(btTypedConstraint&, int i)> act;
};

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

/// What any constraint has.
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

// --- worlds --------------------------------------------------------------------------------------

struct World {
  explicit World(std::unique_ptr<btConstraintSolver> of) : solver(std::move(of)) {}
  virtual ~World() = default;
  virtual btDiscreteDynamicsWorld& world() = 0;

  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  std::unique_ptr<btConstraintSolver> solver;
};
using MadeWorld = std::unique_ptr<World>;

template <class Solver>
struct PlainWorld : World {
  PlainWorld() : World(std::make_unique<Solver>()) {}
  btDiscreteDynamicsWorld& world() override { return m_world; }
  Solver& its() { return static_cast<Solver&>(*solver); }

 private:
  btDiscreteDynamicsWorld m_world{&dispatcher, &broadphase, solver.get(), &configuration};
};
template <class Solver>
struct MultiBodyWorld : World {
  MultiBodyWorld() : World(std::make_unique<Solver>()) {}
  btDiscreteDynamicsWorld& world() override { return m_world; }

 private:
  btMultiBodyDynamicsWorld m_world{&dispatcher, &broadphase, static_cast<Solver*>(solver.get()),
                                   &configuration};
};

template <class Of>
MadeWorld makeWorld() {
  return std::make_unique<Of>();
}

/// Worlds in which stock joints are upgraded, and in which Pintle's are as they are.
struct Worlds {
  const char* name;
  MadeWorld (*upgraded)();
  MadeWorld (*ours)();
};
const Worlds all_worlds[] = {
    {"iterated", makeWorld<PlainWorld<pintle::SequentialJointSolver>>,
     makeWorld<PlainWorld<btSequentialImpulseConstraintSolver>>},
    {"NNCG", makeWorld<PlainWorld<pintle::UpgradingSolver<btNNCGConstraintSolver>>>,
     makeWorld<PlainWorld<btNNCGConstraintSolver>>},
    {"multibodies", makeWorld<MultiBodyWorld<pintle::SequentialMultiBodyJointSolver>>,
     makeWorld<MultiBodyWorld<btMultiBodyConstraintSolver>>},
    {"exact", makeWorld<PlainWorld<pintle::ExactJointSolver>>,
     makeWorld<PlainWorld<pintle::ExactJointSolver>>},
    {"exactWithMultibodies", makeWorld<MultiBodyWorld<pintle::ExactMultiBodyJointSolver>>,
     makeWorld<MultiBodyWorld<pintle::ExactMultiBodyJointSolver>>},
};

// --- runs ----------------------------------------------------------------------------------------

/// A chain of four links that hangs askew from the world, and what is read of it in each step.
class Chain : public support::Bodies {
 public:
  Chain(btDiscreteDynamicsWorld& world, const Class& of, bool ours)
      : Bodies(world), m_world(world), m_of(of) {
    btRigidBody* last = &add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
    for (int i = 0; i < 4; ++i) {
      btRigidBody& link = add(1 + i, vec(0.2, 0.06, 0.04), vec(0.4 * i + 0.25, 0, 0));
      const btQuaternion turn(vec(0.36, 0.48, 0.8), scalar(0.5));
      const btTransform frame(turn, vec(0.4 * i + 0.05, 0, 0));
      joints.push_back((ours ? of.ours : of.stock)(*last, link, inFrameOf(*last, frame),
                                                   inFrameOf(link, frame)));
      joints.back()->setJointFeedback(&m_feedback[i]);
      world.addConstraint(joints.back().get(), true);
      last = &link;
    }
  }
  /// Numbers of all steps.
  std::vector<btScalar> run(const Use& use, int count = steps) {
    std::vector<btScalar> all;
    for (int i = 0; i < count; ++i) {
      for (const auto& joint : joints) use.act(*joint, i);
      m_world.stepSimulation(scalar(dt), 0, scalar(dt));
      read(all);
    }
    return all;
  }
  void read(std::vector<btScalar>& to) const {
    const auto add = [&](const btVector3& v) { to.insert(to.end(), {v.x(), v.y(), v.z()}); };
    for (const auto& body : bodies) {
      add(body->getCenterOfMassPosition());
      for (int i = 0; i < 3; ++i) add(body->getCenterOfMassTransform().getBasis()[i]);
      add(body->getLinearVelocity());
      add(body->getAngularVelocity());
    }
    for (size_t i = 0; i < joints.size(); ++i) {
      to.push_back(joints[i]->internalGetAppliedImpulse());
      to.push_back(joints[i]->isEnabled());
      const btJointFeedback& of = m_feedback[i];
      for (const btVector3* v : {&of.m_appliedForceBodyA, &of.m_appliedTorqueBodyA,
                                 &of.m_appliedForceBodyB, &of.m_appliedTorqueBodyB})
        add(*v);
      const std::vector<btScalar> readings = m_of.readings(*joints[i]);
      to.insert(to.end(), readings.begin(), readings.end());
    }
  }

 private:
  static btTransform inFrameOf(const btRigidBody& body, const btTransform& frame) {
    return body.getCenterOfMassTransform().inverse() * frame;
  }

  btDiscreteDynamicsWorld& m_world;
  const Class& m_of;
  btJointFeedback m_feedback[4];
};

void expectSame(const std::vector<btScalar>& a, const std::vector<btScalar>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i)
    // (Bullet's NNCG solver may end in NaN, with Bullet's joints, too.)
    ASSERT_TRUE(a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i])))
        << "number " << i % (a.size() / steps) << " of step " << i / (a.size() / steps) << ": "
        << a[i] << ", " << b[i];
}

class UpgradedJoints : public testing::TestWithParam<Worlds> {};

TEST_P(UpgradedJoints, MoveAsPintlesToTheSameBits) {
  for (const Use& use : allUses()) {
    SCOPED_TRACE(testing::Message() << use.of->name << ": " << use.name);
    const MadeWorld upgraded = GetParam().upgraded(), ours = GetParam().ours();
    Chain stock_chain(upgraded->world(), *use.of, false), our_chain(ours->world(), *use.of, true);
    const std::vector<btScalar> stock = stock_chain.run(use);
    expectSame(stock, our_chain.run(use));
  }
}

INSTANTIATE_TEST_SUITE_P(, UpgradedJoints, testing::ValuesIn(all_worlds),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace upgraded_joints_test
