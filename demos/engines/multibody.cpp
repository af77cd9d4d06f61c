#include "multibody.h"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "bullet.h"

namespace engines {
namespace {

using scenes::Isometry3d;
using scenes::Joint;
using scenes::Kind;
using scenes::Scene;
using scenes::to_bullet;
using scenes::Vector3d;

constexpr int base = -1, no_link = -2;

// The link of each body; empty where the scene is no tree that hangs on the world, or has what multibodies do not.
std::vector<int> links_of(const Scene& scene) {
  if (scene.contacts() || scene.has(scenes::Error::recovery)) return {};
  std::vector<int> links;
  for (const scenes::Body& body : scene.bodies) links.push_back(body.mass > 0 ? no_link : base);
  for (size_t i = 0; i < scene.joints.size(); ++i) {
    const Joint& joint = scene.joints[i];
    const bool turns = joint.kind == Kind::hinge, slides = joint.kind == Kind::slider,
               holds = joint.kind == Kind::ball || joint.kind == Kind::fixed;
    if (!turns && !slides && !holds) return {};
    if (joint.spring.frequency > 0 || (joint.motor.speed && holds) || joint.breaks_at > 0 ||
        (joint.range.limited() && holds) || joint.restitution > 0)
      return {};
    int& link = links[size_t(joint.b)];
    if (link != no_link || links[size_t(joint.a)] == no_link) return {};
    link = int(i);
  }
  return std::count(links.begin(), links.end(), no_link) > 0 ? std::vector<int>() : links;
}

class MultiBodyEngine : public Engine {
 public:
  MultiBodyEngine(const Scene& scene, const std::vector<int>& links)
      : scene_(scene),
        links_(links),
        dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &solver_, &configuration_),
        tree_(int(scene.joints.size()), 0, btVector3(0, 0, 0), true, false) {
    world_.setGravity(btVector3(0, 0, btScalar(-scene.gravity)));
    for (size_t i = 0; i < scene.joints.size(); ++i) add(scene, scene.joints[i], int(i));
    tree_.finalizeMultiDof();
    tree_.setLinearDamping(0);
    tree_.setAngularDamping(0);
    for (size_t i = 0; i < scene.joints.size(); ++i) move(scene, scene.joints[i], int(i));
    world_.addMultiBody(&tree_);
    for (size_t i = 0; i < scene.joints.size(); ++i) restrain(scene.joints[i], int(i));
    look();
  }
  ~MultiBodyEngine() override {
    for (const auto& constraint : constraints_) world_.removeMultiBodyConstraint(constraint.get());
    for (const auto& collider : colliders_) world_.removeCollisionObject(collider.get());
    for (const auto& body : statics_) world_.removeCollisionObject(body.get());
    world_.removeMultiBody(&tree_);
  }

  void drive(double time, double dt) override {
    for (const auto& [joint, motor] : motors_) {
      motor->setVelocityTarget(btScalar(joint->motor.speed(time)));
      motor->setMaxAppliedImpulse(btScalar(joint->motor.max_torque * dt));
    }
  }
  void step(double dt) override {
    world_.stepSimulation(btScalar(dt), 0);
    looked_ = false;
  }
  State state(int body) const override {
    const int link = links_[size_t(body)];
    if (link == base) return {scene_.bodies[size_t(body)].pose, Vector3d::Zero(), Vector3d::Zero()};
    if (!looked_) look();
    const btTransform& pose = tree_.getLink(link).m_cachedWorldTransform;
    State state;
    state.pose.setIdentity();
    for (int i = 0; i < 3; ++i)
      state.pose.linear().row(i) = scenes::to_eigen(pose.getBasis()[i]).transpose();
    state.pose.translation() = scenes::to_eigen(pose.getOrigin());
    state.velocity = state.pose.linear() * scenes::to_eigen(linear_[link + 1]);
    state.angular_velocity = state.pose.linear() * scenes::to_eigen(angular_[link + 1]);
    return state;
  }

  btDynamicsWorld* bullet_world() override {
    giveShapes();
    return &world_;
  }

 private:
  // Links then have some, which collide with nothing. Without them Bullet does not find their limits and motors, either.
  void giveShapes() {
    if (!colliders_.empty()) return;
    for (size_t body = 0; body < links_.size(); ++body) {
      const int link = links_[body];
      if (body == 0) continue;
      shapes_.push_back(scenes::make_shape(scene_.bodies[body]));
      if (link == base) {
        statics_.push_back(std::make_unique<btCollisionObject>());
        statics_.back()->setCollisionShape(shapes_.back().get());
        statics_.back()->setWorldTransform(to_bullet(scene_.bodies[body].pose));
        world_.addCollisionObject(statics_.back().get(), 0, 0);
        continue;
      }
      colliders_.push_back(std::make_unique<btMultiBodyLinkCollider>(&tree_, link));
      colliders_.back()->setCollisionShape(shapes_.back().get());
      tree_.getLink(link).m_collider = colliders_.back().get();
      world_.addCollisionObject(colliders_.back().get(), 0, 0);
    }
    btAlignedObjectArray<btQuaternion> turns;
    btAlignedObjectArray<btVector3> origins;
    tree_.forwardKinematics(turns, origins);
    tree_.updateCollisionObjectWorldTransforms(turns, origins);
  }

