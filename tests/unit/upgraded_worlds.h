// Worlds in which stock joints are upgraded, and in which Pintle's are as they are: chains of the same joints in both.
#pragma once

#include <BulletDynamics/ConstraintSolver/btNNCGConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/solver/exact_joint_solver.h>
#include <pintle/solver/exact_multi_body_joint_solver.h>
#include <pintle/solver/sequential_multi_body_joint_solver.h>

#include <cmath>
#include <functional>
#include <memory>
#include <ostream>
#include <type_traits>
#include <vector>

#include "bodies.h"
#include "support.h"

namespace upgraded_worlds {

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
  /// Answers of its getters.
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

inline std::vector<btScalar> readHinge(btTypedConstraint& joint) {
  auto& hinge = static_cast<btHingeConstraint&>(joint);
  return {hinge.getHingeAngle(), btScalar(hinge.getSolveLimit()), hinge.getLimitSign()};
}
inline std::vector<btScalar> readAccumulated(btTypedConstraint& joint) {
  std::vector<btScalar> all = readHinge(joint);
  all.push_back(static_cast<btHingeAccumulatedAngleConstraint&>(joint).getAccumulatedHingeAngle());
  return all;
}
inline std::vector<btScalar> readSlider(btTypedConstraint& joint) {
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
inline std::vector<btScalar> readCone(btTypedConstraint& joint) {
  auto& cone = static_cast<btConeTwistConstraint&>(joint);
  return {cone.getTwistAngle(), btScalar(cone.getSolveTwistLimit()),
          btScalar(cone.getSolveSwingLimit())};
}

inline const Class hinge = {"btHingeConstraint", make<btHingeConstraint>,
                            make<pintle::QuaternionHinge>, readHinge};
inline const Class accumulated = {"btHingeAccumulatedAngleConstraint",
                                  make<btHingeAccumulatedAngleConstraint>,
                                  make<pintle::QuaternionHinge>, readAccumulated};
inline const Class ball = {"btPoint2PointConstraint", make<btPoint2PointConstraint>,
                           make<pintle::BallJoint>,
                           [](btTypedConstraint&) { return std::vector<btScalar>(); }};
inline const Class slider = {"btSliderConstraint", make<btSliderConstraint>,
                             make<pintle::SliderJoint>, readSlider};
inline const Class cone = {"btConeTwistConstraint", make<btConeTwistConstraint>,
                           make<pintle::ConeTwistJoint>, readCone};

/// Calls of a client to each joint, by a pointer to Bullet's class: before step number i.
struct Use {
  const Class* of;
  const char* name;
  std::function<void(btTypedConstraint&, int i)> act;
};

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
inline std::ostream& operator<<(std::ostream& out, const Worlds& of) { return out << of.name; }
inline const Worlds all_worlds[] = {
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

inline void expectSame(const std::vector<btScalar>& a, const std::vector<btScalar>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i)
    // (Bullet's NNCG solver may end in NaN, with Bullet's joints, too.)
    ASSERT_TRUE(a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i])))
        << "number " << i % (a.size() / steps) << " of step " << i / (a.size() / steps) << ": "
        << a[i] << ", " << b[i];
}

}  // namespace upgraded_worlds
