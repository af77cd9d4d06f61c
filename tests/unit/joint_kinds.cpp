#include "joint_kinds.h"

#include <pintle/joints/ball_joint.h>
#include <pintle/joints/dot_hinge.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/two_point_hinge.h>
#include <pintle/joints/unstable/cross_product_hinge.h>
#include <pintle/joints/unstable/cross_product_matrix_hinge.h>
#include <pintle/joints/unstable/single_row_lock.h>

#include "support.h"

namespace kinds {
namespace {

using pintle::BallJoint;
using pintle::Formulation;
using pintle::FrameJoint;
using pintle::HingeBase;
using pintle::TwoPointHinge;
using support::scalar;

// --- settings ------------------------------------------------------------------------------------

void set(BallJoint& ball, int variant) {
  if (variant == 1) ball.m_setting.m_impulseClamp = scalar(0.5);
  if (variant == 2) ball.m_setting.m_damping = scalar(0.5);
  if (variant == 3) ball.setParam(BT_CONSTRAINT_CFM, scalar(0.01));
}

void set(FrameJoint& joint, int variant) {
  if (variant == 1) joint.setAngularOnly(true);
  if (variant == 2) joint.setParam(BT_CONSTRAINT_CFM, scalar(0.01));
}

void set(HingeBase& hinge, int variant) {
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

void set(TwoPointHinge& hinge, int variant) {
  if (variant < 6) set(static_cast<HingeBase&>(hinge), variant);
  if (variant == 6) hinge.setPlacement(TwoPointHinge::Placement::about_anchor, 2);
  if (variant == 7) hinge.setPlacement(TwoPointHinge::Placement::from_nearest_b, scalar(0.3));
  if (variant == 8) {
    hinge.setSixRows(true);
    hinge.setLimit(scalar(-0.2), scalar(0.3));
  }
}

// --- the list ------------------------------------------------------------------------------------

template <class J>
void add(std::vector<Kind>& list, const char* name, int variants, const char* blows_up = "") {
  for (const Formulation form : {Formulation::conditioned, Formulation::document}) {
    list.push_back(
        {std::string(name) + (form == Formulation::document ? "Document" : ""), sizeof(J), variants, blows_up,
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
  add<pintle::QuaternionHinge>(list, "QuaternionHinge", 6);
  add<BallJoint>(list, "BallJoint", 4);
  add<pintle::FixedJoint>(list, "FixedJoint", 3);
  add<pintle::DotHinge>(list, "DotHinge", 6);
  add<TwoPointHinge>(list, "TwoPointHinge", 9);
  add<pintle::CrossProductHinge>(list, "CrossProductHinge", 3);
  add<pintle::CrossProductMatrixHinge>(list, "CrossProductMatrixHinge", 3,
                                       "three rows for two freedoms ask for what the plane forbids");
  add<pintle::SingleRowLock>(list, "SingleRowLock", 3);
  return list;
}

}  // namespace kinds
