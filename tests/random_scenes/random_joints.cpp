#include "random_joints.h"

#include <pintle/joints/angular_limit.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/constant_velocity_joint.h>
#include <pintle/joints/contact_joint.h>
#include <pintle/joints/distance_joint.h>
#include <pintle/joints/dot_hinge.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/two_point_hinge.h>
#include <pintle/joints/universal_joint.h>
#include <pintle/joints/unstable/cross_product_hinge.h>
#include <pintle/joints/unstable/cross_product_matrix_hinge.h>
#include <pintle/joints/unstable/single_row_lock.h>
#include <pintle/joints/wedge_joint.h>

#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btGearConstraint.h>
#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>
#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpringConstraint.h>
#include <BulletDynamics/ConstraintSolver/btHinge2Constraint.h>
#include <BulletDynamics/ConstraintSolver/btUniversalConstraint.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>

#include "draws.h"

namespace random_scenes {
namespace {

using support::scalar;

template <class J>
std::unique_ptr<J> of(const Making& m) {
  return std::make_unique<J>(m.a, m.b, m.in_a, m.in_b);
}
template <class J>
std::unique_ptr<J> ofStock(const Making& m) {
  return std::make_unique<J>(m.a, m.b, m.in_a, m.in_b, true);
}
// Of those that are made by an anchor and axes of the world.
template <class J>
std::unique_ptr<J> ofAxes(const Making& m, int first, int second) {
  const btTransform frame = m.a.getCenterOfMassTransform() * m.in_a;
  btVector3 anchor = frame.getOrigin(), axis1 = frame.getBasis().getColumn(first),
            axis2 = frame.getBasis().getColumn(second);
  auto joint = std::make_unique<J>(m.a, m.b, anchor, axis1, axis2);
  joint->setFrames(m.in_a, m.in_b);
  return joint;
}
template <class J>
Joint plain(const Making& m) {
  return of<J>(m);
}

template <class Cone>
void setSpans(Cone& cone, const Making& m) {
  const auto span = [&] { return scalar(m.random.uniform(0.2, 1)); };
  const btScalar swing1 = span(), swing2 = span(), twist = span();
  cone.setLimit(swing1, swing2, twist);
}

// --- Pintle's ----------------------------------------------------------------------------------------

template <class Hinge>
Joint limitedHinge(const Making& m) {
  auto hinge = of<Hinge>(m);
  const Range angles = m.range(1);
  hinge->setLimit(angles.low, angles.high);
  if (m.rubs && chance(m.random, 0.3))  // a brake
    hinge->enableAngularMotor(true, 0, m.friction() / 60);
  else
    hinge->setFriction(m.friction());
  return hinge;
}
Joint freeHinge(const Making& m) {
  auto hinge = of<pintle::QuaternionHinge>(m);
  hinge->setFriction(m.friction());
  return hinge;
}
Joint slider(const Making& m) {
  auto joint = of<pintle::SliderJoint>(m);
  const Range way = m.range(0.5), angles = m.range(1);
  joint->setLowerLinLimit(way.low);
  joint->setUpperLinLimit(way.high);
  joint->setLowerAngLimit(angles.low);
  joint->setUpperAngLimit(angles.high);
  joint->setLinFriction(m.friction());
  joint->setAngFriction(m.friction());
  return joint;
}
Joint universal(const Making& m) {
  auto joint = of<pintle::UniversalJoint>(m);
  for (const int axis : {4, 5}) {
    const Range angles = m.range(1);
    if (chance(m.random, 0.3)) joint->setLimit(axis, angles.low, angles.high);
    joint->setFriction(axis, m.friction());
  }
  return joint;
}
Joint constantVelocity(const Making& m) {
  auto joint = of<pintle::ConstantVelocityJoint>(m);
  joint->setFriction(m.friction());
  joint->setBendFriction(m.friction());
  return joint;
}
Joint coneTwist(const Making& m) {
  auto cone = of<pintle::ConeTwistJoint>(m);
  setSpans(*cone, m);
  cone->setFriction(m.friction());
  return cone;
}
Joint wedge(const Making& m) {
  auto joint = of<pintle::WedgeJoint>(m);
  const Range angles = m.range(0.9);
  joint->setLimit(angles.low - scalar(0.1), angles.high + scalar(0.1));
  joint->setFriction(m.friction());
  return joint;
}
Joint angularLimit(const Making& m) {
  auto limit = of<pintle::AngularLimit>(m);
  const btScalar now = limit->getAngle();
  const Range angles = chance(m.random, 0.3) ? Range{0, 0} : m.range(1);
  limit->setLimit(now + angles.low, now + angles.high);
  limit->setFriction(m.friction());
  return limit;
}
Joint contact(const Making& m) {
  auto joint = of<pintle::ContactJoint>(m);
  joint->setTwoSided(chance(m.random, 0.3));
  if (chance(m.random, 0.3)) joint->setRestitution(scalar(m.random.uniform(0, 1)));
  return joint;
}
std::unique_ptr<pintle::DistanceJoint> distance(const Making& m) {
  auto joint = std::make_unique<pintle::DistanceJoint>(m.a, m.b, m.in_a.getOrigin(),
                                                       m.in_b.getOrigin(), scalar(m.length()));
  joint->setFriction(m.friction());
  return joint;
}
Joint rod(const Making& m) { return distance(m); }
Joint rope(const Making& m) {
  auto joint = distance(m);
  joint->setLimit(0, scalar(m.length() * m.random.uniform(1, 1.5)));
  return joint;
}
// To the middle of b, for what holds a pivot otherwise.
Joint tether(const Making& m) {
  return rope({m.a, m.b, m.in_a, btTransform::getIdentity(), m.rubs, m.random});
}
Joint strut(const Making& m) {
  auto joint = distance(m);
  const double low = m.random.uniform(0.5, 1), high = m.random.uniform(1, 1.5);
  joint->setLimit(scalar(m.length() * low), scalar(m.length() * high));
  return joint;
}

// --- Bullet's ----------------------------------------------------------------------------------------

Joint stockBall(const Making& m) {
  return std::make_unique<btPoint2PointConstraint>(m.a, m.b, m.in_a.getOrigin(),
                                                   m.in_b.getOrigin());
}
template <class Hinge>
Joint stockHinge(const Making& m) {
  auto hinge = of<Hinge>(m);
  const Range angles = m.range(1);
  if (chance(m.random, 0.5))
    hinge->setLimit(angles.low, angles.high);
  else
    hinge->setLimit(1, -1);
  if (m.rubs) hinge->enableAngularMotor(true, 0, m.friction() / 60);
  return hinge;
}
Joint stockSlider(const Making& m) {
  auto joint = ofStock<btSliderConstraint>(m);
  const Range way = m.range(0.5);
  joint->setLowerLinLimit(way.low);
  joint->setUpperLinLimit(way.high);
  if (m.rubs) {
    joint->setPoweredLinMotor(true);
    joint->setMaxLinMotorForce(m.friction());
  }
  return joint;
}
Joint stockConeTwist(const Making& m) {
  auto cone = of<btConeTwistConstraint>(m);
  setSpans(*cone, m);
  return cone;
}
void rub(btGeneric6DofConstraint& joint, int axis, const Making& m) {
  if (!m.rubs) return;
  btRotationalLimitMotor& motor = *joint.getRotationalLimitMotor(axis);
  motor.m_enableMotor = true;
  motor.m_targetVelocity = 0;
  motor.m_maxMotorForce = m.friction();
}
void rub(btGeneric6DofSpring2Constraint& joint, int axis, const Making& m) {
  if (!m.rubs) return;
  joint.enableMotor(axis + 3, true);
  joint.setTargetVelocity(axis + 3, 0);
  joint.setMaxMotorForce(axis + 3, m.friction());
}
template <class SixDof>
Joint limitedSixDof(std::unique_ptr<SixDof> joint, const Making& m, btScalar about_z) {
  const Range along_z = m.range(0.3), about_x = m.range(0.5);
  joint->setLinearLowerLimit(btVector3(0, 0, along_z.low));
  joint->setLinearUpperLimit(btVector3(0, 0, along_z.high));
  joint->setAngularLowerLimit(btVector3(about_x.low, 0, -about_z));
  joint->setAngularUpperLimit(btVector3(about_x.high, 0, about_z));
  rub(*joint, 0, m);
  return joint;
}
Joint stockUniversal(const Making& m) {
  auto joint = ofAxes<btUniversalConstraint>(m, 2, 1);
  if (chance(m.random, 0.5)) {
    const Range angle1 = m.range(1), angle2 = m.range(1);
    joint->setLowerLimit(angle1.low, angle2.low);
    joint->setUpperLimit(angle1.high, angle2.high);
  }
  rub(*joint, 1, m);
  rub(*joint, 2, m);
  return joint;
}
Joint stockHinge2(const Making& m) {
  auto joint = ofAxes<btHinge2Constraint>(m, 2, 0);
  joint->enableSpring(2, false);
  const Range along_z = m.range(0.3), angle = m.range(1);
  joint->setLinearLowerLimit(btVector3(0, 0, along_z.low));
  joint->setLinearUpperLimit(btVector3(0, 0, along_z.high));
  joint->setLowerLimit(angle.low);
  joint->setUpperLimit(angle.high);
  rub(*joint, 0, m);
  rub(*joint, 2, m);
  return joint;
}
// Alone it couples how fast two bodies turn, and holds them nowhere.
Joint stockGear(const Making& m) {
  const double ratio = m.random.uniform(-3, 3);
  return std::make_unique<btGearConstraint>(m.a, m.b, m.in_a.getBasis().getColumn(2),
                                            m.in_b.getBasis().getColumn(2), scalar(ratio));
}

const Kind all_kinds[] = {
    {"ball", false, plain<pintle::BallJoint>, nullptr},
    {"hinge", false, freeHinge, nullptr},
    {"limited hinge", false, limitedHinge<pintle::QuaternionHinge>, nullptr},
    {"dot hinge", false, limitedHinge<pintle::DotHinge>, nullptr},
    {"two-point hinge", false, limitedHinge<pintle::TwoPointHinge>, nullptr},
    {"fixed", false, plain<pintle::FixedJoint>, nullptr},
    {"slider", false, slider, nullptr},
    {"universal", false, universal, nullptr},
    {"constant velocity", false, constantVelocity, nullptr},
    {"cone-twist", false, coneTwist, nullptr},
    {"wedge", false, wedge, nullptr},
    {"rod", true, rod, nullptr},
    {"rope", true, rope, nullptr},
    {"strut", true, strut, nullptr},
    {"angular limit", false, angularLimit, nullptr},
    {"ball with an angular limit", false, plain<pintle::BallJoint>, angularLimit},
    {"contact joint", false, contact, nullptr},
    {"contact joint on a tether", false, contact, tether},
    {"cross product hinge", false, plain<pintle::CrossProductHinge>, nullptr},
    {"cross product matrix hinge", false, plain<pintle::CrossProductMatrixHinge>, nullptr},
    {"single row lock", false, plain<pintle::SingleRowLock>, nullptr},
    {"stock ball", false, stockBall, nullptr},
    {"stock hinge", false, stockHinge<btHingeConstraint>, nullptr},
    {"stock accumulated hinge", false, stockHinge<btHingeAccumulatedAngleConstraint>, nullptr},
    {"stock slider", false, stockSlider, nullptr},
    {"stock fixed", false, plain<btFixedConstraint>, nullptr},
    {"stock cone-twist", false, stockConeTwist, nullptr},
    {"stock 6-dof", false,
     [](const Making& m) { return limitedSixDof(ofStock<btGeneric6DofConstraint>(m), m, 1); },
     nullptr, true},
    {"stock 6-dof spring", false,
     [](const Making& m) { return limitedSixDof(ofStock<btGeneric6DofSpringConstraint>(m), m, 1); },
     nullptr, true},
    {"stock 6-dof spring 2", false,
     [](const Making& m) { return limitedSixDof(of<btGeneric6DofSpring2Constraint>(m), m, 0); },
     nullptr, true},
    {"stock universal", false, stockUniversal, nullptr, true},
    {"stock hinge 2", false, stockHinge2, nullptr, true},
    {"stock gear", false, stockGear, nullptr},
    {"stock ball with a gear", false, stockBall, stockGear},
};

template <class J, class Visit>
void ifIs(btTypedConstraint& joint, const Visit& visit) {
  if (auto* const of = dynamic_cast<J*>(&joint)) visit(*of);
}

}  // namespace

Range Making::range(double most) const {
  const double low = random.uniform(-most, 0), high = random.uniform(0, most);
  return {scalar(low), scalar(high)};
}
btScalar Making::friction() const { return rubs ? scalar(std::pow(10, random.uniform(-2, 1))) : 0; }
double Making::length() const {
  return double((a.getCenterOfMassTransform() * in_a.getOrigin() -
                 b.getCenterOfMassTransform() * in_b.getOrigin())
                    .length());
}

void setVariant(btTypedConstraint& joint, const Variant& variant, support::Random& random) {
  const btScalar hz = scalar(variant.spring_hz), damping = scalar(variant.spring_damping);
  auto* const ours = dynamic_cast<pintle::Joint*>(&joint);
  if (variant.document && ours != nullptr && dynamic_cast<pintle::AngularLimit*>(ours) == nullptr)
    ours->setFormulation(pintle::Formulation::document);
  ifIs<pintle::ConstantVelocityJoint>(joint, [&](auto& of) {
    if (variant.bends) of.setBendLimit(of.getBend() + scalar(random.uniform(0, 1)));
    of.setBendLimitSpring(hz, damping);
  });
  if (!(hz > 0)) return;
  const auto setSpring = [&](auto& of) { of.setLimitSpring(hz, damping); };
  ifIs<pintle::HingeBase>(joint, setSpring);
  ifIs<pintle::AngularLimit>(joint, setSpring);
  ifIs<pintle::ContactJoint>(joint, setSpring);
  ifIs<pintle::WedgeJoint>(joint, setSpring);
  ifIs<pintle::UniversalJoint>(joint, [&](auto& of) {
    for (const int axis : {4, 5}) of.setLimitSpring(axis, hz, damping);
  });
  ifIs<pintle::SliderJoint>(joint, [&](auto& of) {
    of.setLinLimitSpring(hz, damping);
    of.setAngLimitSpring(hz, damping);
  });
  ifIs<pintle::ConeTwistJoint>(joint, [&](auto& of) {
    of.setSwingLimitSpring(hz, damping);
    of.setTwistLimitSpring(hz, damping);
  });
}

int kindCount() { return int(std::size(all_kinds)); }
const Kind& kindOf(int index) { return all_kinds[index]; }

}  // namespace random_scenes
