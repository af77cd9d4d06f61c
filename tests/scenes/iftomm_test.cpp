// Two problems of the IFToMM library of multibody benchmarks on the exact solver: Bricard's
// mechanism (A04) and the stiff flyball governor (A05). What is left of their errors is of Bullet's
// steps: its gyroscopic term, which takes energy away, and velocities of the middle of a step.
#include <engines/bullet.h>
#include <gtest/gtest.h>
#include <measures/run.h>
#include <pintle/solver/exact_joint_solver.h>
#include <reference/integrator.h>
#include <scenes/catalog.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace iftomm {
namespace {

using engines::State;
using scenes::Scene;
using scenes::Vector3d;

constexpr bool is_double = sizeof(btScalar) == sizeof(double);

// Whose gyroscopic term the bodies have.
enum class Gyroscopic {
  bullets,       // implicit, of first order: what turns loses energy
  of_the_middle  // of second order: at the velocity between two steps, extrapolated
};

class Course {
 public:
  Course(const Scene& scene, double dt, Gyroscopic gyroscopic = Gyroscopic::bullets)
      : dt_(dt),
        gyroscopic_(gyroscopic),
        engine_(engines::make_bullet(scene, 10, engines::make_conditioned_joint,
                                     [] { return std::make_unique<pintle::ExactJointSolver>(); })) {
    if (gyroscopic == Gyroscopic::bullets) return;
    for (size_t i = 0; i < scene.bodies.size(); ++i) {
      btRigidBody& body = engine_->body(int(i));
      body.setFlags(0);
      before_.push_back(in_body(body));
    }
  }

  void step() {
    if (gyroscopic_ == Gyroscopic::of_the_middle) push();
    engine_->drive(time(), dt_);
    engine_->step(dt_);
    ++steps_;
  }
  double time() const { return steps_ * dt_; }
  bool before(double seconds) const { return time() < seconds - dt_ / 2; }
  std::vector<State> states(const Scene& scene) const {
    std::vector<State> all;
    for (size_t i = 0; i < scene.bodies.size(); ++i) all.push_back(engine_->state(int(i)));
    return all;
  }
  const engines::Engine& engine() const { return *engine_; }

 private:
  static btVector3 in_body(const btRigidBody& body) {
    return body.getAngularVelocity() * body.getWorldTransform().getBasis();
  }
  void push() {
    for (size_t i = 1; i < before_.size(); ++i) {
      btRigidBody& body = engine_->body(int(i));
      const btVector3 w = in_body(body), middle = btScalar(1.5) * w - btScalar(0.5) * before_[i];
      before_[i] = w;
      body.applyTorque(body.getWorldTransform().getBasis() *
                       (body.getLocalInertia() * middle).cross(middle));
    }
  }

