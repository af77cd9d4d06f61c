// Jolt as a peer: its joints, motors, limits, springs and bodies are those of the scenes, in sign, place and size.
#include <gtest/gtest.h>

#include <chrono>

#include "engines/peers.h"
#include "measures/run.h"
#include "scenes/catalog.h"

using engines::State;
using scenes::Kind;
using scenes::Scene;
using scenes::Vector3d;

namespace {

constexpr int iterations = 60;

// The states of all bodies after some time.
std::vector<State> end(Scene scene, double seconds, double hz = 240) {
  scene.seconds = seconds;
  scene.errors = {};
  return measures::run(scene, *engines::make_jolt(scene, iterations), 1 / hz).end;
}

measures::Outcome first_second(Scene scene, double hz) {
  scene.seconds = scene.horizon = 1;
  scene.errors = {scenes::Error::trajectory, scenes::Error::axis};
  return measures::run(scene, *engines::make_jolt(scene, iterations), 1 / hz);
}

// One box of 2 kg, without gravity.
Scene box_scene() {
  Scene scene;
  scene.name = "box";
  scene.gravity = 0;
  scene.add(scenes::box(2, {0.3, 0.1, 0.2}, {0, 0, 0}));
  return scene;
}

/// Jolt's steps are of first order: a quarter of the length leaves a quarter of the error. By closed forms: a motor, two balls
/// and a slider; a motor and a universal joint; a slider's spring. By stored solutions: hinges, and balls.
TEST(Jolt, TendsToWhatIsTrue) {
  for (const char* name : {"slider_crank", "drive_shaft", "spring", "pendulum", "chain",
                           "chain_heavy", "top", "free_pair", "four_bar"}) {
    const Scene scene = scenes::named(name);
    const auto coarse = first_second(scene, 240), fine = first_second(scene, 960);
    const auto trajectory = scenes::Error::trajectory;
    EXPECT_LT(fine[trajectory], 0.4 * coarse[trajectory]) << name;
    EXPECT_LT(fine[trajectory], 0.02) << name;
    EXPECT_LT(fine[scenes::Error::axis], 1e-3) << name;
  }
}

TEST(Jolt, HoldsABeamOfFixedJoints) {
  const Scene scene = scenes::named("cantilever");
  const auto bodies = end(scene, 0.5, 960);
  for (size_t i = 1; i < bodies.size(); ++i) {
    const double sunk = (bodies[i].pose.translation() - scene.bodies[i].pose.translation()).norm();
    EXPECT_LT(sunk, 1e-3) << i;
  }
}

/// A weight hangs from a rope, which gives by its spring.
TEST(Jolt, HoldsADistance) {
  for (const double frequency : {0., 2.}) {  // Hz
    Scene scene = box_scene();
    scene.gravity = scenes::standard_gravity;
    scenes::Joint& rope = scene.connect(Kind::distance, 0, 1, scenes::at({0, 0, 0}));
    rope.in_a = scenes::at({0, 0, 0.5});
    rope.range = {0.5, 0.5};
    rope.spring = {frequency, 1};
    const double w = 2 * scenes::pi * frequency;
    const double sag = frequency > 0 ? scenes::standard_gravity / (w * w) : 0;
    EXPECT_NEAR(end(scene, 3)[1].pose.translation().z(), -sag, 1e-3) << frequency;
  }
}

TEST(Jolt, StopsAtEachLimitOfACone) {
  const scenes::Spans spans = {0.8, 0.6, 0.5};  // about z, about y, twist
  for (const double sign : {-1., 1.}) {
    const struct {
      Vector3d axis;
      double span;
    } ways[] = {{Vector3d::UnitX(), spans.twist},
                {Vector3d::UnitY(), spans.about_y},
                {Vector3d::UnitZ(), spans.about_z}};
    for (const auto& [axis, span] : ways) {
      Scene scene = scenes::cone_shoulder_scene(spans, 4 * sign * axis);
      scene.gravity = scene.bodies[1].damping = 0;
      const Eigen::AngleAxisd turn(end(scene, 1)[1].pose.linear());
      EXPECT_NEAR(turn.angle() * turn.axis().dot(axis), sign * span, 2e-3) << axis.transpose();
    }
  }
}

TEST(Jolt, StopsAtEachLimitOfAHingeAndASlider) {
  for (const double sign : {-1., 1.}) {
    Scene hinged = box_scene(), sliding = box_scene();
    const scenes::Range range = {-0.3, 0.5};
    hinged.bodies[1].angular_velocity = {0, 0, 2 * sign};
    hinged.connect(Kind::hinge, 0, 1, scenes::at({0, 0, 0})).range = range;
    const Eigen::Matrix3d turned = end(hinged, 1)[1].pose.linear();
    EXPECT_NEAR(std::atan2(turned(1, 0), turned(0, 0)), sign < 0 ? range.low : range.high, 2e-3);
    sliding.bodies[1].velocity = {2 * sign, 0, 0};
    sliding.connect(Kind::slider, 0, 1, scenes::at({0, 0, 0})).range = range;
    EXPECT_NEAR(end(sliding, 1)[1].pose.translation().x(), sign < 0 ? range.low : range.high, 2e-3);
  }
}

/// Until it has reached its speed, a motor turns or pushes with all that it has.
TEST(Jolt, DrivesBothWaysWithNoMoreThanTheMotorHas) {
  for (const double sign : {-1., 1.}) {
    const scenes::Motor motor = {[sign](double) { return 3 * sign; }, 0.1};
    Scene hinged = box_scene(), sliding = box_scene();
    hinged.connect(Kind::hinge, 0, 1, scenes::at({0, 0, 0})).motor = motor;
    sliding.connect(Kind::slider, 0, 1, scenes::at({0, 0, 0})).motor = motor;
    EXPECT_NEAR(end(hinged, 0.5)[1].angular_velocity.z(),
                sign * 0.5 * 0.1 / hinged.bodies[1].inertia.z(), 1e-3);
    EXPECT_NEAR(end(hinged, 3)[1].angular_velocity.z(), 3 * sign, 1e-3);
    EXPECT_NEAR(end(sliding, 0.5)[1].velocity.x(), sign * 0.5 * 0.1 / 2, 1e-4);
  }
}

/// A second body's joint is seen from the first one: with b the ground all turns are the other way.
TEST(Jolt, TakesAnglesOfBAgainstA) {
  Scene scene = box_scene();
  scene.connect(Kind::hinge, 1, 0, scenes::at({0, 0, 0})).motor = {[](double) { return 2.; }, 100};
  EXPECT_NEAR(end(scene, 0.5)[1].angular_velocity.z(), -2, 1e-3);
}

TEST(Jolt, HasDampingTorqueAndInertiaOfTheScene) {
  Scene scene = box_scene();
  scene.bodies[1].damping = 0.6;
  scene.bodies[1].velocity = {1, 0, 0};
  EXPECT_NEAR(end(scene, 1)[1].velocity.x(), 0.4, 1e-4);
  for (int axis = 0; axis < 3; ++axis) {
    Scene pushed = box_scene();
    pushed.bodies[1].torque = 0.1 * Vector3d::Unit(axis);
    EXPECT_NEAR(end(pushed, 1)[1].angular_velocity[axis], 0.1 / pushed.bodies[1].inertia[axis],
                1e-3);
  }
}

/// Of two bodies Bullet takes the product of their frictions.
TEST(Jolt, SlidesOnTheGroundWithTheirFriction) {
  Scene scene;
  scene.name = "slide";
  scene.bodies[0] = scenes::solid(scenes::box(0, {20, 20, 1}, {0, 0, -1}));
  scene.bodies[0].friction = 0.8;
  const int box = scene.add(scenes::solid(scenes::box(2, {0.5, 0.5, 0.1}, {0, 0, 0.1})));
  scene.bodies[size_t(box)].velocity = {3, 0, 0};
  EXPECT_NEAR(end(scene, 0.5)[1].velocity.x(), 3 - 0.5 * 0.4 * scenes::standard_gravity, 0.05);
}

TEST(Jolt, KeepsItsWorldsApartAndHasAClock) {
  const Scene chain = scenes::named("chain"), spring = scenes::named("spring");
  const auto alone = end(chain, 0.1);
  const auto one = engines::make_jolt(chain, iterations), other = engines::make_jolt(spring, 1);
  for (int step = 0; step < 24; ++step) {
    for (const auto& engine : {one.get(), other.get()}) {
      engine->drive(step / 240., 1 / 240.);
      engine->step(1 / 240.);
    }
  }
  for (size_t i = 0; i < alone.size(); ++i)
    EXPECT_EQ(one->state(int(i)).pose.matrix(), alone[i].pose.matrix()) << i;
  const auto before = std::chrono::steady_clock::now();
  one->step(1 / 240.);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - before;
  ASSERT_TRUE(one->step_seconds().has_value());
  EXPECT_GT(*one->step_seconds(), 0);
  EXPECT_LT(*one->step_seconds(), taken.count());
}

TEST(Jolt, LeavesOutWhatItHasNoJointFor) {
  for (const char* name : {"constant_velocity", "wedge_acute", "bounce", "gear_train",
                           "hinge_turns", "slider_rebound", "brick_wall", "stairs"})
    EXPECT_EQ(engines::make_jolt(scenes::named(name), 1), nullptr) << name;
}

}  // namespace
