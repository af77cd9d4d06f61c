// Scenes that are played alike on Bullet's solver, the yardstick, and on the exact one, with Pintle's joints or with Bullet's.
#pragma once

#include <pintle/joints/frame_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/solver/exact_joint_solver.h>

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "bodies.h"
#include "contact_depth.h"
#include "support.h"

namespace support {

/// Joints and solver of a run.
struct Contender {
  const char* name;
  bool ours;   ///< Pintle's joints
  bool exact;  ///< the exact solver
};
constexpr Contender stock{"Bullet's joints on Bullet's solver", false, false};
constexpr Contender on_exact[] = {{"Pintle's joints on the exact solver", true, true},
                                  {"Bullet's joints on the exact solver", false, true}};

/// Bullet's joints are solved by the rows that they write themselves.
inline std::unique_ptr<btConstraintSolver> makeSolver(bool exact) {
  if (!exact) return std::make_unique<btSequentialImpulseConstraintSolver>();
  auto solver = std::make_unique<pintle::ExactJointSolver>();
  solver->setUpgradesBulletJoints(false);
  return solver;
}

/// Frame whose z, the axis of a hinge, is this one.
inline btTransform frameWithZ(const btVector3& pivot, const btVector3& z) {
  btVector3 x, y;
  btPlaneSpace1(z, x, y);
  return btTransform(pintle::columns(x, y, z), pivot);
}
/// Frame whose x, the axis of a slider, is this one.
inline btTransform frameWithX(const btVector3& pivot, const btVector3& x) {
  btVector3 y, z;
  btPlaneSpace1(x, y, z);
  return btTransform(pintle::columns(x, y, z), pivot);
}

struct EitherSolver {
  explicit EitherSolver(bool exact)
      : solver(makeSolver(exact)), world(&dispatcher, &broadphase, solver.get(), &configuration) {}

  std::unique_ptr<btConstraintSolver> solver;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btDiscreteDynamicsWorld world;
};

class EitherWorld : public EitherSolver, public Bodies {
 public:
  EitherWorld(const Contender& contender, double hz, int iterations)
      : EitherSolver(contender.exact),
        Bodies(EitherSolver::world),
        dt(1 / hz),
        m_ours(contender.ours) {
    world.getSolverInfo().m_minimumSolverBatchSize = 1;
    world.getSolverInfo().m_numIterations = iterations;
  }

  void step() { world.stepSimulation(scalar(dt), 0, scalar(dt)); }

  /// A body that its owner moves by setWorldTransform before each step.
  btRigidBody& addKinematic(std::unique_ptr<btCollisionShape> shape, const btTransform& pose) {
    btRigidBody& body = add(0, std::move(shape), pose, true);
    body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    return body;
  }
  /// Frame in the world, its z the axis. `set` gets the hinge, of either library. A positive motor velocity rotates b about z.
  template <class Set>
  void hinge(btRigidBody& a, btRigidBody& b, const btTransform& frame, const Set& set,
             bool linked_collide = false) {
    makeEither<pintle::QuaternionHinge, btHingeConstraint>(a, b, frame, set, linked_collide);
  }
  /// The same of a slider along x. A positive motor velocity moves b along x.
  template <class Set>
  void slider(btRigidBody& a, btRigidBody& b, const btTransform& frame, const Set& set,
              bool linked_collide = false) {
    makeEither<pintle::SliderJoint, btSliderConstraint>(a, b, frame, set, linked_collide);
  }

  /// Calls visit(pair) for each pair of bodies that are near each other.
  template <class Visit>
  void eachPair(const Visit& visit) {
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i)
      visit(*dispatcher.getManifoldByIndexInternal(i));
  }
  /// Calls visit(point) for each contact point of `body`.
  template <class Visit>
  void eachContact(const btRigidBody& body, const Visit& visit) {
    eachPair([&](const btPersistentManifold& pair) {
      if (pair.getBody0() != &body && pair.getBody1() != &body) return;
      for (int i = 0; i < pair.getNumContacts(); ++i) visit(pair.getContactPoint(i));
    });
  }
  /// m: the deepest contact of a body (contact_depth.h).
  double depth(const btRigidBody& body) {
    double deepest = 0;
    eachPair([&](const btPersistentManifold& pair) {
      if (pair.getBody0() == &body || pair.getBody1() == &body)
        deepest = std::max(deepest, depthOf(pair));
    });
    return deepest;
  }
  /// N: the sum of the normal forces on a body in the last step.
  double force(const btRigidBody& body) {
    double sum = 0;
    eachContact(body,
                [&](const btManifoldPoint& point) { sum += double(point.m_appliedImpulse) / dt; });
    return sum;
  }

  const double dt;  ///< s

 private:
  template <class Ours, class Bullets, class Set>
  void makeEither(btRigidBody& a, btRigidBody& b, const btTransform& frame, const Set& set,
                  bool linked_collide) {
    if (m_ours)
      make<Ours>(a, b, frame, set, linked_collide);
    else
      make<Bullets>(a, b, frame, set, linked_collide);
  }
  template <class J, class Set>
  void make(btRigidBody& a, btRigidBody& b, const btTransform& frame, const Set& set,
            bool linked_collide) {
    auto joint = std::make_unique<J>(a, b, a.getCenterOfMassTransform().inverse() * frame,
                                     b.getCenterOfMassTransform().inverse() * frame, true);
    set(*joint);
    join(std::move(joint), linked_collide);
  }

  const bool m_ours;
};

/// Dry friction of a hinge, N m. Bullet's has none: a motor of no speed takes its place.
inline void setFriction(pintle::QuaternionHinge& hinge, double torque, double) {
  hinge.setFriction(scalar(torque));
}
inline void setFriction(btHingeConstraint& hinge, double torque, double dt) {
  hinge.enableAngularMotor(true, 0, scalar(torque * dt));
}

}  // namespace support
