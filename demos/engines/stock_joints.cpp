// Bullet's own joint of each kind; where it has none, the one that a user would take in its place.

#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btGearConstraint.h>
#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <BulletDynamics/ConstraintSolver/btUniversalConstraint.h>

#include "bullet.h"

namespace engines {
namespace {

using scenes::Joint;
using scenes::Kind;
using scenes::to_bullet;

BulletJoint hinge(const Joint& joint, btRigidBody& a, btRigidBody& b, const btTransform& in_a,
                  const btTransform& in_b) {
  auto hinge = std::make_unique<btHingeConstraint>(a, b, in_a, in_b, true);
  if (joint.range.limited()) hinge->setLimit(btScalar(joint.range.low), btScalar(joint.range.high));
  if (!joint.motor.speed) return {std::move(hinge)};
  btHingeConstraint* const driven = hinge.get();
  return {std::move(hinge), [driven, torque = joint.motor.max_torque](double speed, double dt) {
            driven->enableAngularMotor(true, btScalar(speed), btScalar(torque * dt));
          }};
}

BulletJoint slider(const Joint& joint, btRigidBody& a, btRigidBody& b, const btTransform& in_a,
                   const btTransform& in_b) {
  if (joint.spring.frequency == 0) {
    auto slider = std::make_unique<btSliderConstraint>(a, b, in_a, in_b, true);
    if (joint.range.limited()) {
      slider->setLowerLinLimit(btScalar(joint.range.low));
      slider->setUpperLinLimit(btScalar(joint.range.high));
    }
    if (joint.restitution > 0) slider->setDampingLimLin(btScalar(1 - joint.restitution));
    if (!joint.motor.speed) return {std::move(slider)};
    slider->setMaxLinMotorForce(btScalar(joint.motor.max_torque));
    btSliderConstraint* const driven = slider.get();
    return {std::move(slider), [driven](double speed, double) {
              driven->setPoweredLinMotor(true);
              driven->setTargetLinMotorVelocity(btScalar(speed));
            }};
  }
  // btSliderConstraint has no spring.
  const double mass = 1 / double(a.getInvMass() + b.getInvMass());
  const double w = 2 * scenes::pi * joint.spring.frequency;
  auto slider = std::make_unique<btGeneric6DofSpring2Constraint>(a, b, in_a, in_b);
  slider->setLinearLowerLimit(btVector3(1, 0, 0));
  slider->setLinearUpperLimit(btVector3(-1, 0, 0));
  slider->setAngularLowerLimit(btVector3(0, 0, 0));
  slider->setAngularUpperLimit(btVector3(0, 0, 0));
  slider->enableSpring(0, true);
  slider->setStiffness(0, btScalar(mass * w * w));
  slider->setDamping(0, btScalar(2 * joint.spring.damping_ratio * mass * w));
  slider->setEquilibriumPoint(0, 0);
  return {std::move(slider)};
}

BulletJoint cone_twist(const Joint& joint, btRigidBody& a, btRigidBody& b, const btTransform& in_a,
                       const btTransform& in_b) {
  auto shoulder = std::make_unique<btConeTwistConstraint>(b, a, in_b, in_a);  // the limb is first
  shoulder->setLimit(btScalar(joint.spans.about_z), btScalar(joint.spans.about_y),
                     btScalar(joint.spans.twist));
  if (!(joint.muscle.stiffness > 0)) return {std::move(shoulder)};
  shoulder->enableMotor(true);
  shoulder->setMotorTargetInConstraintSpace(turn_to_bullet(joint.muscle.pose));
  btConeTwistConstraint* const driven = shoulder.get();
  return {std::move(shoulder), [driven, torque = joint.muscle.max_torque](double, double dt) {
            driven->setMaxMotorImpulse(btScalar(torque * dt));
          }};
}

// Also for a constant velocity joint, which Bullet does not have.
BulletJoint universal(const Joint& joint, btRigidBody& a, btRigidBody& b, const btTransform& in_a,
                      const btTransform& in_b) {
  const btTransform frame_a = a.getCenterOfMassTransform() * in_a,
                    frame_b = b.getCenterOfMassTransform() * in_b;
  auto universal = std::make_unique<btUniversalConstraint>(
      a, b, frame_a.getOrigin(), frame_a.getBasis().getColumn(2), frame_b.getBasis().getColumn(1));
  if (joint.range.limited() && joint.kind == Kind::constant_velocity) {
    // Each angle alone: a bend about both goes further.
    for (const int axis : {4, 5})
      universal->setLimit(axis, btScalar(-joint.range.high), btScalar(joint.range.high));
  } else if (joint.range.limited()) {
    universal->setLimit(4, btScalar(joint.range.low), btScalar(joint.range.high));
  }
  return {std::move(universal)};
}

// Its first angle, about z, is limited: singular where the direction nears the axis.
BulletJoint wedge(const Joint& joint, btRigidBody& a, btRigidBody& b, const btTransform& in_a,
                  const btTransform& in_b) {
  auto wedge = std::make_unique<btGeneric6DofSpring2Constraint>(a, b, in_a, in_b, RO_ZYX);
  wedge->setLinearLowerLimit(btVector3(0, 0, 0));
  wedge->setLinearUpperLimit(btVector3(0, 0, 0));
  wedge->setAngularLowerLimit(btVector3(1, 1, btScalar(joint.range.low)));  // x and y are free
  wedge->setAngularUpperLimit(btVector3(-1, -1, btScalar(joint.range.high)));
  return {std::move(wedge)};
}

}  // namespace

BulletJoint make_stock_joint(const Joint& joint, btRigidBody& a, btRigidBody& b) {
  const btTransform in_a = to_bullet(joint.in_a), in_b = to_bullet(joint.in_b);
  switch (joint.kind) {
    case Kind::ball:
      return {std::make_unique<btPoint2PointConstraint>(a, b, in_a.getOrigin(), in_b.getOrigin())};
    case Kind::hinge: return hinge(joint, a, b, in_a, in_b);
    case Kind::slider: return slider(joint, a, b, in_a, in_b);
    case Kind::fixed: return {std::make_unique<btFixedConstraint>(a, b, in_a, in_b)};
    case Kind::cone_twist: return cone_twist(joint, a, b, in_a, in_b);
    case Kind::universal:
    case Kind::constant_velocity: return universal(joint, a, b, in_a, in_b);
    case Kind::wedge: return wedge(joint, a, b, in_a, in_b);
    case Kind::gear:
      return {std::make_unique<btGearConstraint>(
          a, b, in_a.getBasis().getColumn(2), in_b.getBasis().getColumn(2), btScalar(joint.ratio))};
    case Kind::angle:
    case Kind::distance:
    case Kind::contact: break;
  }
  return {};
}

}  // namespace engines
