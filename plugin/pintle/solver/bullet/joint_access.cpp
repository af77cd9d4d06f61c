#include <pintle/solver/bullet/joint_access.h>

#include <pintle/bullet/complaints.h>
#include <pintle/joint_rows.h>
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
#include <pintle/joints/wedge_joint.h>

#include <algorithm>
#include <typeinfo>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

template <class... Types>
bool isOneOf(const std::type_info& type) {
  return ((type == typeid(Types)) || ...);
}

struct Answer {
  int count = 0;
  Scalar damping = 1;
  btSolverConstraint rows[most_stock_rows];
};

// Asks `joint`, by its virtual methods.
void ask(btTypedConstraint& joint, const btContactSolverInfo& info, Answer& answer) {
  btTypedConstraint::btConstraintInfo1 size;
  joint.getInfo1(&size);
  answer.count = size.m_numConstraintRows;
  if (answer.count <= 0 || answer.count > most_stock_rows) return;
  answer.damping = askRows(
      joint,
      {1 / info.m_timeStep, info.m_erp, info.m_globalCfm, info.m_damping, info.m_numIterations},
      answer.rows, answer.count);
}

// Asks the base of a joint.
class Base : public btTypedConstraint {
 public:
  explicit Base(Joint& of)
      : btTypedConstraint(MAX_CONSTRAINT_TYPE, of.constraint().getRigidBodyA(),
                          of.constraint().getRigidBodyB()),
        m_of(of) {}
  void getInfo1(btConstraintInfo1* info) override { JointAccess::announceRows(m_of, *info); }
  void getInfo2(btConstraintInfo2* info) override { JointAccess::writeRows(m_of, *info); }
  void setParam(int, btScalar, int) override {}
  btScalar getParam(int, int) const override { return 0; }

 private:
  Joint& m_of;
};

bool isSame(const btVector3& a, const btVector3& b) {
  return a.x() == b.x() && a.y() == b.y() && a.z() == b.z();
}

bool isSame(const btSolverConstraint& a, const btSolverConstraint& b) {
  return isSame(a.m_contactNormal1, b.m_contactNormal1) &&
         isSame(a.m_relpos1CrossNormal, b.m_relpos1CrossNormal) &&
         isSame(a.m_contactNormal2, b.m_contactNormal2) &&
         isSame(a.m_relpos2CrossNormal, b.m_relpos2CrossNormal) && a.m_rhs == b.m_rhs &&
         a.m_cfm == b.m_cfm && a.m_lowerLimit == b.m_lowerLimit && a.m_upperLimit == b.m_upperLimit;
}

}  // namespace

int JointAccess::ignoredSettings(Joint& joint) {
  Complaints complaints;
  joint.read(&complaints);
  return complaints.count();
}

const GearRow* JointAccess::beginGear(Joint& joint, Scalar dt) {
  return static_cast<GearModel&>(joint).beginStep(dt);
}

JointAccess::Known JointAccess::find(btTypedConstraint& constraint) {
  const std::type_info& type = typeid(constraint);
  auto* const joint = dynamic_cast<Joint*>(&constraint);
  if (joint == nullptr) return {&type, 0, false, type == typeid(btGearConstraint)};
  return {&type, reinterpret_cast<char*>(joint) - reinterpret_cast<char*>(&constraint),
          isOneOf<AngularLimit, BallJoint, ConeTwistJoint, ConstantVelocityJoint, ContactJoint,
                  DistanceJoint, DotHinge, FixedJoint, GearJoint, Generic6DofJoint,
                  Generic6DofSpring2Joint, Generic6DofSpringJoint, Hinge2Joint, QuaternionHinge,
                  SliderJoint, TwoPointHinge, UniversalJoint, WedgeJoint>(type),
          dynamic_cast<GearModel*>(&constraint) != nullptr};
}

ClientRows findClientRows(Joint& joint, const btContactSolverInfo& info) {
  const JointAccess::PlainRows plain(joint);
  const JointAccess::KeptAxes kept(joint);
  Answer its, base;
  ask(joint.constraint(), info, its);
  kept.restore();  // the base starts from the same memory
  Base as_base(joint);
  ask(as_base, info, base);
  const int count = std::min(std::max(base.count, 0), most_stock_rows);
  const bool same = its.count >= base.count && its.count <= most_stock_rows &&
                    its.damping == base.damping &&
                    std::equal(base.rows, base.rows + count, its.rows,
                               [](const auto& a, const auto& b) { return isSame(a, b); });
  return {count, its.count > base.count, !same};
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
