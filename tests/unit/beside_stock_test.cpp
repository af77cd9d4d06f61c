// On Bullet's own solver joints are never worse than stock's: where contacts contradict them, under loads that the passes do not carry, from any start.
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/quaternion_hinge.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "support.h"

namespace beside_stock_test {

using support::scalar;
using support::vec;

enum class Joints { stocks, pintles };

// A world of bodies and joints of one of the two kinds.
class World {
 public:
  World(Joints joints, double hz) : m_joints(joints), m_hz(hz) {
    m_world.setGravity(vec(0, -9.81, 0));
  }
  ~World() {
    for (const auto& joint : m_constraints) m_world.removeConstraint(joint.get());
    for (const auto& body : m_bodies) m_world.removeRigidBody(body.get());
  }
  btRigidBody& add(double mass, std::unique_ptr<btCollisionShape> shape, const btVector3& at,
                   bool collides, bool sleeps = false) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(scalar(mass), inertia);
    m_bodies.push_back(std::make_unique<btRigidBody>(scalar(mass), nullptr, shape.get(), inertia));
    m_shapes.push_back(std::move(shape));
    btRigidBody& body = *m_bodies.back();
    body.setWorldTransform(btTransform(btQuaternion::getIdentity(), at));
    body.setInterpolationWorldTransform(body.getWorldTransform());
    if (!sleeps) body.setActivationState(DISABLE_DEACTIVATION);
    if (collides)
      m_world.addRigidBody(&body);
    else
      m_world.addRigidBody(&body, 0, 0);
    return body;
  }
  void ball(btRigidBody& a, btRigidBody& b, const btVector3& in_a, const btVector3& in_b,
            bool linked_collide = false) {
    std::unique_ptr<btPoint2PointConstraint> joint;
    if (m_joints == Joints::pintles)
      joint = std::make_unique<pintle::BallJoint>(a, b, in_a, in_b);
    else
      joint = std::make_unique<btPoint2PointConstraint>(a, b, in_a, in_b);
    keep(std::move(joint), in_a, in_b, linked_collide);
  }
  void hinge(btRigidBody& a, btRigidBody& b, const btVector3& in_a, const btVector3& in_b,
             bool linked_collide = false) {
    const btVector3 z = vec(0, 0, 1);
    std::unique_ptr<btHingeConstraint> joint;
    if (m_joints == Joints::pintles)
      joint = std::make_unique<pintle::QuaternionHinge>(a, b, in_a, in_b, z, z);
    else
      joint = std::make_unique<btHingeConstraint>(a, b, in_a, in_b, z, z);
    keep(std::move(joint), in_a, in_b, linked_collide);
  }
  void step() { m_world.stepSimulation(scalar(1 / m_hz), 0, scalar(1 / m_hz)); }

  double kinetic() const {
    double sum = 0;
    for (const auto& body : m_bodies) {
      if (body->getInvMass() == 0) continue;
      sum += 0.5 * double(body->getLinearVelocity().length2() / body->getInvMass());
      const btVector3 w =
          body->getWorldTransform().getBasis().transpose() * body->getAngularVelocity();
      for (int i = 0; i < 3; ++i)
        sum += 0.5 * double(w[i] * w[i] / body->getInvInertiaDiagLocal()[i]);
    }
    return sum;
  }
  double largestGap() const {
    double most = 0;
    for (const Anchors& at : m_anchors)
      most = std::max(
          most,
          double((at.a.getWorldTransform()(at.in_a) - at.b.getWorldTransform()(at.in_b)).length()));
    return most;
  }
  bool sleeps() const {
    return std::none_of(m_bodies.begin(), m_bodies.end(), [](const auto& body) {
      return body->getInvMass() > 0 && body->isActive();
    });
  }

 private:
  struct Anchors {
    const btRigidBody &a, &b;
    btVector3 in_a, in_b;
  };
  void keep(std::unique_ptr<btTypedConstraint> joint, const btVector3& in_a, const btVector3& in_b,
            bool linked_collide) {
    m_world.addConstraint(joint.get(), !linked_collide);
    m_anchors.push_back({joint->getRigidBodyA(), joint->getRigidBodyB(), in_a, in_b});
    m_constraints.push_back(std::move(joint));
  }

