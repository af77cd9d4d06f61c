// The reference solutions: the integrator against closed forms, and what is stored against it.
#include <gtest/gtest.h>
#include <measures/run.h>
#include <reference/integrator.h>
#include <reference/stored.h>
#include <scenes/catalog.h>

#include <stdexcept>

namespace {

using scenes::Scene;
using scenes::Vector3d;

double difference(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  double most = 0;
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

TEST(Reference, SpringFollowsItsClosedForm) {
  const Scene scene = scenes::spring_scene();
  const reference::Solution solution = reference::solve(scene, 1e-3, measures::sample_interval);
  EXPECT_LT(difference(solution.probe, measures::reference(scene)), 1e-7);
}

TEST(Reference, FixedBoxesStay) {
  const Scene scene = scenes::cantilever_scene();
  const reference::Solution solution = reference::solve(scene, 5e-3, measures::sample_interval);
  EXPECT_LT(difference(solution.probe, measures::reference(scene)), 1e-12);
}

/// T = 2 pi sqrt(I / (m g d)) / AGM(1, cos(amplitude / 2)): after T it is where it began.
TEST(Reference, PendulumHasItsPeriod) {
  Scene scene = scenes::pendulum_scene();
  const double d = 0.5, inertia = (0.25 + 0.01) / 3 + d * d;
  double a = 1, b = std::cos(scenes::radians(60));
  for (int i = 0; i < 8; ++i) {
    const double mean = (a + b) / 2;
    b = std::sqrt(a * b);
    a = mean;
  }
  const double torque = scenes::standard_gravity * std::cos(scenes::radians(30)) * d;
  const double period = 2 * scenes::pi * std::sqrt(inertia / torque) / a;
  const scenes::Body& bob = scene.bodies[1];
  scene.horizon = period;
  const reference::Solution solution = reference::solve(scene, 1e-3, period);
  ASSERT_EQ(solution.probe.size(), 1u);
  EXPECT_LT((solution.probe[0] - bob.pose * scene.probe).norm(), 1e-8);
}

TEST(Reference, ConvergesWithTheFourthOrder) {
  Scene scene = scenes::free_pair_scene();
  scene.horizon = 1;
  const auto at = [&](double dt) { return reference::solve(scene, dt, 0.1).probe; };
  const std::vector<Vector3d> fine = at(1. / 3200);
  const double coarse = difference(at(1. / 50), fine), half = difference(at(1. / 100), fine);
  EXPECT_NEAR(std::log2(coarse / half), 4, 0.3);
}

/// Bullet moves bodies by the velocity of the step's end: what starts from rest runs half a step ahead.
TEST(Reference, BulletsStepsAreHalfAStepAhead) {
  for (Scene scene : {scenes::pendulum_scene(), scenes::four_bar_scene()}) {
    SCOPED_TRACE(scene.name);
    constexpr double dt = 1. / 60;
    constexpr int steps = 60;
    scene.horizon = (steps + 1) * dt;
    const std::vector<Vector3d> wanted =
        reference::solve(scene, 1e-3, dt / 2).probe;  // from dt / 2 on
    const auto engine = reference::make_bullet_steps(scene);
    double error = 0, error_half_a_step_later = 0;
    for (int step = 1; step <= steps; ++step) {
      engine->step(dt);
      const Vector3d probe = engine->state(scene.probe_body).pose * scene.probe;
      error += (probe - wanted[size_t(2 * step - 1)]).norm();
      error_half_a_step_later += (probe - wanted[size_t(2 * step)]).norm();
    }
    EXPECT_LT(error_half_a_step_later, 0.2 * error);
  }
}

TEST(Reference, IsStoredForEverySceneThatNeedsIt) {
  for (Scene scene : scenes::catalog()) {
    if (!scene.has(scenes::Error::trajectory) || scene.closed_form) continue;
    SCOPED_TRACE(scene.name);
    const int samples = int(std::lround(scene.horizon / measures::sample_interval));
    const std::vector<Vector3d> stored = reference::stored(scene.name, samples);
    scene.horizon = 0.2;
    const reference::Solution solution = reference::solve(scene, 2e-4, measures::sample_interval);
    EXPECT_LT(difference(solution.probe, stored), 1e-6);
  }
}

TEST(Reference, RefusesWhatItDoesNotSolve) {
  EXPECT_THROW(reference::solve(scenes::ragdoll_scene(), 1e-3, 0.05), std::invalid_argument);
  EXPECT_THROW(reference::solve(scenes::steering_scene(), 1e-3, 0.05), std::invalid_argument);
  EXPECT_THROW(reference::solve(scenes::cone_shoulder_scene(), 1e-3, 0.05), std::invalid_argument);
  EXPECT_THROW(reference::solve(scenes::recovery_scene(), 1e-3, 0.05), std::invalid_argument);
  EXPECT_THROW(reference::solve(scenes::bounce_scene(), 1e-3, 0.05), std::invalid_argument);
  EXPECT_THROW(reference::make_bullet_steps(scenes::ragdoll_scene()), std::invalid_argument);
  EXPECT_THROW(reference::stored("no scene", 1), std::runtime_error);
}

}  // namespace
