// Cables held at both ends, let go from a V: they hold, gain nothing, and come to rest.
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/quaternion_hinge.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "books.h"
#include "cables.h"
#include "physics_support.h"
#include "support.h"

namespace exact_cables_test {
namespace {

using physics::rounding;
using support::addCable;
using support::Books;
using support::largestGapOf;
using support::scalar;

struct Cable {
  int links;
  double slack, hz, load;
};
std::ostream& operator<<(std::ostream& out, const Cable& of) {
  return out << of.links << " links, slack " << of.slack << ", " << of.hz << " Hz, " << of.load
             << " kg";
}

struct Played {
  double gap = 0, gain = 0, peak = 0;  ///< m, J, J
};

/// In 10 s.
template <class Joint>
Played play(const Cable& of) {
  Books books(of.hz);
  addCable<Joint>(books, of.links, of.slack, of.load);
  books.begin();
  double gap = 0;
  for (int i = 0; i < 10 * int(of.hz); ++i) {
    books.step();
    gap = std::max(gap, largestGapOf<Joint>(books));
  }
  return {gap, books.gain, books.peak};
}

TEST(ExactCables, GainNothing) {
  for (const Cable& of : {Cable{10, 0.02, 60, 0}, Cable{10, 0.1, 60, 0}, Cable{10, 0.2, 60, 0},
                          Cable{10, 0.02, 240, 0}, Cable{30, 0.02, 120, 0}, Cable{20, 0.02, 120, 5},
                          Cable{10, 0.02, 60, 1e4}}) {
    const Played played = play<pintle::BallJoint>(of);
    EXPECT_LE(played.gain, rounding(0.02, 0.0101) * played.peak) << of;  // and rounding
    EXPECT_LE(played.gap, rounding(2e-5, 1e-8)) << of;
  }
}

// Nearly straight they snap: no rate of steps resolves that.
template <class Joint>
class TautCables : public testing::Test {};
using Joints = testing::Types<pintle::BallJoint, pintle::QuaternionHinge>;
TYPED_TEST_SUITE(TautCables, Joints, );

TYPED_TEST(TautCables, HoldAndGainNothingAtAnyRate) {
  for (const Cable& of :
       {Cable{10, 0.002, 60, 0}, Cable{10, 0.002, 240, 0}, Cable{30, 0.002, 60, 0},
        Cable{30, 0.002, 120, 0}, Cable{30, 0.002, 240, 0}}) {
    const Played played = play<TypeParam>(of);
    EXPECT_LE(played.gain, 0.0101 * played.peak) << of;  // and rounding
    EXPECT_LE(played.gap, rounding(1e-5, 2e-9)) << of;
  }
}

// A fifth of their speed is lost a second, which is so much of their energy: half of it is kinetic. So 0.25 % of it would be left after half a
// minute, if joints neither gave nor took.
TYPED_TEST(TautCables, ComeToRest) {
  for (const double hz : {60., 120., 240.}) {
    Books books(hz);
    addCable<TypeParam>(books, 10, 0.002);
    for (const auto& body : books.bodies) body->setDamping(scalar(0.2), scalar(0.2));
    books.begin();
    for (int i = 0; i < 30 * int(hz); ++i) books.step();
    const double peak = books.peak;
    EXPECT_GT(peak, 0.8) << "it has fallen";
    books.begin();
    for (int i = 0; i < int(hz); ++i) books.step();
    EXPECT_LE(books.peak, 0.01 * peak) << hz;
  }
}

// Of their heavy load links swing faster than steps resolve: so they come to rest without any damping.
TEST(ExactCables, TautUnderAHeavyLoadComeToRest) {
  for (const Cable& of :
       {Cable{5, 0.001, 30, 100}, Cable{5, 0.002, 30, 100}, Cable{14, 0.001, 30, 100},
        Cable{7, 0.002, 35, 100}, Cable{14, 0.003, 40, 100}, Cable{14, 0.002, 45, 100},
        Cable{7, 0.0015, 50, 100}, Cable{14, 0.003, 60, 100}, Cable{7, 0.001, 65, 100}}) {
    Books books(of.hz);
    addCable<pintle::BallJoint>(books, of.links, of.slack, of.load);
    books.begin();
    for (int i = 0; i < 20 * int(of.hz); ++i) books.step();
    const double peak = books.peak;
    EXPECT_GT(peak, 0.1) << of << ": it has fallen";
    books.begin();
    for (int i = 0; i < 2 * int(of.hz); ++i) books.step();
    EXPECT_LE(books.peak, 1e-3 * peak) << of;
  }
}

// N: what the first joint bears of a cable at rest, by the torques of the weights about its last joint, and about that in the middle.
double staticLoad(const Books& books) {
  const auto pivot = [&](size_t i) {
    const auto& joint = static_cast<pintle::BallJoint&>(*books.joints[i]);
    return joint.getRigidBodyA().getCenterOfMassTransform() * joint.getPivotInA();
  };
  const size_t links = books.joints.size() - 1, middle = links / 2;
  const btVector3 first = pivot(0);
  const auto torque = [&](size_t count, double x) {
    double sum = 0;
    for (size_t i = 1; i <= count; ++i)
      sum += (x - double(books.bodies[i]->getCenterOfMassPosition().x())) /
             double(books.bodies[i]->getInvMass());
    return 9.81 * sum;
  };
  const double end = double(pivot(links).x()), x = double(pivot(middle).x()),
               depth = double(first.z() - pivot(middle).z()),
               up = torque(links, end) / (end - double(first.x())),
               along = (up * (x - double(first.x())) - torque(middle, x)) / depth;
  return std::hypot(up, along);
}

// A load on a bridge of 0.2 % slack hangs on a multiple of its weight. It comes to rest, whether steps resolve how links swing or not.
// Joints hold at 1.1 times what the first one bears there.
TEST(ExactCables, AThresholdOfATautBridgeIsThatOfRest) {
  for (const double hz : {30., 45., 60., 120., 240.}) {
    SCOPED_TRACE(hz);
    Books books(hz);
    addCable<pintle::BallJoint>(books, 10, 0.002, 5);
    for (const auto& body : books.bodies) body->setDamping(scalar(0.5), scalar(0.5));
    for (int i = 0; i < int(20 * hz); ++i) books.step();
    btJointFeedback feedback;
    books.joints[0]->setJointFeedback(&feedback);
    const double load = staticLoad(books), rest = load / hz;
    EXPECT_GT(load, 10 * 5 * 9.81) << "a taut bridge bears more than its load";
    for (int i = 0; i < int(hz); ++i) {
      books.step();
      ASSERT_NEAR(double(feedback.m_appliedForceBodyB.length()), load, 0.01 * load) << i;
    }
    for (const auto& joint : books.joints) joint->setBreakingImpulseThreshold(scalar(1.1 * rest));
    for (int i = 0; i < int(2 * hz); ++i) books.step();
    for (const auto& joint : books.joints) EXPECT_TRUE(joint->isEnabled());
    books.joints[0]->setBreakingImpulseThreshold(scalar(0.9 * rest));
    books.step();
    EXPECT_FALSE(books.joints[0]->isEnabled());
    books.joints[0]->setJointFeedback(nullptr);
  }
}

TEST(ExactCables, TheSameStepsGiveTheSameBits) {
  Books first(60), second(60);
  for (Books* const books : {&first, &second}) {
    addCable<pintle::BallJoint>(*books, 10, 0.1, 5);
    for (int i = 0; i < 300; ++i) books->step();
  }
  EXPECT_EQ(first.energy(), second.energy());
}

}  // namespace
}  // namespace exact_cables_test
