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

#include <cmath>
#include <functional>
#include <memory>
#include <new>
#include <ostream>
#include <string>
#include <type_traits>
#include <typeinfo>
#include <vector>

#include "bodies.h"
#include "support.h"

namespace contract_test {
extern thread_local long allocations;  // by operator new
}

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
      step();
      read(all);
    }
    return all;
  }
  void step() { m_world.stepSimulation(scalar(dt), 0, scalar(dt)); }
  void takeOut(size_t i) { m_world.removeConstraint(joints[i].get()); }
  void putBack(size_t i) { m_world.addConstraint(joints[i].get(), true); }
  /// Another joint of Pintle's with the frames of the last one.
  void makeAnew(size_t i) {
    auto& last = static_cast<btHingeConstraint&>(*joints[i]);
    joints[i] =
        m_of.ours(last.getRigidBodyA(), last.getRigidBodyB(), last.getAFrame(), last.getBFrame());
    joints[i]->setJointFeedback(&m_feedback[i]);
    putBack(i);
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

// --- joints that come and go ---------------------------------------------------------------------

const Use limited = {&hinge, "limit", [](btTypedConstraint& joint, int i) {
                       if (i != 0) return;
                       auto& of = static_cast<btHingeConstraint&>(joint);
                       of.setLimit(scalar(-0.2), scalar(0.3));
                     }};

/// A link that a hinge holds, and then another joint, made where the first one was.
class Successor {
 public:
  Successor(World& world, bool ours) : m_world(world.world()), m_ours(ours), m_bodies(m_world) {
    m_post = &m_bodies.add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
    m_link = &m_bodies.add(1, vec(0.2, 0.06, 0.04), vec(0.3, 0, 0));
    m_other = &m_bodies.add(2, vec(0.2, 0.06, 0.04), vec(-0.3, 0, 0));
  }
  ~Successor() { remove(); }

  void addHinge(double turn) { add<btHingeConstraint, pintle::QuaternionHinge>(*m_link, turn); }
  void addHingeToOther() { add<btHingeConstraint, pintle::QuaternionHinge>(*m_other, 0); }
  void addAccumulated() {
    add<btHingeAccumulatedAngleConstraint, pintle::QuaternionHinge>(*m_link, 0);
  }
  void remove() {
    if (m_joint == nullptr) return;
    m_world.removeConstraint(m_joint);
    m_joint->~btTypedConstraint();
    m_joint = nullptr;
  }
  std::vector<btScalar> run(int count) {
    std::vector<btScalar> all;
    for (int i = 0; i < count; ++i) {
      m_world.stepSimulation(scalar(dt), 0, scalar(dt));
      for (const btRigidBody* of : {m_link, m_other})
        for (const btVector3& v :
             {of->getCenterOfMassPosition(), of->getLinearVelocity(), of->getAngularVelocity()})
          all.insert(all.end(), {v.x(), v.y(), v.z()});
    }
    return all;
  }

 private:
  template <class Stock, class Ours>
  void add(btRigidBody& body, double turn) {
    if (m_ours)
      place<Ours>(body, turn);
    else
      place<Stock>(body, turn);
  }
  template <class Joint>
  void place(btRigidBody& body, double turn) {
    static_assert(sizeof(Joint) <= sizeof m_memory);
    const btTransform frame(btQuaternion(vec(0.6, 0, 0.8), scalar(turn)), vec(0, 0, 0));
    auto* const made = new (m_memory)
        Joint(*m_post, body, frame, body.getCenterOfMassTransform().inverse() * frame);
    // Bullet's method: Pintle's keeps the numbers that Bullet's object rounds.
    static_cast<btHingeConstraint*>(made)->setLimit(scalar(-0.3), scalar(0.2));
    m_joint = made;
    m_world.addConstraint(made, true);
  }

  alignas(16) char m_memory[8192];
  btDiscreteDynamicsWorld& m_world;
  const bool m_ours;
  support::Bodies m_bodies;
  btRigidBody *m_post, *m_link, *m_other;
  btTypedConstraint* m_joint = nullptr;
};

TEST_P(UpgradedJoints, RememberNothingOfAnotherAtTheSameAddress) {
  const std::function<void(Successor&)> all[] = {
      [](Successor& of) { of.addHinge(0); },  // in all the same, but new
      [](Successor& of) { of.addHinge(0.7); },
      [](Successor& of) { of.addHingeToOther(); },
      [](Successor& of) { of.addAccumulated(); },
  };
  for (const auto& add_next : all)
    for (const int steps_between : {0, 1, 20}) {
      SCOPED_TRACE(testing::Message() << &add_next - all << ", " << steps_between);
      const MadeWorld upgraded = GetParam().upgraded(), ours = GetParam().ours();
      std::vector<btScalar> numbers[2];
      for (const bool is_ours : {false, true}) {
        Successor pair(is_ours ? *ours : *upgraded, is_ours);
        pair.addHinge(0);
        pair.run(40);
        pair.remove();
        pair.run(steps_between);
        add_next(pair);
        numbers[is_ours] = pair.run(steps);
      }
      expectSame(numbers[0], numbers[1]);
    }
}

TEST_P(UpgradedJoints, StartAnewWhenTheyComeBack) {
  if (GetParam().name == std::string("NNCG")) return;  // ends in NaN, with Bullet's joints, too
  const MadeWorld upgraded = GetParam().upgraded(), ours = GetParam().ours();
  Chain stock(upgraded->world(), hinge, false), by_ours(ours->world(), hinge, true);
  expectSame(stock.run(limited), by_ours.run(limited));
  // A joint of Pintle's keeps its memory as long as it lives: a new one is the same.
  stock.takeOut(1);
  by_ours.takeOut(1);
  stock.run(limited, 1);
  by_ours.run(limited, 1);
  stock.putBack(1);
  by_ours.makeAnew(1);
  expectSame(stock.run(limited), by_ours.run(limited));
}

TEST_P(UpgradedJoints, AreOfTheWorldThatASolverIsIn) {
  const MadeWorld first = GetParam().upgraded(), second = GetParam().upgraded(),
                  alone = GetParam().upgraded();
  if (dynamic_cast<btMultiBodyDynamicsWorld*>(&first->world()) != nullptr)
    return;  // it has its own
  second->world().setConstraintSolver(first->solver.get());
  Chain a(first->world(), hinge, false), b(second->world(), ball, false),
      twin(alone->world(), hinge, false);
  std::vector<btScalar> shared;
  for (int i = 0; i < steps; ++i) {
    if (i == 0)
      for (const auto& joint : a.joints) limited.act(*joint, 0);
    a.step();
    a.read(shared);
    for (int k = 0; k < i % 3; ++k) b.step();
  }
  expectSame(shared, twin.run(limited));
}

// --- numbers that are not used -------------------------------------------------------------------

struct Bad {
  const Class* of;
  const char* field;
  std::function<void(btTypedConstraint&, btScalar)> write;
};

const Bad all_bad[] = {
    {&hinge, "limit",
     [](btTypedConstraint& c, btScalar x) { static_cast<btHingeConstraint&>(c).setLimit(-1, x); }},
    {&hinge, "motor target velocity",
     [](btTypedConstraint& c, btScalar x) {
       static_cast<btHingeConstraint&>(c).enableAngularMotor(true, x, 1);
     }},
    {&hinge, "joint frames",
     [](btTypedConstraint& c, btScalar x) {
       static_cast<btHingeConstraint&>(c).getAFrame().setOrigin({x, 0, 0});
     }},
    {&ball, "pivotA",
     [](btTypedConstraint& c, btScalar x) {
       static_cast<btPoint2PointConstraint&>(c).setPivotA({x, 0, 0});
     }},
    {&slider, "linear limit",
     [](btTypedConstraint& c, btScalar x) {
       static_cast<btSliderConstraint&>(c).setLowerLinLimit(x);
     }},
    {&cone, "twist span",
     [](btTypedConstraint& c, btScalar x) {
       static_cast<btConeTwistConstraint&>(c).setLimit(3, x);
     }},
};

template <class Solver>
void expectNamed(const Bad& bad, const std::function<void(const Solver&, int ignored)>& check) {
  SCOPED_TRACE(testing::Message() << bad.of->name << ": " << bad.field);
  PlainWorld<Solver> of;
  Chain chain(of.world(), *bad.of, false);
  for (int i = 0; i < 10; ++i) {
    if (i == 5) bad.write(*chain.joints[1], support::nan_value);
    chain.step();
    for (const auto& body : chain.bodies) ASSERT_TRUE(support::is_finite(*body));
    check(of.its(), i < 5 ? 0 : 1);
  }
  EXPECT_NE(of.its().whyIgnored(*chain.joints[1]).find(bad.field), std::string::npos)
      << of.its().whyIgnored(*chain.joints[1]);
  EXPECT_EQ(of.its().whyIgnored(*chain.joints[0]), "");
}

TEST(UpgradedNumbers, ThatAreNotFiniteAreNamed) {
  for (const Bad& bad : all_bad) {
    expectNamed<pintle::SequentialJointSolver>(bad, [](const auto&, int) {});
    expectNamed<pintle::ExactJointSolver>(bad, [](const auto& solver, int ignored) {
      EXPECT_EQ(solver.lastStep().ignored_settings, ignored);
    });
  }
}

TEST(UpgradedNumbers, AreNamedBeforeTheFirstStepAndOfPintlesJoints) {
  const pintle::SequentialJointSolver solver;
  btRigidBody a(1, nullptr, nullptr), b(1, nullptr, nullptr);
  btPoint2PointConstraint stock(a, b, vec(0, 0, 0), vec(0, 0, support::nan_value));
  EXPECT_NE(solver.whyIgnored(stock).find("pivotB"), std::string::npos);
  const pintle::BallJoint ours(a, b, vec(0, 0, 0), vec(0, 0, support::nan_value));
  EXPECT_EQ(solver.whyIgnored(ours), solver.whyIgnored(stock));
}

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

// --- memory and threads --------------------------------------------------------------------------

TEST_P(UpgradedJoints, AllocateNothingOnceASolverHasSeenThem) {
  for (const Class* of : {&hinge, &ball, &slider, &cone}) {
    SCOPED_TRACE(of->name);
    const MadeWorld world = GetParam().upgraded();
    Chain chain(world->world(), *of, false);
    for (int i = 0; i < 120; ++i) chain.step();
    const long before = contract_test::allocations;
    for (int i = 0; i < 60; ++i) chain.step();
    EXPECT_EQ(contract_test::allocations - before, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(, UpgradedJoints, testing::ValuesIn(all_worlds),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace upgraded_joints_test
