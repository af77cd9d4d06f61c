// A joint takes at most one and a half times the memory of its stock counterpart.
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

TYPED_TEST(Size, IsAtMostHalfMoreThanStock) {
  EXPECT_LE(2 * sizeof(typename TypeParam::joint), 3 * sizeof(typename TypeParam::stock));
}

}  // namespace size_test
