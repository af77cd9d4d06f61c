// A world of bodies, joints and contacts that is stepped one step at a time, so that two of them can take
// turns. Its joints are made by kind, of one family (families.h).
//
// Measured, in double and from the poses alone:
//   gap      distance between the two anchors of a joint, m; of a slider the distance across its axis
//   energy   kinetic plus height, J

#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "families.h"
#include "world.h"

namespace scenes {

struct PlaygroundSettings {
  int iterations = 10;
  double gravity = standard_gravity;
  SolverFactory make_solver;
};

class Playground {
 public:
  explicit Playground(const PlaygroundSettings& settings = {})
      : gravity_(settings.gravity),
        world_(settings.gravity, settings.iterations, settings.make_solver) {}
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

  void step(double dt) { world_.step(dt); }

  // The largest of any joint; infinite where it is not finite.
  double gap() const {
    double most = 0;
    for (const Anchors& at : anchors_) {
      Eigen::Vector3d d = point_in_world(*at.b, at.in_b) - point_in_world(*at.a, at.in_a);
      if (at.slides) {
        const Eigen::Vector3d axis = direction_in_world(*at.a, at.axis);
        d -= axis.dot(d) * axis;
      }
      const double size = d.norm();
      if (!std::isfinite(size)) return HUGE_VAL;
      most = std::max(most, size);
    }
    return most;
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
  World world_;
  std::vector<btRigidBody*> bodies_;  // those that move
  std::vector<Anchors> anchors_;
};

using PlaygroundPtr = std::unique_ptr<Playground>;

}  // namespace scenes
