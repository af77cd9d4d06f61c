#include "joint_kinds.h"

#include <pintle/joints/ball_joint.h>
#include <pintle/joints/constant_velocity_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/universal_joint.h>

#include "support.h"

namespace kinds {
namespace {

using pintle::BallJoint;
using pintle::ConstantVelocityJoint;
using pintle::Formulation;
using pintle::QuaternionHinge;
using pintle::UniversalJoint;
using support::infinite;
using support::scalar;

// --- settings ------------------------------------------------------------------------------------

void set(BallJoint& ball, int variant) {
  if (variant == 1) ball.m_setting.m_impulseClamp = scalar(0.5);
  if (variant == 2) ball.m_setting.m_damping = scalar(0.5);
  if (variant == 3) ball.setParam(BT_CONSTRAINT_CFM, scalar(0.01));
}

void set(QuaternionHinge& hinge, int variant) {
  if (variant == 1) hinge.setLimit(scalar(-0.2), scalar(0.3));
  if (variant == 2) hinge.enableAngularMotor(true, 2, 10);
  if (variant == 3) {
    hinge.setLimit(scalar(0.1), scalar(0.1));
    hinge.setLimitSpring(3, scalar(0.5));
  }
  if (variant == 4) {
    hinge.setLimit(scalar(-0.2), scalar(0.3));
    hinge.setMotorServo(2, 30, 1, 100);
    hinge.setFriction(2);
  }
  if (variant == 5) {
    hinge.setAngularOnly(true);
    hinge.setLimit(scalar(-0.2), scalar(0.3));
    hinge.setFriction(2);
  }
}

void set(UniversalJoint& joint, int variant) {
  if (variant == 1) {
    joint.setLimit(4, 1, -1);
    joint.setLimit(5, 1, -1);
  }
  if (variant == 2) {
    joint.setLimit(4, scalar(-0.2), scalar(0.3));
    joint.setLimit(5, 0, 0);
  }
  if (variant == 3) {
    joint.setLimit(4, scalar(0.1), scalar(0.1));
    joint.setLimitSpring(4, 3, scalar(0.5));
    joint.setLimit(5, -10, 10);
    joint.enableMotor(5, true, 2, 10);
  }
  if (variant == 4) {
    joint.setMotorServo(4, 2, 30, 1, 100);
    joint.setFriction(4, 2);
    joint.setLimit(5, scalar(-0.2), scalar(0.3));
    joint.enableMotor(5, true, -3, infinite);
    joint.setLimitBounce(5, scalar(0.5));
  }
  if (variant == 5) {
    joint.setAngularOnly(true);
    joint.setFriction(5, 2);
  }
}

void set(ConstantVelocityJoint& joint, int variant) {
  if (variant == 1) joint.setBendLimit(scalar(0.3));
  if (variant == 2) joint.enableMotor(true, 3, 2);
  if (variant == 3) {
    joint.setBendLimit(scalar(0.2));
    joint.setBendLimitSpring(3, scalar(0.5));
    joint.setBendFriction(1);
  }
  if (variant == 4) {
    joint.setBendLimit(0);
    joint.setBendLimitBounce(scalar(0.5));
    joint.enableMotor(true, -2, infinite);
  }
  if (variant == 5) {
    joint.setAngularOnly(true);
    joint.setBendFriction(2);
  }
}

// --- the list ------------------------------------------------------------------------------------

template <class J>
void add(std::vector<Kind>& list, const char* name, int variants) {
  for (const Formulation form : {Formulation::conditioned, Formulation::document}) {
    list.push_back(
        {std::string(name) + (form == Formulation::document ? "Document" : ""), sizeof(J), variants,
         [form](btRigidBody& a, btRigidBody& b, const btTransform& frame_a,
                const btTransform& frame_b, int variant) {
           auto joint = std::make_unique<J>(a, b, frame_a, frame_b);
           joint->setFormulation(form);
           set(*joint, variant);
           return joint;
         },
         [](btRigidBody& a, const btTransform& frame_a) {
           return std::make_unique<J>(a, frame_a);
         }});
  }
}

}  // namespace

std::vector<Kind> all() {
  std::vector<Kind> list;
  add<QuaternionHinge>(list, "QuaternionHinge", 6);
  add<BallJoint>(list, "BallJoint", 4);
  add<UniversalJoint>(list, "UniversalJoint", 6);
  add<ConstantVelocityJoint>(list, "ConstantVelocityJoint", 6);
  return list;
}

}  // namespace kinds
