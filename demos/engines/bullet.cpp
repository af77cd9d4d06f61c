#include "bullet.h"

namespace engines {

using scenes::Scene;

BulletEngine::BulletEngine(const Scene& scene, int iterations,
                           const scenes::SolverFactory& make_solver)
    : world_(scene.gravity, iterations, make_solver), bodies_(world_.add_bodies(scene)) {
  for (size_t i = 0; i < bodies_.size(); ++i) {
    const scenes::Vector3d& torque = scene.bodies[i].torque;
    if (!torque.isZero()) pushes_.push_back({bodies_[i], scenes::to_bullet(torque)});
  }
}

bool BulletEngine::add(const scenes::Joint& from, MakeJoint make_joint) {
  BulletJoint joint = make_joint(from, body(from.a), body(from.b));
  if (!joint.constraint) return false;
  if (from.breaks_at > 0) joint.constraint->setBreakingImpulseThreshold(btScalar(from.breaks_at));
  if (joint.drive) motors_.push_back({from.motor.speed, joint.drive});
  // What a joint keeps from colliding stays so when it breaks.
  joints_.push_back(&world_.take_joint(std::move(joint.constraint), from.breaks_at > 0));
  return true;
}

void BulletEngine::drive(double time, double dt) {
  for (const Motor& motor : motors_) motor.set(motor.speed ? motor.speed(time) : 0, dt);
  for (const Push& push : pushes_) push.body->applyTorque(push.torque);
}

State BulletEngine::state(int index) const {
  const btRigidBody& body = *bodies_[size_t(index)];
  State state;
  state.pose.setIdentity();
  state.pose.linear() = scenes::rotation(body);
  state.pose.translation() = scenes::position(body);
  state.velocity = scenes::to_eigen(body.getLinearVelocity());
  state.angular_velocity = scenes::to_eigen(body.getAngularVelocity());
  return state;
}

int BulletEngine::rows() const {
  int sum = 0;
  for (btTypedConstraint* joint : joints_) {
    btTypedConstraint::btConstraintInfo1 info;
    joint->buildJacobian();
    joint->getInfo1(&info);
    sum += info.m_numConstraintRows;
  }
  return sum;
}

std::unique_ptr<BulletEngine> make_bullet(const Scene& scene, int iterations, MakeJoint make_joint,
                                          const scenes::SolverFactory& make_solver) {
  auto engine = std::make_unique<BulletEngine>(scene, iterations, make_solver);
  for (const scenes::Joint& joint : scene.joints) {
    if (!engine->add(joint, make_joint)) return nullptr;
  }
  return engine;
}

const char* precision() { return sizeof(btScalar) == sizeof(double) ? "double" : "single"; }

}  // namespace engines
