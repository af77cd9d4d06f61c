#include "multibody.h"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include "bullet.h"

namespace engines {
namespace {

using scenes::Isometry3d;
using scenes::Joint;
using scenes::Kind;
using scenes::Scene;
using scenes::to_bullet;
using scenes::Vector3d;

// Body i hangs on joint i - 1, on a body before it.
bool is_free_tree(const Scene& scene) {
  if (scene.contacts() || scene.joints.size() + 1 != scene.bodies.size() ||
      scene.has(scenes::Error::recovery))
    return false;
  for (size_t i = 0; i < scene.joints.size(); ++i) {
    const Joint& joint = scene.joints[i];
    const bool kind =
        joint.kind == Kind::ball || joint.kind == Kind::hinge || joint.kind == Kind::slider;
    const bool acts = joint.range.limited() || joint.spring.frequency > 0 || joint.motor.speed;
    if (!kind || acts || joint.b != int(i) + 1 || joint.a >= joint.b) return false;
  }
  return true;
}

class MultiBodyEngine : public Engine {
 public:
  explicit MultiBodyEngine(const Scene& scene)
      : scene_(scene),
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
    look();
  }
  ~MultiBodyEngine() override {
    for (const auto& collider : colliders_) world_.removeCollisionObject(collider.get());
    world_.removeMultiBody(&tree_);
  }

  void drive(double, double) override {}
  void step(double dt) override { world_.stepSimulation(btScalar(dt), 0); }
  State state(int body) const override {
    if (body == 0) return {Isometry3d::Identity(), Vector3d::Zero(), Vector3d::Zero()};
    if (body == 1) look();  // bodies are asked for in their order
    const btTransform& pose = tree_.getLink(body - 1).m_cachedWorldTransform;
    State state;
    state.pose.setIdentity();
    for (int i = 0; i < 3; ++i)
      state.pose.linear().row(i) = scenes::to_eigen(pose.getBasis()[i]).transpose();
    state.pose.translation() = scenes::to_eigen(pose.getOrigin());
    state.velocity = state.pose.linear() * scenes::to_eigen(linear_[body]);
    state.angular_velocity = state.pose.linear() * scenes::to_eigen(angular_[body]);
    return state;
  }

  // Links have shapes from then on, which collide with nothing.
  btDynamicsWorld* bullet_world() override {
    if (!colliders_.empty()) return &world_;
    for (int i = 0; i < tree_.getNumLinks(); ++i) {
      shapes_.push_back(scenes::make_shape(scene_.bodies[size_t(i) + 1]));
      colliders_.push_back(std::make_unique<btMultiBodyLinkCollider>(&tree_, i));
      colliders_.back()->setCollisionShape(shapes_.back().get());
      tree_.getLink(i).m_collider = colliders_.back().get();
      world_.addCollisionObject(colliders_.back().get(), 0, 0);
    }
    btAlignedObjectArray<btQuaternion> turns;
    btAlignedObjectArray<btVector3> origins;
    tree_.forwardKinematics(turns, origins);
    tree_.updateCollisionObjectWorldTransforms(turns, origins);
    return &world_;
  }

 private:
  void add(const Scene& scene, const Joint& joint, int i) {
    const scenes::Body& body = scene.bodies[joint.b];
    const Eigen::Matrix3d turn =
        body.pose.linear().transpose() * scene.bodies[joint.a].pose.linear();
    btQuaternion parent_to_this;
    scenes::matrix_to_bullet(turn).getRotation(parent_to_this);
    const btVector3 pivot = to_bullet(joint.in_a.translation().eval()),
                    arm = to_bullet(Vector3d(-joint.in_b.translation()));
    const btScalar mass = btScalar(body.mass);
    const btVector3 inertia = to_bullet(body.inertia);
    const btVector3 axis =
        to_bullet(joint.in_b.linear().col(joint.kind == Kind::hinge ? 2 : 0).eval());
    if (joint.kind == Kind::hinge) {
      tree_.setupRevolute(i, mass, inertia, joint.a - 1, parent_to_this, axis, pivot, arm, true);
    } else if (joint.kind == Kind::ball) {
      tree_.setupSpherical(i, mass, inertia, joint.a - 1, parent_to_this, pivot, arm, true);
    } else {
      tree_.setupPrismatic(i, mass, inertia, joint.a - 1, parent_to_this, axis, pivot, arm, true);
    }
  }

  // Gives the joint the velocity that its bodies start with.
  void move(const Scene& scene, const Joint& joint, int i) {
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
    btAlignedObjectArray<btQuaternion> turns;
    btAlignedObjectArray<btVector3> origins;
    tree_.forwardKinematics(turns, origins);
    angular_.resize(tree_.getNumLinks() + 1);
    linear_.resize(tree_.getNumLinks() + 1);
    tree_.compTreeLinkVelocities(&angular_[0], &linear_[0]);
  }

  const Scene scene_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btMultiBodyConstraintSolver solver_;
  btMultiBodyDynamicsWorld world_;
  mutable btMultiBody tree_;                                  // it keeps what is asked for
  mutable btAlignedObjectArray<btVector3> angular_, linear_;  // of each body, in its frame
};

}  // namespace

std::unique_ptr<Engine> make_multibody(const Scene& scene) {
  if (!is_free_tree(scene)) return nullptr;
  return std::make_unique<MultiBodyEngine>(scene);
}

}  // namespace engines