  Joints m_joints;
  double m_hz;
  btDefaultCollisionConfiguration m_configuration;
  btCollisionDispatcher m_dispatcher{&m_configuration};
  btDbvtBroadphase m_broadphase;
  btSequentialImpulseConstraintSolver m_solver;
  btDiscreteDynamicsWorld m_world{&m_dispatcher, &m_broadphase, &m_solver, &m_configuration};
  std::vector<std::unique_ptr<btCollisionShape>> m_shapes;
  std::vector<std::unique_ptr<btRigidBody>> m_bodies;
  std::vector<std::unique_ptr<btTypedConstraint>> m_constraints;
  std::vector<Anchors> m_anchors;
};

std::unique_ptr<btCollisionShape> box(double x, double y, double z) {
  return std::make_unique<btBoxShape>(vec(x, y, z));
}

// --- bodies that touch ---------------------------------------------------------------------------

// A chain hangs at rest. Neighbours overlap and collide with each other, as they do where a joint is added to a world without a further
// word. The mean kinetic energy of the last 5 of 10 s, J: 0 would be right.
double energyOfOverlaps(Joints joints, bool hinges, double hz, double overlap, unsigned seed) {
  World world(joints, hz);
  std::mt19937 random(seed);
  const auto off = [&] { return 2e-3 * (double(random()) / 4294967296. - 0.5); };
  btRigidBody* last = &world.add(0, box(0.06, 0.25, 0.06), vec(0, 0, 0), true);
  const double to_end = 0.25 - overlap / 2;
  for (int i = 1; i <= 10; ++i) {
    btRigidBody& link =
        world.add(1, box(0.06, 0.25, 0.06), vec(off(), -(0.5 - overlap) * i + off(), off()), true);
    if (hinges)
      world.hinge(*last, link, vec(0, -to_end, 0), vec(0, to_end, 0), true);
    else
      world.ball(*last, link, vec(0, -to_end, 0), vec(0, to_end, 0), true);
    last = &link;
  }
  const int steps = int(10 * hz);
  double mean = 0;
  for (int i = 0; i < steps; ++i) {
    world.step();
    if (i >= steps / 2) mean += world.kinetic() / (steps - steps / 2);
  }
  return mean;
}

// The sum of some starts, which are chance.
void expectAsCalm(bool hinges, double hz, double overlap, double factor) {
  double stock = 0, ours = 0;
  for (unsigned seed = 0; seed < 4; ++seed) {
    stock += energyOfOverlaps(Joints::stocks, hinges, hz, overlap, seed);
    ours += energyOfOverlaps(Joints::pintles, hinges, hz, overlap, seed);
  }
  EXPECT_LT(ours, factor * stock) << "J, " << (hinges ? "hinges, " : "balls, ") << hz << " Hz, "
                                  << overlap << " m";
}

TEST(BesideStock, LinksThatOverlapAndCollideAreAsCalm) {
  // (Of balls stock's rows come to less than the whole joint in a pass, which leans on the contact.)
  expectAsCalm(false, 60, 0.05, 1.8);
  expectAsCalm(false, 240, 0.05, 1.2);
  for (const double hz : {60., 240.}) expectAsCalm(true, hz, 0.05, 1.2);
}

// The speed that ERP asks of such gaps in a step is more than a contact lets them have.
TEST(BesideStock, LinksThatOverlapByMuchAreCalmer) {
  for (const bool hinges : {false, true}) expectAsCalm(hinges, 240, 0.2, 0.25);
}

// --- loads ---------------------------------------------------------------------------------------

// A weight swings on a rope of links of the length l, m. The largest gap in 10 s, m.
double gapOfRope(Joints joints, int links, double l, double mass, double load, double push) {
  World world(joints, 60);
  const auto link = [&] {
    return std::make_unique<btCapsuleShape>(scalar(l * 0.13), scalar(l * 0.74));
  };
  btRigidBody* last = &world.add(0, link(), vec(0, 0, 0), false);
  btVector3 end = vec(0, 0, 0);
  for (int i = 0; i < links; ++i) {
    btRigidBody& body = world.add(mass, link(), vec(0, -l * (i + 0.5), 0), false);
    world.ball(*last, body, end, vec(0, l / 2, 0));
    last = &body;
    end = vec(0, -l / 2, 0);
  }
  btRigidBody& weight = world.add(load, box(0.3, 0.3, 0.3), vec(0, -l * links - 0.3, 0), false);
  world.ball(*last, weight, end, vec(0, 0.3, 0));
  weight.setLinearVelocity(vec(push, 0, 0));
  double most = 0;
  for (int i = 0; i < 600; ++i) {
    world.step();
    most = std::max(most, world.largestGap());
  }
  return most;
}

