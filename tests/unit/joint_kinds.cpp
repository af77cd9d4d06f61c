#include "joint_kinds.h"

#include <pintle/joints/ball_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>

#include "support.h"

namespace kinds {
namespace {

using pintle::BallJoint;
using pintle::Formulation;
using pintle::QuaternionHinge;
using pintle::SliderJoint;
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

void set(SliderJoint& slider, int variant) {
  if (variant == 1) {  // free to turn, on a stretch
    slider.setLowerAngLimit(1);
    slider.setUpperAngLimit(-1);
    slider.setLowerLinLimit(scalar(-0.2));
    slider.setUpperLinLimit(scalar(0.3));
  }
  if (variant == 2) {
    slider.setTargetLinMotorVelocity(2);
    slider.setMaxLinMotorForce(100);
    slider.setPoweredLinMotor(true);
    slider.setLowerAngLimit(scalar(-0.2));
    slider.setUpperAngLimit(scalar(0.3));
    slider.setTargetAngMotorVelocity(2);
    slider.setMaxAngMotorForce(10);
    slider.setPoweredAngMotor(true);
  }
  if (variant == 3) {  // locked
    slider.setLowerLinLimit(scalar(0.1));
    slider.setUpperLinLimit(scalar(0.1));
    slider.setLowerAngLimit(scalar(0.1));
    slider.setUpperAngLimit(scalar(0.1));
    slider.setAngLimitSpring(3, scalar(0.5));
  }
  if (variant == 4) {
    slider.setLowerLinLimit(scalar(-0.2));
    slider.setUpperLinLimit(scalar(0.3));
    slider.setLinLimitSpring(3, scalar(0.5));
    slider.setLinMotorServo(1, 10, 1, 100);
    slider.setLinFriction(2);
    slider.setUpperAngLimit(4);
    slider.setAngMotorServo(1, 10, 1, 100);
    slider.setAngFriction(2);
  }
  if (variant == 5) {
    slider.setAngularOnly(true);
    slider.setUpperAngLimit(scalar(0.3));
    slider.setAngFriction(2);
    slider.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.4), 4);
    slider.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.01), 4);
  }
}

// --- the list ------------------------------------------------------------------------------------

template <class J>
void add(std::vector<Kind>& list, const char* name, int variants, const char* free_body = "A") {
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
         },
         free_body});
  }
}

}  // namespace

std::vector<Kind> all() {
  std::vector<Kind> list;
  add<QuaternionHinge>(list, "QuaternionHinge", 6);
  add<BallJoint>(list, "BallJoint", 4);
  add<SliderJoint>(list, "SliderJoint", 6, "B");
  return list;
}

}  // namespace kinds
