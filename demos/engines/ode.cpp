// The Open Dynamics Engine: its iterative solver, with the world's default ERP and CFM.

#include <ode/ode.h>

#include "peers.h"

namespace engines {
namespace {

using scenes::Isometry3d;
using scenes::Joint;
using scenes::Kind;
using scenes::Scene;
using scenes::Vector3d;

class OdeEngine : public Engine {
 public:
  OdeEngine(const Scene& scene, int iterations) : scene_(scene), world_(dWorldCreate()) {
    dWorldSetGravity(world_, 0, 0, -scene.gravity);
    dWorldSetQuickStepNumIterations(world_, iterations);
    for (const scenes::Body& body : scene.bodies) add(body);
    for (const Joint& joint : scene.joints) add(joint);
  }
  ~OdeEngine() override { dWorldDestroy(world_); }

  void drive(double time, double dt) override {
    for (size_t i = 0; i < joints_.size(); ++i) {
      const Joint& joint = scene_.joints[i];
      if (joint.motor.speed && joint.kind == Kind::slider) {
        dJointSetSliderParam(joints_[i], dParamVel, joint.motor.speed(time));
        dJointSetSliderParam(joints_[i], dParamFMax, joint.motor.max_torque);
      } else if (joint.motor.speed) {
        // ODE's angle is that of its first body against its second one.
        dJointSetHingeParam(joints_[i], dParamVel, joint.motor.speed(time));
        dJointSetHingeParam(joints_[i], dParamFMax, joint.motor.max_torque);
      }
      if (joint.spring.frequency > 0) {
        const double w = 2 * scenes::pi * joint.spring.frequency,
                     mass = reduced_mass(scene_, joint);
        const double k = mass * w * w, c = 2 * joint.spring.damping_ratio * mass * w;
        dJointSetSliderParam(joints_[i], dParamStopERP, dt * k / (dt * k + c));
        dJointSetSliderParam(joints_[i], dParamStopCFM, 1 / (dt * k + c));
      }
    }
  }
  void step(double dt) override { dWorldQuickStep(world_, dt); }
  State state(int index) const override {
    State state{scene_.bodies[size_t(index)].pose, Vector3d::Zero(), Vector3d::Zero()};
    const dBodyID body = bodies_[size_t(index)];
    if (body == nullptr) return state;
    const dReal* const R = dBodyGetRotation(body);  // rows of 4
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) state.pose.linear()(i, j) = R[4 * i + j];
      state.pose.translation()[i] = dBodyGetPosition(body)[i];
      state.velocity[i] = dBodyGetLinearVel(body)[i];
      state.angular_velocity[i] = dBodyGetAngularVel(body)[i];
    }
    return state;
  }

 private:
  void add(const scenes::Body& from) {
    if (from.mass == 0) return bodies_.push_back(nullptr);
    const dBodyID body = dBodyCreate(world_);
    dMass mass;
    dMassSetParameters(&mass, from.mass, 0, 0, 0, from.inertia.x(), from.inertia.y(),
                       from.inertia.z(), 0, 0, 0);
    dBodySetMass(body, &mass);
    const Vector3d x = from.pose.translation(), v = from.velocity, w = from.angular_velocity;
    const Eigen::Quaterniond q(from.pose.linear());
    const dQuaternion turn = {q.w(), q.x(), q.y(), q.z()};
    dBodySetPosition(body, x.x(), x.y(), x.z());
    dBodySetQuaternion(body, turn);
    dBodySetLinearVel(body, v.x(), v.y(), v.z());
    dBodySetAngularVel(body, w.x(), w.y(), w.z());
    bodies_.push_back(body);
  }

  void add(const Joint& from) {
    const Isometry3d frame_a = scene_.bodies[size_t(from.a)].pose * from.in_a,
                     frame_b = scene_.bodies[size_t(from.b)].pose * from.in_b;
    const Vector3d p = frame_a.translation();
    // b first: the ground may only come second, and angles are those of the first body.
    const dBodyID a = bodies_[size_t(from.a)], b = bodies_[size_t(from.b)];
    dJointID joint = nullptr;
    if (from.kind == Kind::ball) {
      joint = dJointCreateBall(world_, nullptr);
      dJointAttach(joint, b, a);
      dJointSetBallAnchor(joint, p.x(), p.y(), p.z());
    } else if (from.kind == Kind::hinge) {
      const Vector3d axis = frame_a.linear().col(2);
      joint = dJointCreateHinge(world_, nullptr);
      dJointAttach(joint, b, a);
      dJointSetHingeAnchor(joint, p.x(), p.y(), p.z());
      dJointSetHingeAxis(joint, axis.x(), axis.y(), axis.z());
      if (from.range.limited()) {
        dJointSetHingeParam(joint, dParamLoStop, from.range.low);
        dJointSetHingeParam(joint, dParamHiStop, from.range.high);
      }
    } else if (from.kind == Kind::slider) {
      const Vector3d axis = frame_a.linear().col(0);
      joint = dJointCreateSlider(world_, nullptr);
      dJointAttach(joint, b, a);
      dJointSetSliderAxis(joint, axis.x(), axis.y(), axis.z());
      if (from.spring.frequency > 0) {
        dJointSetSliderParam(joint, dParamLoStop, 0);
        dJointSetSliderParam(joint, dParamHiStop, 0);
      }
    } else if (from.kind == Kind::fixed) {
      joint = dJointCreateFixed(world_, nullptr);
      dJointAttach(joint, b, a);
      dJointSetFixed(joint);
    } else {
      const Vector3d axis_1 = frame_b.linear().col(1), axis_2 = frame_a.linear().col(2);
      joint = dJointCreateUniversal(world_, nullptr);
      dJointAttach(joint, b, a);
      dJointSetUniversalAnchor(joint, p.x(), p.y(), p.z());
      dJointSetUniversalAxis1(joint, axis_1.x(), axis_1.y(), axis_1.z());
      dJointSetUniversalAxis2(joint, axis_2.x(), axis_2.y(), axis_2.z());
    }
    joints_.push_back(joint);
  }

  const Scene& scene_;
  dWorldID world_;
  std::vector<dBodyID> bodies_;  // null: the ground
  std::vector<dJointID> joints_;
};

}  // namespace

std::unique_ptr<Engine> make_ode(const Scene& scene, int iterations) {
  static const bool ready = dInitODE2(0) != 0;
  if (!ready || !is_known(scene)) return nullptr;
  return std::make_unique<OdeEngine>(scene, iterations);
}

}  // namespace engines
