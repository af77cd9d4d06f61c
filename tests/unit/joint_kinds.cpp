#include "joint_kinds.h"

#include <pintle/joints/angular_limit.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/contact_joint.h>
#include <pintle/joints/distance_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/wedge_joint.h>

#include "support.h"

namespace kinds {
namespace {

using pintle::AngularLimit;
using pintle::BallJoint;
using pintle::ContactJoint;
using pintle::DistanceJoint;
using pintle::Formulation;
using pintle::QuaternionHinge;
using pintle::WedgeJoint;
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

void set(DistanceJoint& rod, int variant) {
  if (variant == 1) rod.setLimitSpring(3, scalar(0.5));
  if (variant == 2) rod.setLimit(0, scalar(2.5));
  if (variant == 3) {
    rod.setLimit(3, support::infinite);
    rod.enableMotor(true, 1, 10);
  }
  if (variant == 4) {
    rod.setLimit(1, 2);
    rod.setMotorServo(scalar(1.6), 3, 1, 100);
    rod.setFriction(2);
  }
}

void set(ContactJoint& contact, int variant) {
  if (variant == 1) contact.setTwoSided(true);
  if (variant == 2) contact.setRestitution(scalar(0.5));
  if (variant == 3) {
    contact.setTwoSided(true);
    contact.setLimitSpring(3, scalar(0.5));
  }
}

void set(WedgeJoint& wedge, int variant) {
  if (variant == 1) wedge.setLimit(scalar(-0.2), scalar(0.3));
  if (variant == 2) wedge.setLimit(-2, scalar(2.5));
  if (variant == 3) {
    wedge.setLimit(scalar(0.1), scalar(0.1));
    wedge.setLimitSpring(3, scalar(0.5));
  }
  if (variant == 4) {
    wedge.setLimit(1, scalar(2.5));
    wedge.setFriction(2);
  }
  if (variant == 5) {
    wedge.setAngularOnly(true);
    wedge.setLimit(scalar(-0.2), scalar(0.3));
    wedge.setFriction(2);
  }
}

void set(AngularLimit& limit, int variant) {
  if (variant == 1) limit.setLimit(scalar(-0.2), scalar(0.3));
  if (variant == 2) limit.enableAngularMotor(true, 2, 10);
  if (variant == 3) {
    limit.setLimit(scalar(0.1), scalar(0.1));
    limit.setLimitSpring(3, scalar(0.5));
  }
  if (variant == 4) {
    limit.setLimit(scalar(-0.2), scalar(0.3));
    // There is no lever to slow it down: 5 Hz over half a radian is 6 rad/s.
    limit.setMotorServo(scalar(0.5), 5, 1, 100);
    limit.setFriction(2);
  }
}

// Not of points that coincide, whose distance has no derivative: its own tests see to them.
template <class J>
btTransform placed(const btTransform& frame_b) {
  return frame_b;
}
template <>
btTransform placed<DistanceJoint>(const btTransform& frame_b) {
  return btTransform(frame_b.getBasis(), frame_b.getOrigin() + support::vec(2, 1, 1));
}

// --- the list ------------------------------------------------------------------------------------

template <class J>
void add(std::vector<Kind>& list, const char* name, int variants, bool holds = true) {
  for (const Formulation form : {Formulation::conditioned, Formulation::document}) {
    list.push_back(
        {std::string(name) + (form == Formulation::document ? "Document" : ""), sizeof(J), variants,
         holds,
         [form](btRigidBody& a, btRigidBody& b, const btTransform& frame_a,
                const btTransform& frame_b, int variant) {
           auto joint = std::make_unique<J>(a, b, frame_a, placed<J>(frame_b));
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
  add<DistanceJoint>(list, "DistanceJoint", 5, false);
  add<ContactJoint>(list, "ContactJoint", 4, false);
  add<WedgeJoint>(list, "WedgeJoint", 6);
  add<AngularLimit>(list, "AngularLimit", 5, false);
  return list;
}

}  // namespace kinds
