// What joints do to their bodies, stock ones and Pintle's alike: by the impulses that Bullet's feedback tells of.

#pragma once

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <vector>

namespace measures {

// An impulse p on a body that moves at v before and at v' after a step has given it p . (v + v') / 2, exactly.
class JointWork {
 public:
  // Asks all joints that the world has for feedback.
  explicit JointWork(btDiscreteDynamicsWorld& world)
      : feedback_(size_t(world.getNumConstraints())) {
    for (int i = 0; i < world.getNumConstraints(); ++i) {
      btTypedConstraint* joint = world.getConstraint(i);
      joint->enableFeedback(true);
      joint->setJointFeedback(&feedback_[size_t(i)]);
      joints_.push_back(joint);
    }
    before_.resize(joints_.size());
  }
  ~JointWork() {
    for (btTypedConstraint* joint : joints_) {
      joint->enableFeedback(false);
      joint->setJointFeedback(nullptr);
    }
  }
  JointWork(const JointWork&) = delete;
  JointWork& operator=(const JointWork&) = delete;

  void beginStep() {
    for (size_t i = 0; i < joints_.size(); ++i)
      before_[i] = {of(joints_[i]->getRigidBodyA()), of(joints_[i]->getRigidBodyB())};
  }
  // J, of all joints in a step that has taken dt.
  double endStep(double dt) const {
    double sum = 0;
    for (size_t i = 0; i < joints_.size(); ++i) {
      const btJointFeedback& f = feedback_[i];
      sum += work(joints_[i]->getRigidBodyA(), before_[i].a, f.m_appliedForceBodyA,
                  f.m_appliedTorqueBodyA) +
             work(joints_[i]->getRigidBodyB(), before_[i].b, f.m_appliedForceBodyB,
                  f.m_appliedTorqueBodyB);
    }
    return dt / 2 * sum;
  }

 private:
  struct Velocity {
    btVector3 v, w;
  };
  struct Velocities {
    Velocity a, b;
  };
  static Velocity of(const btRigidBody& body) {
    return {body.getLinearVelocity(), body.getAngularVelocity()};
  }
  static double work(const btRigidBody& body, const Velocity& before, const btVector3& force,
                     const btVector3& torque) {
    if (body.getInvMass() == 0) return 0;
    return double(force.dot(before.v + body.getLinearVelocity()) +
                  torque.dot(before.w + body.getAngularVelocity()));
  }

  std::vector<btTypedConstraint*> joints_;
  std::vector<btJointFeedback> feedback_;
  std::vector<Velocities> before_;
};

}  // namespace measures
