// A joint takes at most one and a half times the memory of its stock counterpart, that of its rows counted.
#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <BulletDynamics/ConstraintSolver/btUniversalConstraint.h>
#include <gtest/gtest.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/dot_hinge.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/two_point_hinge.h>
#include <pintle/joints/universal_joint.h>

#include "support.h"

namespace contract_test {
extern thread_local long allocated_bytes;  // by operator new
}

namespace size_test {

template <class Joint, class Stock>
struct Pair {
  using joint = Joint;
  using stock = Stock;
};

template <class Pair>
class Size : public testing::Test {};

using Pairs = testing::Types<
    Pair<pintle::BallJoint, btPoint2PointConstraint>,
    Pair<pintle::QuaternionHinge, btHingeConstraint>, Pair<pintle::DotHinge, btHingeConstraint>,
    Pair<pintle::TwoPointHinge, btHingeConstraint>, Pair<pintle::SliderJoint, btSliderConstraint>,
    Pair<pintle::FixedJoint, btFixedConstraint>,
    Pair<pintle::ConeTwistJoint, btConeTwistConstraint>,
    Pair<pintle::UniversalJoint, btUniversalConstraint>>;
TYPED_TEST_SUITE(Size, Pairs);

TYPED_TEST(Size, IsAtMostTwoThirdsMoreThanStock) {
  using Joint = typename TypeParam::joint;
  btRigidBody a(1, nullptr, nullptr), b(1, nullptr, nullptr);
  const btTransform frame = btTransform::getIdentity();
  const long before = contract_test::allocated_bytes;
  const Joint joint(a, b, frame, frame);
  const long rows = contract_test::allocated_bytes - before;
  EXPECT_GT(rows, 0);
  EXPECT_LE(20 * (long(sizeof(Joint)) + rows), 33 * long(sizeof(typename TypeParam::stock)));
}

}  // namespace size_test
