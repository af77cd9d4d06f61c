// A world of bodies, joints and contacts that is stepped one step at a time, so that two of them can take
// turns. Its joints are made by kind, of one family (families.h).
//
// Measured, in double and from the poses alone:
//   gap      distance between the two anchors of a joint, m; of a slider the distance across its axis
//   energy   kinetic, and kinetic plus height, J

#pragma once

#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "crowd.h"
#include "families.h"
#include "world.h"

namespace scenes {

struct PlaygroundSettings {
  int iterations = 10;
  double gravity = standard_gravity;
};

class Playground {
 public:
  explicit Playground(const PlaygroundSettings& settings = {})
      : gravity_(settings.gravity), world_(settings.gravity, settings.iterations, [] {
          return std::make_unique<btSequentialImpulseConstraintSolver>();
        }) {}
  ~Playground() {
    for (const auto& body : round_bodies_) world_.bullet().removeRigidBody(body.get());
  }
  Playground(const Playground&) = delete;
  Playground& operator=(const Playground&) = delete;

  // A box that collides, and is removed with the world.
  btRigidBody& box(double mass, const Eigen::Vector3d& half_extents, const btTransform& pose,
                   double friction = 0.5) {
    btRigidBody& body = world_.add_box(mass, to_bullet(half_extents), pose, true);
    body.setFriction(btScalar(friction));
    if (mass > 0) bodies_.push_back(&body);
    return body;
  }
  btRigidBody& box(double mass, const Eigen::Vector3d& half_extents,
                   const Eigen::Vector3d& position) {
    return box(mass, half_extents, pose_at(to_bullet(position)));
  }
  // One that collides with nothing.
  btRigidBody& ghost(double mass, const Eigen::Vector3d& half_extents, const btTransform& pose) {
    btRigidBody& body = world_.add_box(mass, to_bullet(half_extents), pose);
    if (mass > 0) bodies_.push_back(&body);
    return body;
  }
  btRigidBody& ground(double z = 0) { return box(0, {200, 200, 1}, {0, 0, z - 1}); }
  btRigidBody& round(double mass, std::unique_ptr<btCollisionShape> shape, const btTransform& pose,
                     double friction = 0.5) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(btScalar(mass), inertia);
    btRigidBody::btRigidBodyConstructionInfo info(btScalar(mass), nullptr, shape.get(), inertia);
    info.m_startWorldTransform = pose;
    info.m_friction = btScalar(friction);
    shapes_.push_back(std::move(shape));
    round_bodies_.push_back(std::make_unique<btRigidBody>(info));
    btRigidBody& body = *round_bodies_.back();
    body.setActivationState(DISABLE_DEACTIVATION);
    world_.bullet().addRigidBody(&body, btBroadphaseProxy::DefaultFilter,
                                 btBroadphaseProxy::DefaultFilter);
    if (mass > 0) bodies_.push_back(&body);
    return body;
  }

  // Joins two bodies where they stand, in a frame of the world.
  template <class Family>
  btTypedConstraint& join(Kind kind, btRigidBody& a, btRigidBody& b, const btTransform& frame,
                          double limit = 0) {
    return join<Family>({kind, a, b, a.getCenterOfMassTransform().inverse() * frame,
                         b.getCenterOfMassTransform().inverse() * frame, limit});
  }
  // By frames of the bodies, which may be apart.
  template <class Family>
  btTypedConstraint& join(const JointParts& parts) {
    anchors_.push_back({&parts.a, &parts.b, to_eigen(parts.in_a.getOrigin()),
                        to_eigen(parts.in_b.getOrigin()),
                        to_eigen(parts.in_a.getBasis().getColumn(0)), parts.kind == Kind::slider});
    return world_.take_joint(make_joint<Family>(parts));
  }
  // The same between bodies that collide with each other nevertheless.
  template <class Family>
  btTypedConstraint& join_colliding(const JointParts& parts) {
    btTypedConstraint& joint = join<Family>(parts);
    world_.bullet().removeConstraint(&joint);
    world_.bullet().addConstraint(&joint, false);
    return joint;
  }
  template <class Family>
  typename Family::Hinge& hinge(btRigidBody& a, btRigidBody& b, const btTransform& frame,
                                double limit = 0) {
    return static_cast<typename Family::Hinge&>(join<Family>(Kind::hinge, a, b, frame, limit));
  }
  template <class Family>
  typename Family::Slider& slider(btRigidBody& a, btRigidBody& b, const btTransform& frame,
                                  double limit = 0) {
    return static_cast<typename Family::Slider&>(join<Family>(Kind::slider, a, b, frame, limit));
  }
  template <class Family>
  typename Family::ConeTwist& cone(btRigidBody& a, btRigidBody& b, const btTransform& frame) {
    return static_cast<typename Family::ConeTwist&>(join<Family>(Kind::cone_twist, a, b, frame));
  }

  void step(double dt) { world_.step(dt); }

  struct Gap {
    double mean = 0, largest = 0;  // over the joints
  };
  Gap gap() const {
    Gap gap;
    for (const Anchors& at : anchors_) {
      Eigen::Vector3d d = point_in_world(*at.b, at.in_b) - point_in_world(*at.a, at.in_a);
      if (at.slides) {
        const Eigen::Vector3d axis = direction_in_world(*at.a, at.axis);
        d -= axis.dot(d) * axis;
      }
      const double size = d.norm();
      if (!std::isfinite(size)) return {HUGE_VAL, HUGE_VAL};
      gap.mean += size / double(anchors_.size());
      gap.largest = std::max(gap.largest, size);
    }
    return gap;
  }
  double kinetic() const {
    double sum = 0;
    for (const btRigidBody* body : bodies_) sum += scenes::energy(*body, 0);
    return sum;
  }
  double energy() const {
    double sum = 0;
    for (const btRigidBody* body : bodies_) sum += scenes::energy(*body, gravity_);
    return sum;
  }
  // The largest of any body: m/s and rad/s. Infinite where it is not finite.
  double speed() const {
    return largest(
        [](const btRigidBody& body) { return double(body.getLinearVelocity().length()); });
  }
  double spin() const {
    return largest(
        [](const btRigidBody& body) { return double(body.getAngularVelocity().length()); });
  }

  World& world() { return world_; }
  const std::vector<btRigidBody*>& bodies() const { return bodies_; }
  int joints() const { return int(anchors_.size()); }

 private:
  template <class Of>
  double largest(const Of& of) const {
    double max_value = 0;
    for (const btRigidBody* body : bodies_) {
      const double value = of(*body);
      if (!std::isfinite(value)) return HUGE_VAL;
      max_value = std::max(max_value, value);
    }
    return max_value;
  }
  struct Anchors {
    const btRigidBody *a, *b;
    Eigen::Vector3d in_a, in_b, axis;
    bool slides;
  };
  double gravity_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> round_bodies_;
  World world_;
  std::vector<btRigidBody*> bodies_;  // those that move
  std::vector<Anchors> anchors_;
};

using PlaygroundPtr = std::unique_ptr<Playground>;

}  // namespace scenes