// Where stock's ropes hold together. (Of shorter links both tear, and which does so first is chance.)
TEST(BesideStock, RopesOfShortLinksHoldNoWorse) {
  for (const auto& [links, l] : {std::pair(10, 0.1), {16, 0.1}, {16, 0.2}, {30, 0.2}}) {
    for (const double load : {1., 2.}) {
      EXPECT_LT(gapOfRope(Joints::pintles, links, l, 1, load, 2),
                gapOfRope(Joints::stocks, links, l, 1, load, 2))
          << "m, " << links << " links of " << l << " m, load " << load << ":1";
    }
  }
}

// A bridge of planks between two posts, with nothing on it.
struct Rest {
  double from = HUGE_VAL;  // s: it sleeps
  double gap = 0;          // m, the largest in the end
};
Rest restOfBridge(Joints joints, int planks, double slack) {
  const double hz = 60, l = 0.45, span = planks * l / (1 + slack);
  World world(joints, hz);
  btRigidBody* last = &world.add(0, box(0.1, 0.1, 0.5), vec(0, 0, 0), false, true);
  btRigidBody& end = world.add(0, box(0.1, 0.1, 0.5), vec(span, 0, 0), false, true);
  btVector3 at = vec(0, 0, 0);
  for (int i = 0; i < planks; ++i) {
    btRigidBody& plank = world.add(3, box(l / 2 * 0.95, 0.05, 0.5),
                                   vec((i + 0.5) * span / planks, 0, 0), false, true);
    world.hinge(*last, plank, at, vec(-l / 2, 0, 0));
    last = &plank;
    at = vec(l / 2, 0, 0);
  }
  world.hinge(*last, end, at, vec(0, 0, 0));
  Rest rest;
  for (int i = 0; i < int(30 * hz); ++i) {
    world.step();
    if (!world.sleeps())
      rest.from = HUGE_VAL;
    else if (!(rest.from < HUGE_VAL))
      rest.from = i / hz;
  }
  rest.gap = world.largestGap();
  return rest;
}

TEST(BesideStock, TautBridgesSleep) {
  for (const int planks : {8, 10, 11, 12, 13, 14, 16}) {
    for (const double slack : {0., 0.001, 0.005}) {
      const Rest stock = restOfBridge(Joints::stocks, planks, slack),
                 ours = restOfBridge(Joints::pintles, planks, slack);
      EXPECT_LT(ours.from, 2.6 * stock.from) << "s, " << planks << " planks, slack " << slack;
      EXPECT_LT(ours.gap, stock.gap) << "m, " << planks << " planks, slack " << slack;
    }
  }
}

// The same with a box of 50 kg on it. Its planks touch and collide, as by default: no more is to fall through than through stock's.
double gapUnderABox(Joints joints, int planks) {
  const double hz = 60, l = 0.5;
  World world(joints, hz);
  btRigidBody* last = &world.add(0, box(l / 2, 0.05, 0.6), vec(0, 0, 0), true);
  for (int i = 1; i <= planks + 1; ++i) {
    btRigidBody& plank =
        world.add(i <= planks ? 3 : 0, box(l / 2, 0.05, 0.6), vec(i * l, 0, 0), true);
    for (const double z : {-0.5, 0.5})
      world.ball(*last, plank, vec(l / 2, 0, z), vec(-l / 2, 0, z), true);
    last = &plank;
  }
  const btRigidBody& load =
      world.add(50, box(0.3, 0.3, 0.3), vec((planks + 1) * l / 2, 0.4, 0), true);
  double most = 0;
  for (int i = 0; i < int(10 * hz); ++i) {
    world.step();
    most = std::max(most, world.largestGap());
  }
  return load.getWorldTransform().getOrigin().y() > -5 ? most : HUGE_VAL;
}