  double dt_;
  int steps_ = 0;
  Gyroscopic gyroscopic_;
  std::unique_ptr<engines::BulletEngine> engine_;
  std::vector<btVector3> before_;  // angular velocities of the step before, in the bodies
};

// Over the largest kinetic energy, which a scene from rest has as its energy_scale.
struct EnergyChange {
  double as_it_stands = 0;  // of positions and of velocities that lag by half a step
  double in_step = 0;       // of velocities where they belong, dt v / 2 before their positions
};

EnergyChange energy_change(const Scene& scene, double hz, Gyroscopic gyroscopic) {
  Course run(scene, 1 / hz, gyroscopic);
  const double start = measures::energy(scene, run.states(scene));
  EnergyChange change;
  while (run.before(scene.seconds)) {
    run.step();
    std::vector<State> states = run.states(scene);
    change.as_it_stands =
        std::max(change.as_it_stands, std::abs(measures::energy(scene, states) - start));
    for (State& of : states) of.pose.translation() -= of.velocity / (2 * hz);
    change.in_step = std::max(change.in_step, std::abs(measures::energy(scene, states) - start));
  }
  return {change.as_it_stands / scene.energy_scale, change.in_step / scene.energy_scale};
}

/// Five bodies have thirty freedoms, and six hinges thirty rows: one motion is left.
TEST(Bricard, ClosesAndMovesInItsOneFreedom) {
  const Scene scene = scenes::named("bricard");
  Course run(scene, 1. / 60);
  double least = 1;
  const double gap = is_double ? 1e-8 : 1e-4;
  while (run.before(scene.seconds)) {
    const std::vector<State> states = run.states(scene);
    Eigen::Matrix<double, 30, 36> J = Eigen::Matrix<double, 30, 36>::Zero();
    for (size_t i = 0; i < scene.joints.size(); ++i) {
      const scenes::Joint& joint = scene.joints[i];
      for (const bool of_b : {false, true}) {
        const int body = of_b ? joint.b : joint.a, row = 5 * int(i), column = 6 * body;
        if (body == 0) continue;
        const double sign = of_b ? 1 : -1;
        const Eigen::Matrix3d& R = states[size_t(body)].pose.linear();
        const Vector3d arm = R * (of_b ? joint.in_b : joint.in_a).translation();
        const Eigen::Matrix3d axes = states[size_t(joint.a)].pose.linear() * joint.in_a.linear();
        for (int k = 0; k < 3; ++k) {
          J(row + k, column + k) = sign;
          J.block<1, 3>(row + k, column + 3) = sign * arm.cross(Vector3d::Unit(k)).transpose();
        }
        J.block<2, 3>(row + 3, column + 3) = sign * axes.leftCols<2>().transpose();
      }
    }
    Eigen::FullPivLU<Eigen::MatrixXd> factors(J);
    factors.setThreshold(is_double ? 1e-6 : 1e-3);
    ASSERT_EQ(factors.rank(), 29) << run.time();
    ASSERT_LT(measures::gaps(scene, run.engine()).largest, gap) << run.time();
    run.step();
    least = std::min(least, (states[size_t(scene.probe_body)].pose * scene.probe).x());
  }
  EXPECT_NEAR(least, -1, 0.02);  // to the other side
}

/// Wanted: 1e-2 at 60 Hz, 1e-3 at 1000 Hz. As it stands it is 2.6e-2, 5.6e-3 (240 Hz) and 1.3e-3;
/// in step 2.1e-2, 4.1e-3 and 0.99e-3. That is lost to Bullet's gyroscopic term, and by joints that
/// leave nothing almost as much (make_bullet_steps: 1.6e-2, 4.1e-3, 0.99e-3). With a term of second
/// order the solver keeps both bounds.
TEST(Bricard, KeepsItsEnergyInStep) {
  if (!is_double) GTEST_SKIP() << "the bounds are for double precision";
  const Scene scene = scenes::named("bricard");
  EXPECT_LT(energy_change(scene, 60, Gyroscopic::bullets).in_step, 2.2e-2);
  EXPECT_LT(energy_change(scene, 240, Gyroscopic::bullets).in_step, 4.3e-3);
  const EnergyChange fine = energy_change(scene, 1000, Gyroscopic::bullets);
  EXPECT_LT(fine.in_step, 1e-3);
  EXPECT_LT(fine.as_it_stands, 1.4e-3);
  EXPECT_LT(energy_change(scene, 60, Gyroscopic::of_the_middle).in_step, 1e-2);
  EXPECT_LT(energy_change(scene, 240, Gyroscopic::of_the_middle).in_step, 2e-3);
  EXPECT_LT(energy_change(scene, 1000, Gyroscopic::of_the_middle).in_step, 1e-3);
}

/// The largest distance of P3 from the stored solution.
TEST(Bricard, FollowsTheReference) {
  const Scene scene = scenes::named("bricard");
  const std::vector<Vector3d> wanted = measures::reference(scene);
  const auto distance = [&](double hz) {
    Course run(scene, 1 / hz);
    double most = 0;
    for (const Vector3d& at : wanted) {
      for (long i = std::lround(measures::sample_interval * hz); i > 0; --i) run.step();
      const State state = run.engine().state(scene.probe_body);
      most = std::max(most, (state.pose * scene.probe - at).norm());
    }
    return most;
  };
  EXPECT_LT(distance(60), 0.02);
  if (!is_double) return;
  EXPECT_LT(distance(1000), 8e-4);
}

// The governor by two coordinates: the rods' angle below the horizontal, and the slider's height.
// The shaft turns by the angular momentum, which stays.
class Governor {
 public:
  static constexpr double step = 1e-5;  // s

  // Heights of the slider, every step.
  std::vector<double> heights(double seconds) const {
    State at = {scenes::radians(30), 0.5, 0, 0};
    std::vector<double> all = {at[1]};
    while (double(all.size()) * step < seconds + 1.5 * step) {
      const State k1 = slope(at), k2 = slope(moved(at, k1, step / 2)),
                  k3 = slope(moved(at, k2, step / 2)), k4 = slope(moved(at, k3, step));
      for (size_t i = 0; i < at.size(); ++i)
        at[i] += step / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
      all.push_back(at[1]);
    }
    return all;
  }

 private:
  using State = std::array<double, 4>;  // angle, height, and their rates

