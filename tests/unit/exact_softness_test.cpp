// The world's CFM, and a joint's own: little softness is as none, and none gives energy.
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/distance_joint.h>
#include <pintle/joints/quaternion_hinge.h>

#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "books.h"
#include "cables.h"
#include "physics_support.h"
#include "support.h"

namespace exact_softness_test {
namespace {

using physics::rounding;
using support::Books;
using support::largestGapOf;
using support::scalar;
using support::vec;

struct Softness {
  double of_world = 0, own = 0, erp = 0.2;
};

struct Swing {
  double gap = 0, gain = 0, peak = 0;  ///< m, J, J
};

/// In 5 s, of a chain of 10 links of 0.5 m and 1 kg that falls from the horizontal; the last one is of 100 kg.
template <class Joint>
Swing swing(const Softness& softness) {
  Books books(60);
  books.world.getSolverInfo().m_globalCfm = scalar(softness.of_world);
  books.world.getSolverInfo().m_erp = scalar(softness.erp);
  btRigidBody* last = &books.add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
  for (int i = 0; i < 10; ++i) {
    btRigidBody& link =
        books.add(i == 9 ? 100 : 1, vec(0.25, 0.05, 0.05), vec(0.5 * i + 0.25, 0, 0));
    support::joinAt<Joint>(books, *last, link, vec(0.5 * i, 0, 0));
    if (softness.own > 0)
      books.joints.back()->setParam(BT_CONSTRAINT_CFM, scalar(softness.own), -1);
    last = &link;
  }
  books.begin();
  double gap = 0;
  for (int i = 0; i < 300; ++i) {
    books.step();
    gap = std::max(gap, largestGapOf<Joint>(books));
  }
  return {gap, books.gain, books.peak};
}

template <class Joint>
class ExactSoftness : public testing::Test {};
using Joints = testing::Types<pintle::BallJoint, pintle::QuaternionHinge, btPoint2PointConstraint,
                              btHingeConstraint>;
TYPED_TEST_SUITE(ExactSoftness, Joints, );

// The chain bears five times its weight as it swings through: 90 N s a step, by which CFM / ERP of a stock joint gives 4.5e-7 m.
TYPED_TEST(ExactSoftness, LittleIsAsNone) {
  const Swing rigid = swing<TypeParam>({}), soft = swing<TypeParam>({1e-9, 0});
  EXPECT_LE(rigid.gap, rounding(1e-5, 5e-9));
  EXPECT_LE(soft.gap, rigid.gap + rounding(1e-5, 4.5e-7));
  EXPECT_LE(soft.gain, 0.01 * soft.peak);
  EXPECT_NE(soft.gap, rigid.gap) << "the world's CFM is heard";
}

TYPED_TEST(ExactSoftness, GivesNothing) {
  for (const double erp : {0.2, 0.8})
    for (const double cfm : {1e-9, 1e-5, 1e-3, 0.1}) {
      const Swing soft = swing<TypeParam>({cfm, 0, erp});
      EXPECT_LE(soft.gain, 0.01 * soft.peak) << cfm << ", ERP " << erp;
      EXPECT_GT(soft.peak, 3000) << "it has fallen, " << cfm << ", ERP " << erp;
    }
}

// Of Pintle's joints it is a part of their own response: what is asked of one joint is what is asked of the world.
TEST(ExactSoftnessOfAJoint, IsThatOfTheWorld) {
  const Swing rigid = swing<pintle::BallJoint>({}), own = swing<pintle::BallJoint>({0, 1e-9}),
              of_world = swing<pintle::BallJoint>({1e-9, 0});
  EXPECT_EQ(own.gap, of_world.gap);
  EXPECT_LE(own.gap, rigid.gap + rounding(1e-5, 2e-8));
}

// --- stops ---------------------------------------------------------------------------------------

constexpr double gravity = 9.81;

struct SoftStop {
  double cfm, erp, hz;

  void set(btTypedConstraint& joint) const {
    joint.setParam(BT_CONSTRAINT_STOP_CFM, scalar(cfm));
    joint.setParam(BT_CONSTRAINT_STOP_ERP, scalar(erp));
  }
  /// m or rad: how far it gives under what would accelerate by `a` (m/s^2 or rad/s^2) without it. CFM is in units of K = 1 / (what is
  /// moved): ERP C / dt = CFM K F dt.
  double give(double a) const { return cfm * a / (hz * hz * erp); }
};

class SoftStops : public testing::TestWithParam<SoftStop> {};

// It comes down on it, and then rests.
TEST_P(SoftStops, OfARopeGivesUnderALoad) {
  const SoftStop& stop = GetParam();
  Books books(stop.hz);
  btRigidBody& post = books.add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
  btRigidBody& load = books.add(3, vec(0.1, 0.1, 0.1), vec(0, 0, -0.99));
  auto rope = std::make_unique<pintle::DistanceJoint>(post, load, vec(0, 0, 0), vec(0, 0, 0), 1);
  rope->setLimit(0, 1);
  stop.set(*rope);
  books.join(std::move(rope));
  books.begin();
  for (int i = 0; i < 5 * stop.hz; ++i) books.step();
  EXPECT_NEAR(-double(load.getCenterOfMassPosition().z()) - 1, stop.give(gravity),
              1e-3 * stop.give(gravity) + rounding(1e-5, 1e-8));
  EXPECT_LE(double(load.getLinearVelocity().length()), rounding(1e-4, 1e-6));
  EXPECT_LE(books.gain, 0.01 * books.peak);
}

TEST_P(SoftStops, OfAHingeGivesUnderALoad) {
  const SoftStop& stop = GetParam();
  Books books(stop.hz);
  btRigidBody& post = books.add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
  btRigidBody& arm = books.add(1, vec(0.5, 0.05, 0.05), vec(0.5, 0, 0));
  auto hinge = std::make_unique<pintle::QuaternionHinge>(post, arm, vec(0, 0, 0), vec(-0.5, 0, 0),
                                                         vec(0, 1, 0), vec(0, 1, 0));
  hinge->setLimit(scalar(-0.01), 1);
  stop.set(*hinge);
  pintle::QuaternionHinge& joint = *hinge;
  books.join(std::move(hinge));
  books.begin();
  for (int i = 0; i < 5 * stop.hz; ++i) books.step();
  const double inertia = 1 / double(arm.getInvInertiaDiagLocal().y()) + 0.25,
               angle = double(joint.getHingeAngle()),
               give = stop.give(gravity * 0.5 * std::cos(angle) / inertia);
  EXPECT_NEAR(-angle - 0.01, give, 1e-3 * give + rounding(1e-5, 1e-8));
  EXPECT_LE(double(arm.getAngularVelocity().length()), rounding(1e-4, 1e-6));
  EXPECT_LE(books.gain, 0.01 * books.peak);
}

INSTANTIATE_TEST_SUITE_P(Some, SoftStops,
                         testing::Values(SoftStop{1e-6, 0.2, 60}, SoftStop{1e-2, 0.2, 60},
                                         SoftStop{0.1, 0.8, 60}, SoftStop{0.1, 0.2, 240},
                                         SoftStop{1, 0.5, 120}));

}  // namespace
}  // namespace exact_softness_test
