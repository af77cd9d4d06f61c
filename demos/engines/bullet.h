// Scenes in Bullet's world of rigid bodies.

#pragma once

#include "../scenes/world.h"
#include "engine.h"

namespace engines {

struct BulletJoint {
  std::unique_ptr<btTypedConstraint> constraint;
  // Before each step: sets a motor's speed (rad/s, m/s; 0: the scene has none). Empty: nothing to set.
  std::function<void(double speed, double dt)> drive = {};
};

inline btQuaternion turn_to_bullet(const Eigen::Quaterniond& q) {
  return {btScalar(q.x()), btScalar(q.y()), btScalar(q.z()), btScalar(q.w())};
}

// Makes the joint of a kind, with its limits, spring and motor; null: there is none.
using MakeJoint = BulletJoint (*)(const scenes::Joint&, btRigidBody& a, btRigidBody& b);

BulletJoint make_stock_joint(const scenes::Joint&, btRigidBody& a, btRigidBody& b);
BulletJoint make_document_joint(const scenes::Joint&, btRigidBody& a, btRigidBody& b);
BulletJoint make_conditioned_joint(const scenes::Joint&, btRigidBody& a, btRigidBody& b);

class BulletEngine : public Engine {
 public:
  // The scene's bodies; its joints are added one by one.
  BulletEngine(const scenes::Scene& scene, int iterations,
               const scenes::SolverFactory& make_solver = {});
  // False: there is no such joint.
  bool add(const scenes::Joint& joint, MakeJoint make_joint);

  void drive(double time, double dt) override;
  void step(double dt) override { world_.step(dt); }
  State state(int body) const override;
  int rows() const override;
  bool broken(int joint) const override { return !joints_[size_t(joint)]->isEnabled(); }
  btDynamicsWorld* bullet_world() override { return &world_.bullet(); }

  btDiscreteDynamicsWorld& world() { return world_.bullet(); }
  btRigidBody& body(int index) { return *bodies_[size_t(index)]; }
  btTypedConstraint& joint(int index) { return *joints_[size_t(index)]; }

 private:
  struct Motor {
    std::function<double(double time)> speed;
    std::function<void(double speed, double dt)> set;
  };
  struct Push {
    btRigidBody* body;
    btVector3 torque;
  };

  scenes::World world_;
  std::vector<btRigidBody*> bodies_;
  std::vector<btTypedConstraint*> joints_;
  std::vector<Motor> motors_;
  std::vector<Push> pushes_;
};

// Null: the scene has a joint that there is none of.
std::unique_ptr<BulletEngine> make_bullet(const scenes::Scene& scene, int iterations,
                                          MakeJoint make_joint,
                                          const scenes::SolverFactory& make_solver = {});

}  // namespace engines
