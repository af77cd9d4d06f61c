#include "joint_kinds.h"

#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/quaternion_hinge.h>

#include "support.h"

namespace kinds {
namespace {

using pintle::BallJoint;
using pintle::ConeTwistJoint;
using pintle::Formulation;
using pintle::QuaternionHinge;
using support::scalar;

// --- settings ------------------------------------------------------------------------------------

void set(BallJoint& ball, int variant) {
  if (variant == 1) ball.m_setting.m_impulseClamp = scalar(0.5);
  if (variant == 2) ball.m_setting.m_damping = scalar(0.5);
  if (variant == 3) ball.setParam(BT_CONSTRAINT_CFM, scalar(0.01));
}

// Where the frames that the test gave meet, these are apart: the cone has no direction in its middle.
btQuaternion turnFrame(ConeTwistJoint& joint, double x, double y, double z) {
  const btVector3 turn = support::vec(x, y, z);
  const btQuaternion q(turn.normalized(), turn.length());
  joint.setFrames(joint.getAFrame(), joint.getBFrame() * btTransform(q.inverse()));
  return q;
}

void set(ConeTwistJoint& joint, int variant) {
  if (variant == 1) {
    turnFrame(joint, 0.4, 0.9, 0.7);
    joint.setLimit(1, 1, scalar(0.3));
  }
  if (variant == 2) {
    turnFrame(joint, 0.4, 0.9, 0.7);
    joint.setLimit(1, scalar(1.5), scalar(0.3), scalar(0.8));
  }
  if (variant == 3) {
    turnFrame(joint, 0, 0, 0.7);
    joint.setLimit(scalar(0.6), scalar(0.02), 0);
    joint.setTwistLimitSpring(3, scalar(0.5));
  }
  if (variant == 4) {
    turnFrame(joint, 0.3, 0, 0);
    joint.setLimit(0, 0, scalar(0.2));
  }
  if (variant == 5) {
    turnFrame(joint, -0.4, 0.9, 0.7);
    joint.setSwingLimits(scalar(-0.1), scalar(0.8), 0, scalar(0.9));
    joint.setTwistLimit(scalar(0.1), scalar(0.3));
    joint.setSwingLimitSpring(3, scalar(0.5));
  }
  if (variant == 6) {
    joint.setMotorTargetInConstraintSpace(turnFrame(joint, 0.4, 0.9, 0.7));
    joint.setMaxMotorImpulseNormalized(3);
    joint.enableMotor(true);
  }
  if (variant == 7) {
    joint.setLimit(scalar(2.8), 3, scalar(0.5));
    joint.setMotorTargetInConstraintSpace(turnFrame(joint, 0.4, 0.9, 0.7));
    joint.setMaxMotorImpulse(3);
    joint.enableMotor(true);
    joint.setFriction(2);
  }
  if (variant == 8) {
    joint.setAngularOnly(true);
    joint.setLimit(0, scalar(0.1), scalar(0.1));
    joint.setFriction(2);
    joint.enableMotor(true);
  }
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
  add<ConeTwistJoint>(list, "ConeTwistJoint", 9);
  return list;
}

}  // namespace kinds