  // Limits and motors.
  void restrain(const Joint& joint, int i) {
    const auto take = [this](auto constraint) {
      giveShapes();
      auto* const taken = constraint.get();
      constraints_.push_back(std::move(constraint));
      world_.addMultiBodyConstraint(taken);
      taken->finalizeMultiDof();
      return taken;
    };
    if (joint.range.limited()) {
      const Isometry3d from = scene_.bodies[size_t(joint.a)].pose * joint.in_a,
                       to = scene_.bodies[size_t(joint.b)].pose * joint.in_b,
                       apart = from.inverse() * to;
      // A multibody counts from where it starts.
      const double start = joint.kind == Kind::hinge
                               ? std::atan2(apart.linear()(1, 0), apart.linear()(0, 0))
                               : apart.translation().x();
      take(std::make_unique<btMultiBodyJointLimitConstraint>(
          &tree_, i, btScalar(joint.range.low - start), btScalar(joint.range.high - start)));
    }
    if (joint.motor.speed)
      motors_.emplace_back(&scene_.joints[size_t(i)],
                           take(std::make_unique<btMultiBodyJointMotor>(&tree_, i, 0, 0)));
  }

  void add(const Scene& scene, const Joint& joint, int i) {
    const scenes::Body& body = scene.bodies[size_t(joint.b)];
    const int parent = links_[size_t(joint.a)];
    const Isometry3d& a = scene.bodies[size_t(joint.a)].pose;
    const Isometry3d in_parent = parent == base ? a * joint.in_a : joint.in_a;
    Eigen::Matrix3d turn = body.pose.linear().transpose();
    if (parent != base) turn *= a.linear();
    btQuaternion parent_to_this;
    scenes::matrix_to_bullet(turn).getRotation(parent_to_this);
    const btVector3 pivot = to_bullet(in_parent.translation().eval()),
                    arm = to_bullet(Vector3d(-joint.in_b.translation()));
    const btScalar mass = btScalar(body.mass);
    const btVector3 inertia = to_bullet(body.inertia);
    const btVector3 axis =
        to_bullet(joint.in_b.linear().col(joint.kind == Kind::hinge ? 2 : 0).eval());
    if (joint.kind == Kind::hinge) {
      tree_.setupRevolute(i, mass, inertia, parent, parent_to_this, axis, pivot, arm, true);
    } else if (joint.kind == Kind::ball) {
      tree_.setupSpherical(i, mass, inertia, parent, parent_to_this, pivot, arm, true);
    } else if (joint.kind == Kind::fixed) {
      tree_.setupFixed(i, mass, inertia, parent, parent_to_this, pivot, arm);
    } else {
      tree_.setupPrismatic(i, mass, inertia, parent, parent_to_this, axis, pivot, arm, true);
    }
  }

  // Gives the joint the velocity that its bodies start with.
  void move(const Scene& scene, const Joint& joint, int i) {
    if (joint.kind == Kind::fixed) return;
    const scenes::Body &a = scene.bodies[joint.a], &b = scene.bodies[joint.b];
    const Vector3d turn = b.pose.linear().transpose() * (b.angular_velocity - a.angular_velocity);
    if (joint.kind == Kind::ball) {
      const btVector3 speed = to_bullet(turn);
      const btScalar dofs[] = {speed.x(), speed.y(), speed.z()};
      tree_.setJointVelMultiDof(i, dofs);
    } else if (joint.kind == Kind::hinge) {
      tree_.setJointVel(i, btScalar(turn.dot(joint.in_b.linear().col(2))));
    } else {
      const Vector3d slide = b.pose.linear().transpose() * (b.velocity - a.velocity);
      tree_.setJointVel(i, btScalar(slide.dot(joint.in_b.linear().col(0))));
    }
  }

  void look() const {
    looked_ = true;
    btAlignedObjectArray<btQuaternion> turns;
    btAlignedObjectArray<btVector3> origins;
    tree_.forwardKinematics(turns, origins);
    angular_.resize(tree_.getNumLinks() + 1);
    linear_.resize(tree_.getNumLinks() + 1);
    tree_.compTreeLinkVelocities(&angular_[0], &linear_[0]);
  }

  const Scene scene_;
  const std::vector<int> links_;  // of each body
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders_;
  std::vector<std::unique_ptr<btCollisionObject>> statics_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btMultiBodyConstraintSolver solver_;
  btMultiBodyDynamicsWorld world_;
  std::vector<std::unique_ptr<btMultiBodyConstraint>> constraints_;
  std::vector<std::pair<const Joint*, btMultiBodyJointMotor*>> motors_;
  mutable bool looked_ = false;                               // since the last step
  mutable btMultiBody tree_;                                  // it keeps what is asked for
  mutable btAlignedObjectArray<btVector3> angular_, linear_;  // of each body, in its frame
};

}  // namespace

std::unique_ptr<Engine> make_multibody(const Scene& scene) {
  const std::vector<int> links = links_of(scene);
  return links.empty() || scene.joints.empty() ? nullptr
                                               : std::make_unique<MultiBodyEngine>(scene, links);
}

}  // namespace engines
