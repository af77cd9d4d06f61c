// (-pi, pi) is what Bullet's clients say for "no limit", and no wall; every other range is one.
#include "support.h"

#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/universal_joint.h>
#include <scenes/world.h>

#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

namespace free_turn_test {
namespace {

using support::scalar;
using support::vec;

constexpr double turning = 3, pi = double(SIMD_PI);  // rad/s

// How far a body that turns about the joint's axis comes within two seconds, and how fast it is then.
struct Turn {
  double lowest = 0, highest = 0, speed = 0;
};

template <class Make>
Turn turn(const btVector3& axis, double way, Make make) {
  scenes::World world(0);
  btRigidBody& base = world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
  btRigidBody& body = world.add_box(1, vec(0.5, 0.5, 0.5), scenes::pose_at(vec(0, 0, 0)));
  make(world, base, body);
  body.setAngularVelocity(scalar(way * turning) * axis);
  Turn result;
  double angle = 0;
  for (int i = 0; i < 120; ++i) {
    world.step(1.0 / 60);
    result.speed = way * double(body.getAngularVelocity().dot(axis));
    angle += double(body.getAngularVelocity().dot(axis)) / 60;
    result.lowest = std::min(result.lowest, angle);
    result.highest = std::max(result.highest, angle);
  }
  return result;
}

// Each joint, with limits as each is given them.
template <class Hinge, class Set>
Turn turnOfHinge(double way, Set set) {
  return turn(vec(0, 0, 1), way, [&](scenes::World& world, btRigidBody& a, btRigidBody& b) {
    // Bullet's hinge angle falls as b turns about its axis.
    set(world.add_joint<Hinge>(a, b, vec(0, 0, 0), vec(0, 0, 0), vec(0, 0, -1), vec(0, 0, -1)));
  });
}
template <class Slider, class Set>
Turn turnOfSlider(double way, Set set) {
  return turn(vec(1, 0, 0), way, [&](scenes::World& world, btRigidBody& a, btRigidBody& b) {
    const btTransform frame = btTransform::getIdentity();
    Slider& slider = world.add_joint<Slider>(a, b, frame, frame, true);
    slider.setLowerLinLimit(0);
    slider.setUpperLinLimit(0);
    set(slider);
  });
}
template <class Set>
Turn turnOfUniversal(double way, Set set) {
  return turn(vec(0, 0, 1), way, [&](scenes::World& world, btRigidBody& a, btRigidBody& b) {
    set(world.add_joint<pintle::UniversalJoint>(a, b, vec(0, 0, 0), vec(0, 0, 1), vec(0, 1, 0)));
  });
}

const auto limit_hinge = [](double low, double high) {
  return [=](auto& hinge) { hinge.setLimit(scalar(low), scalar(high)); };
};
const auto limit_slider = [](double low, double high) {
  return [=](auto& slider) {
    slider.setLowerAngLimit(scalar(low));
    slider.setUpperAngLimit(scalar(high));
  };
};
const auto limit_universal = [](double low, double high) {
  // Bullet's angles of six degrees fall as b turns.
  return [=](auto& universal) { universal.setLimit(5, scalar(-high), scalar(-low)); };
};

// Ways to write pi: with all digits, in single precision, with a few.
constexpr double half_turns[] = {pi, double(3.14159265358979323846f), 3.14159};

TEST(FreeTurn, HalfATurnEitherWayIsNoLimit) {
  for (const double half : half_turns) {
    for (const double way : {1., -1.}) {
      SCOPED_TRACE(testing::Message() << half << ", " << way);
      const std::pair<const char*, Turn> turns[] = {
          {"stock hinge", turnOfHinge<btHingeConstraint>(way, limit_hinge(-pi, pi))},
          {"hinge", turnOfHinge<pintle::QuaternionHinge>(way, limit_hinge(-half, half))},
          {"stock slider", turnOfSlider<btSliderConstraint>(way, limit_slider(-pi, pi))},
          {"slider", turnOfSlider<pintle::SliderJoint>(way, limit_slider(-half, half))},
          {"universal", turnOfUniversal(way, limit_universal(-half, half))},
      };
      for (const auto& [name, turn] : turns) {
        SCOPED_TRACE(name);
        EXPECT_NEAR(turn.speed, turning, 1e-3);
        EXPECT_GT(std::max(-turn.lowest, turn.highest), 1.8 * pi);
      }
    }
  }
}

TEST(FreeTurn, IsReadBackAsItWasSet) {
  turnOfHinge<pintle::QuaternionHinge>(1, [](pintle::QuaternionHinge& hinge) {
    hinge.setLimit(-SIMD_PI, SIMD_PI);
    EXPECT_EQ(hinge.getLowerLimit(), -SIMD_PI);
    EXPECT_EQ(hinge.getUpperLimit(), SIMD_PI);
    EXPECT_TRUE(hinge.hasLimit()) << "as stock says";
  });
  turnOfSlider<pintle::SliderJoint>(1, [](pintle::SliderJoint& slider) {
    slider.setLowerAngLimit(-SIMD_PI);
    slider.setUpperAngLimit(SIMD_PI);
    EXPECT_EQ(slider.getLowerAngLimit(), -SIMD_PI);
    EXPECT_EQ(slider.getUpperAngLimit(), SIMD_PI);
  });
  turnOfUniversal(1, [](pintle::UniversalJoint& universal) {
    universal.setLimit(5, -SIMD_PI, SIMD_PI);
    EXPECT_EQ(universal.getLowerLimit(5), -SIMD_PI);
    EXPECT_EQ(universal.getUpperLimit(5), SIMD_PI);
    EXPECT_TRUE(universal.isLimited(5)) << "as stock says";
  });
}

void expectWithin(const Turn& turn, double low, double high, double way) {
  EXPECT_GE(turn.lowest, low - 1e-3);
  EXPECT_LE(turn.highest, high + 1e-3);
  EXPECT_NEAR(way > 0 ? turn.highest : turn.lowest, way > 0 ? high : low, 1e-2);
}

TEST(FreeTurn, OtherRangesAreLimits) {
  const std::pair<double, double> ranges[] = {
      {-pi + 1e-3, pi - 1e-3}, {-pi, pi + 1e-3}, {0, 1.5 * pi}, {-1.25 * pi, 1.25 * pi}};
  for (const auto& [low, high] : ranges) {
    for (const double way : {1., -1.}) {
      SCOPED_TRACE(testing::Message() << low << " to " << high << ", " << way);
      expectWithin(turnOfHinge<pintle::QuaternionHinge>(way, limit_hinge(low, high)), low, high,
                   way);
      expectWithin(turnOfUniversal(way, limit_universal(low, high)), low, high, way);
    }
  }
}

TEST(FreeTurn, AWallAtHalfATurnIsAskedForByName) {
  for (const double way : {1., -1.}) {
    SCOPED_TRACE(way);
    const auto all = [](auto& joint) { joint.setAccumulatedLimit(-SIMD_PI, SIMD_PI); };
    expectWithin(turnOfHinge<pintle::QuaternionHinge>(way, all), -pi, pi, way);
    expectWithin(turnOfSlider<pintle::SliderJoint>(
                     way, [](auto& joint) { joint.setAccumulatedAngLimits(-SIMD_PI, SIMD_PI); }),
                 -pi, pi, way);
    expectWithin(
        turnOfUniversal(way, [](auto& joint) { joint.setAccumulatedLimit(5, -SIMD_PI, SIMD_PI); }),
        -pi, pi, way);
  }
}

TEST(FreeTurn, SettingsThatAreRefusedLeaveTheWall) {
  turnOfHinge<pintle::QuaternionHinge>(1, [](pintle::QuaternionHinge& hinge) {
    hinge.setAccumulatedLimit(-SIMD_PI, SIMD_PI);
    EXPECT_THROW(hinge.setAccumulatedLimit(support::nan_value, 1), std::invalid_argument);
    EXPECT_EQ(hinge.getUpperLimit(), SIMD_PI);
  });
}

}  // namespace
}  // namespace free_turn_test
