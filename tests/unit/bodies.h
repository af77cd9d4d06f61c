// Boxes and joints in a world of the test's own, with their energies and gaps.
#pragma once

#include <pintle/joints/ball_joint.h>

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "kinetic_energy.h"
#include "support.h"

namespace support {

/// They fall by 9.81 m/s^2 along -z. The world must live longer.
class Bodies {
 public:
  explicit Bodies(btDiscreteDynamicsWorld& world) : m_world(world) {
    world.setGravity(vec(0, 0, -gravity));
  }
  ~Bodies() {
    for (const auto& joint : joints) m_world.removeConstraint(joint.get());
    for (const auto& body : bodies) m_world.removeRigidBody(body.get());
  }
  Bodies(const Bodies&) = delete;
  Bodies& operator=(const Bodies&) = delete;

  /// Collides only if asked to. A mass of 0: static.
  btRigidBody& add(double mass, std::unique_ptr<btCollisionShape> shape, const btTransform& pose,
                   bool collides = false) {
    m_shapes.push_back(std::move(shape));
    btVector3 inertia(0, 0, 0);
    if (mass > 0) m_shapes.back()->calculateLocalInertia(scalar(mass), inertia);
    btRigidBody::btRigidBodyConstructionInfo info(scalar(mass), nullptr, m_shapes.back().get(),
                                                  inertia);
    info.m_startWorldTransform = pose;
    bodies.push_back(std::make_unique<btRigidBody>(info));
    bodies.back()->setActivationState(DISABLE_DEACTIVATION);
    if (collides)
      m_world.addRigidBody(bodies.back().get());
    else
      m_world.addRigidBody(bodies.back().get(), 0, 0);
    return *bodies.back();
  }
  /// A box.
  btRigidBody& add(double mass, const btVector3& half, const btTransform& pose,
                   bool collides = false) {
    return add(mass, std::make_unique<btBoxShape>(half), pose, collides);
  }
  btRigidBody& add(double mass, const btVector3& half, const btVector3& x, bool collides = false) {
    return add(mass, half, btTransform(btQuaternion::getIdentity(), x), collides);
  }
  /// Its bodies collide with each other only if asked to.
  void join(std::unique_ptr<btTypedConstraint> joint, bool linked_collide = false) {
    m_world.addConstraint(joint.get(), !linked_collide);
    joints.push_back(std::move(joint));
  }
  void removeLastJoint() {
    m_world.removeConstraint(joints.back().get());
    joints.pop_back();
  }

  /// J, in the middle of the last step: there the velocity belongs to the pose.
  double energy(double dt) const {
    double sum = kinetic();
    for (const auto& body : bodies)
      if (body->getInvMass() > 0)
        sum += weightOf(*body) * (double(body->getCenterOfMassPosition().z()) -
                                  dt / 2 * double(body->getLinearVelocity().z()));
    return sum;
  }
  double kinetic() const {
    double sum = 0;
    for (const auto& body : bodies)
      sum += kineticEnergy(*body, body->getCenterOfMassTransform().getBasis());
    return sum;
  }
  /// m: the largest distance of the pivots of balls.
  double largestGap() const {
    double largest = 0;
    for (const auto& constraint : joints) {
      const auto* joint = dynamic_cast<const pintle::BallJoint*>(constraint.get());
      if (joint == nullptr) continue;
      const btVector3 d = joint->getRigidBodyA().getCenterOfMassTransform() * joint->getPivotInA() -
                          joint->getRigidBodyB().getCenterOfMassTransform() * joint->getPivotInB();
      largest = std::max(largest, double(d.length()));
    }
    return largest;
  }

  std::vector<std::unique_ptr<btRigidBody>> bodies;
  std::vector<std::unique_ptr<btTypedConstraint>> joints;

 private:
  btDiscreteDynamicsWorld& m_world;
  std::vector<std::unique_ptr<btCollisionShape>> m_shapes;
};

}  // namespace support
