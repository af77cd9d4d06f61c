// Pintle's joint of each kind.

#include <pintle/joints/angular_limit.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/constant_velocity_joint.h>
#include <pintle/joints/contact_joint.h>
#include <pintle/joints/distance_joint.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/gear_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/universal_joint.h>
#include <pintle/joints/wedge_joint.h>

#include "bullet.h"

namespace engines {
namespace {

using scenes::Joint;
using scenes::Kind;
using scenes::to_bullet;

BulletJoint hinge(const Joint& joint, btRigidBody& a, btRigidBody& b, const btTransform& in_a,
                  const btTransform& in_b) {
  auto hinge = std::make_unique<pintle::QuaternionHinge>(a, b, in_a, in_b, true);
  if (joint.range.limited()) hinge->setLimit(btScalar(joint.range.low), btScalar(joint.range.high));
  if (joint.spring.frequency > 0)
    hinge->setLimitSpring(btScalar(joint.spring.frequency), btScalar(joint.spring.damping_ratio));
  if (!joint.motor.speed) return {std::move(hinge)};
  pintle::QuaternionHinge* const driven = hinge.get();
  return {std::move(hinge), [driven, torque = joint.motor.max_torque](double speed, double dt) {
            driven->enableAngularMotor(true, btScalar(speed), btScalar(torque * dt));
          }};
}

BulletJoint slider(const Joint& joint, btRigidBody& a, btRigidBody& b, const btTransform& in_a,
                   const btTransform& in_b) {
  auto slider = std::make_unique<pintle::SliderJoint>(a, b, in_a, in_b, true);
  if (joint.range.limited()) {
    slider->setLowerLinLimit(btScalar(joint.range.low));
    slider->setUpperLinLimit(btScalar(joint.range.high));
  }
  if (joint.restitution > 0) slider->setDampingLimLin(btScalar(1 - joint.restitution));
  if (joint.spring.frequency > 0) {
    slider->setLinMotorServo(0, btScalar(joint.spring.frequency),
                             btScalar(joint.spring.damping_ratio), SIMD_INFINITY);
  }
  if (!joint.motor.speed) return {std::move(slider)};
  slider->setMaxLinMotorForce(btScalar(joint.motor.max_torque));
  pintle::SliderJoint* const driven = slider.get();
  return {std::move(slider), [driven](double speed, double) {
            driven->setPoweredLinMotor(true);
            driven->setTargetLinMotorVelocity(btScalar(speed));
          }};
}

BulletJoint universal(const Joint& joint, btRigidBody& a, btRigidBody& b, const btTransform& in_a,
                      const btTransform& in_b) {
  auto universal = std::make_unique<pintle::UniversalJoint>(a, b, in_a, in_b);
  if (joint.range.limited())
    universal->setLimit(4, btScalar(joint.range.low), btScalar(joint.range.high));
  return {std::move(universal)};
}

BulletJoint cone_twist(const Joint& joint, btRigidBody& a, btRigidBody& b, const btTransform& in_a,
                       const btTransform& in_b) {
  auto shoulder = std::make_unique<pintle::ConeTwistJoint>(b, a, in_b, in_a);  // the limb is first
  shoulder->setLimit(btScalar(joint.spans.about_z), btScalar(joint.spans.about_y),
                     btScalar(joint.spans.twist));
  if (const scenes::Muscle& muscle = joint.muscle; muscle.stiffness > 0)
    shoulder->setPoseDrive(
        turn_to_bullet(muscle.pose.conjugate()),
        pintle::PoseDrive::fromStiffness(btScalar(muscle.stiffness), btScalar(muscle.damping),
                                         btScalar(muscle.max_torque)));
  return {std::move(shoulder)};
}

BulletJoint shafts(const Joint& joint, btRigidBody& a, btRigidBody& b, const btTransform& in_a,
                   const btTransform& in_b) {
  auto shafts = std::make_unique<pintle::ConstantVelocityJoint>(a, b, in_a, in_b);
  if (joint.range.limited()) shafts->setBendLimit(btScalar(joint.range.high));
  return {std::move(shafts)};
}

BulletJoint wedge(const Joint& joint, btRigidBody& a, btRigidBody& b, const btTransform& in_a,
                  const btTransform& in_b) {
  auto wedge = std::make_unique<pintle::WedgeJoint>(a, b, in_a, in_b);
  if (joint.range.limited()) wedge->setLimit(btScalar(joint.range.low), btScalar(joint.range.high));
  return {std::move(wedge)};
}

BulletJoint angle(const Joint& joint, btRigidBody& a, btRigidBody& b, const btTransform& in_a,
                  const btTransform& in_b) {
  auto angle = std::make_unique<pintle::AngularLimit>(a, b, in_a, in_b);
  angle->setLimit(btScalar(joint.range.low), btScalar(joint.range.high));
  return {std::move(angle)};
}

BulletJoint distance(const Joint& joint, btRigidBody& a, btRigidBody& b, const btTransform& in_a,
                     const btTransform& in_b) {
  auto distance = std::make_unique<pintle::DistanceJoint>(a, b, in_a, in_b);
  distance->setLimit(btScalar(joint.range.low), btScalar(joint.range.high));
  if (joint.spring.frequency == 0) return {std::move(distance)};
  // The joint's spring is that of bodies that can turn, by which the same stiffness and damping are
  // another frequency and ratio, step by step.
  const auto set = [strut = distance.get(), &a, &b, in_a, in_b, spring = joint.spring] {
    const btVector3 at_a = a.getCenterOfMassTransform() * in_a.getOrigin(),
                    at_b = b.getCenterOfMassTransform() * in_b.getOrigin(),
                    along = (at_b - at_a).normalized();
    const btScalar mobility =
        a.computeImpulseDenominator(at_a, along) + b.computeImpulseDenominator(at_b, along);
    const double stretch = std::sqrt(double(mobility / (a.getInvMass() + b.getInvMass())));
    strut->setLimitSpring(btScalar(spring.frequency * stretch),
                          btScalar(spring.damping_ratio * stretch));
  };
  set();
  return {std::move(distance), [set](double, double) { set(); }};
}

BulletJoint contact(const Joint& joint, btRigidBody& a, btRigidBody& b, const btTransform& in_a,
                    const btTransform& in_b) {
  auto contact = std::make_unique<pintle::ContactJoint>(a, b, in_a, in_b);
  contact->setRestitution(btScalar(joint.restitution));
  return {std::move(contact)};
}

BulletJoint make_joint(const Joint& joint, btRigidBody& a, btRigidBody& b) {
  const btTransform in_a = to_bullet(joint.in_a), in_b = to_bullet(joint.in_b);
  switch (joint.kind) {
    case Kind::ball: return {std::make_unique<pintle::BallJoint>(a, b, in_a, in_b)};
    case Kind::hinge: return hinge(joint, a, b, in_a, in_b);
    case Kind::slider: return slider(joint, a, b, in_a, in_b);
    case Kind::fixed: return {std::make_unique<pintle::FixedJoint>(a, b, in_a, in_b)};
    case Kind::cone_twist: return cone_twist(joint, a, b, in_a, in_b);
    case Kind::universal: return universal(joint, a, b, in_a, in_b);
    case Kind::constant_velocity: return shafts(joint, a, b, in_a, in_b);
    case Kind::wedge: return wedge(joint, a, b, in_a, in_b);
    case Kind::angle: return angle(joint, a, b, in_a, in_b);
    case Kind::distance: return distance(joint, a, b, in_a, in_b);
    case Kind::contact: return contact(joint, a, b, in_a, in_b);
    case Kind::gear:
      return {std::make_unique<pintle::GearJoint>(
          a, b, in_a.getBasis().getColumn(2), in_b.getBasis().getColumn(2), btScalar(joint.ratio))};
  }
  return {};
}

}  // namespace

BulletJoint make_conditioned_joint(const Joint& joint, btRigidBody& a, btRigidBody& b) {
  return make_joint(joint, a, b);
}

BulletJoint make_document_joint(const Joint& joint, btRigidBody& a, btRigidBody& b) {
  BulletJoint made = make_joint(joint, a, b);
  if (auto* const own = dynamic_cast<pintle::Joint*>(made.constraint.get()))
    own->setFormulation(pintle::Formulation::document);
  return made;
}

}  // namespace engines
