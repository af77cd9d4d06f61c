// A joint takes at most seven tenths more memory than its stock counterpart, that of its rows counted. One that derives from it has
// all of that, too (two thirds of a hinge of Bullet's are rows that nobody reads): 2.3 times.
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

TYPED_TEST(Size, IsBoundedByThatOfStock) {
  using Joint = typename TypeParam::joint;
  btRigidBody a(1, nullptr, nullptr), b(1, nullptr, nullptr);
  const btTransform frame = btTransform::getIdentity();
  const long before = contract_test::allocated_bytes;
  const Joint joint(a, b, frame, frame);
  const long rows = contract_test::allocated_bytes - before;
  EXPECT_GT(rows, 0);
  constexpr bool derives = std::is_base_of_v<typename TypeParam::stock, Joint>;
  // It has two limits beside Bullet's. (Each axis has room for a motor, a servo, a spring and friction.)
  constexpr bool is_cone_twist = std::is_same_v<Joint, pintle::ConeTwistJoint>;
  const auto stock = double(sizeof(typename TypeParam::stock));
  EXPECT_LE(double(sizeof(Joint)) + double(rows), stock * (is_cone_twist ? 2.8
                                                           : derives     ? 2.35
                                                                         : 1.7));
}

}  // namespace size_test
