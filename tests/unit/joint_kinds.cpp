#include "joint_kinds.h"

#include <pintle/joints/angular_limit.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/constant_velocity_joint.h>
#include <pintle/joints/contact_joint.h>
#include <pintle/joints/distance_joint.h>
#include <pintle/joints/dot_hinge.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/gear_joint.h>
#include <pintle/joints/generic_6dof_joint.h>
#include <pintle/joints/generic_6dof_spring_2_joint.h>
#include <pintle/joints/generic_6dof_spring_joint.h>
#include <pintle/joints/hinge_2_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/two_point_hinge.h>
#include <pintle/joints/universal_joint.h>
#include <pintle/joints/unstable/cross_product_hinge.h>
#include <pintle/joints/unstable/cross_product_matrix_hinge.h>
#include <pintle/joints/unstable/single_row_lock.h>
#include <pintle/joints/wedge_joint.h>

#include "support.h"

namespace kinds {
namespace {

using pintle::AngularLimit;
using pintle::BallJoint;
using pintle::ConeTwistJoint;
using pintle::ConstantVelocityJoint;
using pintle::ContactJoint;
using pintle::DistanceJoint;
using pintle::Formulation;
using pintle::FrameJoint;
using pintle::HingeBase;
using pintle::QuaternionHinge;
using pintle::SliderJoint;
using pintle::TwoPointHinge;
using pintle::UniversalJoint;
using pintle::WedgeJoint;
using support::infinite;
using support::scalar;

// --- settings ------------------------------------------------------------------------------------

void set(BallJoint& ball, int variant) {
  if (variant == 1) ball.m_setting.m_impulseClamp = scalar(0.5);
  if (variant == 2) ball.m_setting.m_damping = scalar(0.5);
  if (variant == 3) ball.setParam(BT_CONSTRAINT_CFM, scalar(0.01));
}

void set(FrameJoint& joint, int variant) {
  if (variant == 1) joint.setAngularOnly(true);
  if (variant == 2) {
    joint.setParam(BT_CONSTRAINT_CFM, scalar(0.01));
    joint.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.01), 0);  // which some have in its place
  }
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
  if (variant == 6) {
    joint.setBendLimit(scalar(0.3));
    joint.enableBendMotor(true, 1, 5);
    joint.setMotorServo(1, 5, 1, 10);
    joint.setFriction(1);
  }
  if (variant == 7) joint.setBendServo(scalar(0.4), 5, 1, 10);
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

// A lock, a hinge, universal joints, boxes, and axes locked at values that are not 0. Each has an axis that is locked.
template <class J>
void setAxes(J& joint, int variant) {
  const auto set = [&](int axis, double low, double high) {
    joint.setLimit(axis, scalar(low), scalar(high));
  };
  if (variant == 1)
    for (int i = 3; i < 6; ++i) set(i, 0, 0);
  if (variant == 2) {
    set(0, -0.2, 0.3);
    set(3, 0, 0);
    set(4, -0.2, 0.3);
    set(5, 0, 0);
  }
  if (variant == 3) {
    set(0, 1, -1);
    set(2, -0.2, 0.3);
    set(3, 0, 0);
    set(4, -0.2, 0.3);
    set(5, -0.3, 0.2);
  }
  if (variant == 4) {
    set(0, 0.1, 0.1);
    set(1, -0.2, 0.2);
    for (int i = 3; i < 6; ++i) set(i, -0.3, 0.2);
  }
  if (variant == 5) {
    for (int i = 0; i < 6; ++i) set(i, 0.02 * i, 0.02 * i);
    set(5, 1, -1);
    for (int i = 0; i < 6; ++i) joint.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.1 + 0.05 * i), i);
    joint.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.01), 1);
    joint.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.01), 4);
  }
  if (variant == 6) {
    set(3, 1, -1);
    set(4, 0.3, 0.3);
    set(5, -0.5, 0.5);
  }
}

void set(pintle::Generic6DofJoint& joint, int variant) {
  setAxes(joint, variant);
  if (variant == 3 || variant == 4) {
    joint.getTranslationalLimitMotor()->m_enableMotor[2] = true;
    joint.getTranslationalLimitMotor()->m_targetVelocity[2] = 1;
    joint.getTranslationalLimitMotor()->m_maxMotorForce[2] = 20;
    btRotationalLimitMotor& motor = *joint.getRotationalLimitMotor(1);
    motor.m_enableMotor = true;
    motor.m_targetVelocity = 2;
    motor.m_bounce = scalar(0.5);
  }
}

template <class J>
void setSprings(J& joint) {
  for (int i = 0; i < 6; ++i) {
    joint.enableSpring(i, true);
    joint.setStiffness(i, i < 3 ? 100 : 10);
    joint.setDamping(i, scalar(0.1));
    joint.setEquilibriumPoint(i, scalar(0.05));
  }
}

void set(pintle::Generic6DofSpringJoint& joint, int variant) {
  setAxes(joint, variant);
  if (variant >= 2) setSprings(joint);
}

template <class J>
void setSpring2(J& joint, int variant) {
  setAxes(joint, variant);
  if (variant == 2 || variant >= 4) setSprings(joint);
  if (variant == 3 || variant == 4) {
    joint.enableMotor(2, true);
    joint.setTargetVelocity(2, 1);
    joint.setMaxMotorForce(2, 20);
    joint.enableMotor(4, true);
    joint.setServo(4, true);
    joint.setServoTarget(4, scalar(0.1));
    joint.setTargetVelocity(4, 1);
    joint.setBounce(5, scalar(0.5));
  }
  if (variant == 3) joint.setRotationOrder(RO_ZXY);
}