TEST(BesideStock, BridgesOfPlanksThatTouchBearALoad) {
  for (const int planks : {6, 10})
    EXPECT_LT(gapUnderABox(Joints::pintles, planks), 1.2 * gapUnderABox(Joints::stocks, planks))
        << "m, " << planks << " planks";
}

// --- starts --------------------------------------------------------------------------------------

// A mouse grabs a body and moves on before the first step: how far the body lags behind it in the end, m.
double lagOfGrab(Joints joints, double per_frame) {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  world.setGravity(vec(0, 0, 0));
  btBoxShape shape(vec(0.5, 0.5, 0.5));
  btVector3 inertia;
  shape.calculateLocalInertia(1, inertia);
  btRigidBody body(1, nullptr, &shape, inertia);
  body.setActivationState(DISABLE_DEACTIVATION);
  world.addRigidBody(&body);
  std::unique_ptr<btPoint2PointConstraint> grab;
  if (joints == Joints::pintles)
    grab = std::make_unique<pintle::BallJoint>(body, vec(0, 0, 0));
  else
    grab = std::make_unique<btPoint2PointConstraint>(body, vec(0, 0, 0));
  world.addConstraint(grab.get());
  btVector3 mouse = vec(0, 0, 0);
  for (int i = 0; i < 300; ++i) {
    mouse += vec(per_frame, 0, 0);
    grab->setPivotB(mouse);
    world.stepSimulation(scalar(1. / 60), 0, scalar(1. / 60));
  }
  world.removeConstraint(grab.get());
  world.removeRigidBody(&body);
  return double((body.getWorldTransform().getOrigin() - mouse).length());
}

TEST(BesideStock, AMouseThatMovesBeforeTheFirstStepIsFollowed) {
  for (const double per_frame : {0.05, 0.5})
    EXPECT_LT(lagOfGrab(Joints::pintles, per_frame), lagOfGrab(Joints::stocks, per_frame) + 0.05)
        << "m, " << per_frame << " m a frame";
}

// --- fast turns ----------------------------------------------------------------------------------

// A bar turns about a hinge at its end for a minute: its energy at the end, over that at the start.
double energyOfSpin(double speed) {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  world.setGravity(vec(0, 0, 0));
  btBoxShape shape(vec(0.5, 0.1, 0.2));
  btVector3 inertia;
  shape.calculateLocalInertia(1, inertia);
  btRigidBody body(1, nullptr, &shape, inertia);
  body.setWorldTransform(btTransform(btQuaternion::getIdentity(), vec(0.5, 0, 0)));
  body.setActivationState(DISABLE_DEACTIVATION);
  world.addRigidBody(&body);
  body.setAngularVelocity(vec(0, 0, speed));
  body.setLinearVelocity(vec(0, 0.5 * speed, 0));
  pintle::QuaternionHinge hinge(body, vec(-0.5, 0, 0), vec(0, 0, 1));
  world.addConstraint(&hinge);
  const auto energy = [&] {
    const double w = double(body.getAngularVelocity().length());
    return 0.5 * double(body.getLinearVelocity().length2()) +
           0.5 * w * w / double(body.getInvInertiaDiagLocal().z());
  };
  const double start = energy();
  for (int i = 0; i < 3600; ++i) world.stepSimulation(scalar(1. / 60), 0, scalar(1. / 60));
  world.removeConstraint(&hinge);
  world.removeRigidBody(&body);
  return energy() / start;
}

TEST(BesideStock, WhatTurnsFastKeepsItsEnergyAndGainsNone) {
  for (const double speed : {3., 5., 8., 10., 12., 15.}) {
    // A chord's speed holds (w dt / 2)^2 more than the circle's, at the start as well.
    const double chord = speed / 60 / 2 * speed / 60 / 2;
    const double end = energyOfSpin(speed);
    EXPECT_LT(end, 1 + 2 * chord) << speed << " rad/s";
    if (speed > 10) continue;
    EXPECT_GT(end, 0.97) << speed << " rad/s";
  }
}

}  // namespace beside_stock_test