  static constexpr double rod = 0.3, weight = 5, slider = 3, square = 1e-4;  // kg, m^2
  static constexpr double stiffness = 8e5, damping = 4e4, rest = 0.5, pin = 0.05, gravity = 9.81;
  // Of a rod about its middle, across and along.
  static constexpr double across = rod * (1 + square) / 12, along = rod * square / 6;

  // About the shaft, of all bodies; a weight is a point.
  static double inertia(double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    const double middle = pin + c / 2, end = pin + c;
    return rod * square / 6 + slider * 0.01 / 6 +
           2 * (rod * middle * middle + across * c * c + along * s * s + weight * end * end);
  }
  static double inertia_slope(double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return -2 * s * (rod * (pin + c / 2) + 2 * (across - along) * c + 2 * weight * (pin + c));
  }

  State slope(const State& at) const {
    const double c = std::cos(at[0]), s = std::sin(at[0]);
    const double out = c / 2, up = 1 - s / 2 - at[1];  // of a rod's middle from the slider
    const double length = std::hypot(out, up);
    const double by_angle = -(s / 2 * out + c / 2 * up) / length, by_height = -up / length;
    const double tension =
        stiffness * (length - rest) + damping * (by_angle * at[2] + by_height * at[3]);
    const double turning = momentum_ / inertia(at[0]);
    const double about_pin = across + rod / 4 + weight;
    return {at[2], at[3],
            (inertia_slope(at[0]) * turning * turning / 4 + gravity * c * (rod / 2 + weight) -
             tension * by_angle) /
                about_pin,
            -gravity - 2 * tension * by_height / slider};
  }
  static State moved(State at, const State& slope, double by) {
    for (size_t i = 0; i < at.size(); ++i) at[i] += by * slope[i];
    return at;
  }

  double momentum_ = 2 * scenes::pi * inertia(scenes::radians(30));
};

/// The stored solution and that by two coordinates share nothing but the problem.
TEST(Governor, IsSolvedAlikeByTwoMethods) {
  const Scene scene = scenes::named("governor");
  const std::vector<Vector3d> stored = measures::reference(scene);
  const std::vector<double> heights = Governor().heights(scene.seconds);
  const long every = std::lround(measures::sample_interval / Governor::step);
  for (size_t i = 0; i < stored.size(); ++i) {
    const double wanted = heights[(i + 1) * size_t(every)];
    ASSERT_LT((stored[i] - Vector3d(0, 0, wanted)).norm(), 1e-9) << i;
  }
}

/// Wanted: 1e-3 m at 60 Hz. Bullet's steps leave 9.9e-3 with joints that leave nothing, and are of first order: no joint can do better. On
/// the exact solver it is 9.9e-3, 3.1e-3 (240 Hz) and 8.1e-4 (1000 Hz). Most of that is time: forces of the start act for the whole step,
/// and the slider is 0.64, 0.86 and 0.92 steps late. Beside that it errs by 2.5e-3, 4.3e-4 and 1.2e-4.
TEST(Governor, LiftsItsSliderLikeTheReference) {
  const Scene scene = scenes::named("governor");
  const std::vector<double> heights = Governor().heights(scene.seconds);
  // Of the slider, if it is late by so many steps.
  const auto distance_of = [&](engines::Engine& engine, double hz, double late) {
    double most = 0;
    for (int step = 1; step <= std::lround(scene.seconds * hz); ++step) {
      engine.step(1 / hz);
      const double time = std::max(0., (step - late) / hz);
      const double wanted = heights[size_t(std::lround(time / Governor::step))];
      const Vector3d at = engine.state(scene.probe_body).pose.translation();
      most = std::max(most, (at - Vector3d(0, 0, wanted)).norm());
    }
    return most;
  };
  const auto distance = [&](double hz, double late) {
    return distance_of(*engines::find_contender("exact")->make(scene, 10), hz, late);
  };
  EXPECT_LT(distance(60, 0), is_double ? 1.1e-2 : 2e-2);
  if (!is_double) return;
  EXPECT_LT(distance(60, 0.64), 2.6e-3);
  EXPECT_LT(distance(240, 0), 3.2e-3);
  EXPECT_LT(distance(240, 0.86), 5e-4);
  EXPECT_LT(distance(1000, 0), 8.5e-4);
  EXPECT_LT(distance(1000, 0.92), 1.5e-4);
  for (const double hz : {60., 240., 1000.}) {
    const double of_steps = distance_of(*reference::make_bullet_steps(scene), hz, 0);
    EXPECT_GT(of_steps, hz == 60 ? 9e-3 : 1e-4);
    EXPECT_LT(distance(hz, 0), 1.25 * of_steps) << hz;
  }
}

}  // namespace
}  // namespace iftomm
