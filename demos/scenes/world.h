// The small Bullet world that every scene runs in, and measurements of its bodies' poses.
//
// Bodies never sleep, and collide only where a scene asks for it, so that it measures its joints
// and nothing else. SI units, z up. The world owns what is added to it. The same calls in the same
// order give the same bits: a scene repeats exactly on one machine.
//
// Measurements are made in double whatever btScalar is, and from the poses of the bodies alone:
// what a joint believes about itself is not evidence.

#pragma once

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "scene.h"

namespace scenes {

// Makes the solver of a world; empty: that of default_solver.
using SolverFactory = std::function<std::unique_ptr<btConstraintSolver>()>;

// Of all worlds of the program that name none: Bullet's sequential impulses.
inline SolverFactory& default_solver() {
  static SolverFactory make = [] {
    return std::make_unique<btSequentialImpulseConstraintSolver>();
  };
  return make;
}

// What a joint may offer beyond btHingeConstraint's methods; a scene asks before it uses them.
template <class Joint, class = void>
struct HasAccumulatedAngle : std::false_type {};
template <class Joint>
struct HasAccumulatedAngle<Joint,
                           std::void_t<decltype(std::declval<Joint&>().getAccumulatedHingeAngle())>>
    : std::true_type {};

template <class Joint, class = void>
struct HasLimitSpring : std::false_type {};
template <class Joint>
struct HasLimitSpring<
    Joint, std::void_t<decltype(std::declval<Joint&>().setLimitSpring(btScalar(1), btScalar(1)))>>
    : std::true_type {};

// The default last argument of a scene: leaves each joint as its constructor made it.
struct AsConstructed {
  template <class Joint>
  void operator()(Joint&) const {}
};

class World {
 public:
  explicit World(double gravity = standard_gravity, int iterations = 10,
                 const SolverFactory& make_solver = {})
      : dispatcher_(&configuration_),
        solver_(make_solver ? make_solver() : default_solver()()),
        world_(&dispatcher_, &broadphase_, solver_.get(), &configuration_) {
    world_.setGravity(btVector3(0, 0, btScalar(-gravity)));
    world_.getSolverInfo().m_numIterations = iterations;
  }

  World(const World&) = delete;
  World& operator=(const World&) = delete;

  ~World() {
    removeAll(joints_, [this](auto& joint) { world_.removeConstraint(&joint); });
    removeAll(bodies_, [this](auto& body) { world_.removeRigidBody(&body); });
  }

  // Mass 0 makes a static body.
  btRigidBody& add_box(double mass, const btVector3& half_extents, const btTransform& pose,
                       bool collides = false) {
    return add(mass, std::make_unique<btBoxShape>(half_extents), pose, collides);
  }
  btRigidBody& add(double mass, std::unique_ptr<btCollisionShape> shape, const btTransform& pose,
                   bool collides) {
    shapes_.push_back(std::move(shape));
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shapes_.back()->calculateLocalInertia(btScalar(mass), inertia);
    btRigidBody::btRigidBodyConstructionInfo info(btScalar(mass), nullptr, shapes_.back().get(),
                                                  inertia);
    info.m_startWorldTransform = pose;
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    btRigidBody& body = *bodies_.back();
    body.setActivationState(DISABLE_DEACTIVATION);
    const int group = collides ? btBroadphaseProxy::DefaultFilter : 0;
    world_.addRigidBody(&body, group, group);
    return body;
  }

  // All bodies of a scene, by its indices.
  std::vector<btRigidBody*> add_bodies(const Scene& scene);

  // Constructs a joint in place from its constructor's arguments, and adds it.
  template <class Joint, class... Arguments>
  Joint& add_joint(Arguments&&... arguments) {
    return take_joint(std::make_unique<Joint>(std::forward<Arguments>(arguments)...));
  }
  // In the frames of a scene's joint.
  template <class Joint>
  Joint& add_joint_of(const scenes::Joint& from, const std::vector<btRigidBody*>& bodies);
  // Joins two bodies where they stand, in a frame of the world.
  template <class Joint, class... Arguments>
  Joint& join(btRigidBody& a, btRigidBody& b, const btTransform& frame, Arguments&&... more) {
    return add_joint<Joint>(a, b, a.getCenterOfMassTransform().inverse() * frame,
                            b.getCenterOfMassTransform().inverse() * frame,
                            std::forward<Arguments>(more)...);
  }
  template <class Joint>
  Joint& take_joint(std::unique_ptr<Joint> joint, bool bodies_collide = false) {
    Joint& reference = *joint;
    joints_.push_back(std::move(joint));
    world_.addConstraint(&reference, !bodies_collide);
    return reference;
  }

  // One step of exactly dt seconds: no substeps, no remainder carried to the next call.
  void step(double dt) {
    const auto before = std::chrono::steady_clock::now();
    world_.stepSimulation(btScalar(dt), 0);
    const auto after = std::chrono::steady_clock::now();
    microseconds_ += std::chrono::duration<double, std::micro>(after - before).count();
    ++steps_;
  }