void set(pintle::Generic6DofSpring2Joint& joint, int variant) { setSpring2(joint, variant); }
void set(pintle::Hinge2Joint& joint, int variant) { setSpring2(joint, variant); }

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
    joint.setLimit(scalar(1.2), scalar(1.4), scalar(0.5));
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
  if (variant == 9) {
    joint.setLimit(scalar(0.5), scalar(0.5), scalar(0.5));
    joint.setMotorVelocity(support::vec(1, 2, -1));
    joint.setMaxMotorImpulse(scalar(0.5));
    joint.enableMotor(true);
  }
}

// --- the list ------------------------------------------------------------------------------------

struct Nature {
  bool holds = true;
  const char* free_body = "A";
  const char* blows_up = "";
  bool limits_look_ahead = false;
};

template <class J>
void add(std::vector<Kind>& list, const char* name, int variants, const Nature& nature = {}) {
  for (const Formulation form : {Formulation::conditioned, Formulation::document}) {
    Kind kind;
    kind.name = std::string(name) + (form == Formulation::document ? "Document" : "");
    kind.bytes = sizeof(J);
    kind.variants = variants;
    kind.holds = nature.holds;
    kind.free_body = nature.free_body;
    kind.blows_up = nature.blows_up;
    kind.limits_look_ahead = nature.limits_look_ahead;
    kind.make = [form](btRigidBody& a, btRigidBody& b, const btTransform& frame_a,
                       const btTransform& frame_b, int variant) {
      auto joint = std::make_unique<J>(a, b, frame_a, placed<J>(frame_b));
      joint->setFormulation(form);
      set(*joint, variant);
      return joint;
    };
    kind.make_one = [](btRigidBody& a, const btTransform& frame_a) {
      return std::make_unique<J>(a, frame_a);
    };
    list.push_back(kind);
  }
}

// Between axes of bodies, and between the angle and the position of a slider, of which the gear needs no more than frames.
std::unique_ptr<btTypedConstraint> makeGear(btRigidBody& a, btRigidBody& b,
                                            const btTransform& frame_a, const btTransform& frame_b,
                                            int variant) {
  const btVector3 axis_a = frame_a.getBasis().getColumn(2),
                  axis_b = frame_b.getBasis().getColumn(2);
  if (variant == 0) return std::make_unique<pintle::GearJoint>(a, b, axis_a, axis_b, scalar(2.5));
  if (variant == 1) return std::make_unique<pintle::GearJoint>(a, b, axis_a * 2, axis_b, -1);
  btSliderConstraint slider(a, b, frame_a, frame_b, true);
  auto gear = std::make_unique<pintle::GearJoint>(pintle::GearCoordinate::angleOf(slider), slider,
                                                  scalar(0.5));
  gear->setMaxCorrectionSpeed(1);
  return gear;
}

void addGear(std::vector<Kind>& list) {
  Kind kind;
  kind.name = "GearJoint";
  kind.bytes = sizeof(pintle::GearJoint);
  kind.variants = 3;
  kind.holds = false;  // no more than one row
  kind.free_body = "A";
  kind.limits_look_ahead = false;
  kind.make = makeGear;
  kind.make_one = [](btRigidBody& a, const btTransform& frame) {
    const btVector3 axis = frame.getBasis().getColumn(2);
    return std::make_unique<pintle::GearJoint>(a, btTypedConstraint::getFixedBody(), axis, axis);
  };
  list.push_back(kind);
}

}  // namespace

std::vector<Kind> all() {
  const Nature at_times = {false, "A", ""};
  std::vector<Kind> list;
  add<QuaternionHinge>(list, "QuaternionHinge", 6);
  add<BallJoint>(list, "BallJoint", 4);
  add<DistanceJoint>(list, "DistanceJoint", 5, at_times);
  add<ContactJoint>(list, "ContactJoint", 4, at_times);
  add<WedgeJoint>(list, "WedgeJoint", 6);
  add<AngularLimit>(list, "AngularLimit", 5, at_times);
  add<UniversalJoint>(list, "UniversalJoint", 6);
  add<ConstantVelocityJoint>(list, "ConstantVelocityJoint", 8);
  add<ConeTwistJoint>(list, "ConeTwistJoint", 10, {false, "A", "", true});
  add<SliderJoint>(list, "SliderJoint", 6, {true, "B", ""});
  add<pintle::FixedJoint>(list, "FixedJoint", 3);
  add<pintle::Generic6DofJoint>(list, "Generic6DofJoint", 7, {true, "B", ""});
  add<pintle::Generic6DofSpringJoint>(list, "Generic6DofSpringJoint", 7, {true, "B", ""});
  add<pintle::Generic6DofSpring2Joint>(list, "Generic6DofSpring2Joint", 7, {true, "B", ""});
  add<pintle::Hinge2Joint>(list, "Hinge2Joint", 7, {true, "B", ""});
  add<pintle::DotHinge>(list, "DotHinge", 6);
  add<TwoPointHinge>(list, "TwoPointHinge", 9);
  addGear(list);
  add<pintle::CrossProductHinge>(list, "CrossProductHinge", 3);
  add<pintle::CrossProductMatrixHinge>(list, "CrossProductMatrixHinge", 3);
  add<pintle::SingleRowLock>(list, "SingleRowLock", 3);
  return list;
}

}  // namespace kinds