  // Mean time of a step. The one number here that does not repeat: compare it only as a ratio to
  // another world that took turns with this one.
  double microseconds_per_step() const { return steps_ > 0 ? microseconds_ / steps_ : 0; }

  btDiscreteDynamicsWorld& bullet() { return world_; }

 private:
  // Bullet searches from the front, and puts its last one where one was: the first one, and then from the back, each is found at once.
  // (Not bodies that move, where the first one does not: of those Bullet has a list of their own.)
  template <class Those, class Remove>
  static void removeAll(const Those& those, const Remove& remove) {
    if (those.empty()) return;
    remove(*those.front());
    for (size_t i = those.size() - 1; i > 0; --i) remove(*those[i]);
  }

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  std::unique_ptr<btConstraintSolver> solver_;
  btDiscreteDynamicsWorld world_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
  double microseconds_ = 0;
  int steps_ = 0;
};

inline Eigen::Vector3d to_eigen(const btVector3& v) {
  return {double(v.x()), double(v.y()), double(v.z())};
}

inline btVector3 to_bullet(const Eigen::Vector3d& v) {
  return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())};
}

inline btMatrix3x3 matrix_to_bullet(const Eigen::Matrix3d& m) {
  btMatrix3x3 result;
  for (int i = 0; i < 3; ++i) result[i] = to_bullet(m.row(i).transpose());
  return result;
}

inline btTransform to_bullet(const Isometry3d& pose) {
  return btTransform(matrix_to_bullet(pose.linear()), to_bullet(pose.translation().eval()));
}

inline std::unique_ptr<btCollisionShape> make_shape(const Body& body) {
  const btVector3 half = to_bullet(body.half_extents);
  switch (body.form) {
    case Form::box: break;
    case Form::sphere: return std::make_unique<btSphereShape>(half.x());
    case Form::capsule: return std::make_unique<btCapsuleShapeZ>(half.x(), 2 * half.z());
    case Form::cylinder: return std::make_unique<btCylinderShapeZ>(half);
  }
  return std::make_unique<btBoxShape>(half);
}

inline std::vector<btRigidBody*> World::add_bodies(const Scene& scene) {
  std::vector<btRigidBody*> added;
  for (const Body& from : scene.bodies) {
    added.push_back(&add(from.mass, make_shape(from), to_bullet(from.pose), from.collides));
    btRigidBody& body = *added.back();
    body.setFriction(btScalar(from.friction));
    if (from.mass == 0) continue;
    body.setMassProps(btScalar(from.mass), to_bullet(from.inertia));
    body.updateInertiaTensor();
    body.setDamping(btScalar(from.damping), btScalar(from.damping));
    body.setLinearVelocity(to_bullet(from.velocity));
    body.setAngularVelocity(to_bullet(from.angular_velocity));
  }
  return added;
}

template <class Joint>
Joint& World::add_joint_of(const scenes::Joint& from, const std::vector<btRigidBody*>& bodies) {
  return add_joint<Joint>(*bodies[size_t(from.a)], *bodies[size_t(from.b)], to_bullet(from.in_a),
                          to_bullet(from.in_b));
}

inline btTransform pose_at(const btVector3& position) {
  return btTransform(btQuaternion::getIdentity(), position);
}

// A frame at a point, by its axes x and z.
inline btTransform frame_along(const Eigen::Vector3d& origin, const Eigen::Vector3d& x,
                               const Eigen::Vector3d& z) {
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  return btTransform(matrix_to_bullet(axes), to_bullet(origin));
}

inline Eigen::Vector3d position(const btRigidBody& body) {
  return to_eigen(body.getCenterOfMassPosition());
}

inline Eigen::Matrix3d rotation(const btRigidBody& body) {
  const btMatrix3x3& basis = body.getCenterOfMassTransform().getBasis();
  Eigen::Matrix3d r;
  for (int i = 0; i < 3; ++i) r.row(i) = to_eigen(basis[i]).transpose();
  return r;
}

// A point or a direction of the body's frame, in the world.
inline Eigen::Vector3d point_in_world(const btRigidBody& body, const Eigen::Vector3d& local) {
  return position(body) + rotation(body) * local;
}

inline Eigen::Vector3d direction_in_world(const btRigidBody& body, const Eigen::Vector3d& local) {
  return rotation(body) * local;
}

// Kinetic energy plus height energy above z = 0, J. Bullet steps velocities first (symplectic
// Euler), so even an ideal joint shows an error that is proportional to dt and to the speed.
inline double energy(const btRigidBody& body, double gravity) {
  const double mass = 1 / double(body.getInvMass());
  const Eigen::Vector3d v = to_eigen(body.getLinearVelocity());
  const Eigen::Vector3d w = rotation(body).transpose() * to_eigen(body.getAngularVelocity());
  const Eigen::Vector3d inertia = to_eigen(body.getLocalInertia());
  return 0.5 * mass * v.squaredNorm() + 0.5 * inertia.dot(w.cwiseProduct(w)) +
         mass * gravity * position(body).z();
}

}  // namespace scenes
