// Compound pendulums against the closed form of their period: the error falls with the time step at
// first order at least, and stays below that of Bullet's own joint in the same scene.
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <pintle/joints/ball_joint.h>
#include <scenes/pendulum.h>

#include <algorithm>
#include <vector>

#include "physics_support.h"
#include "solver_of_tests.h"

namespace physics_pendulum_test {

using physics::rounding;
using physics::vector;
using scenes::PendulumResult;
using scenes::PendulumSettings;

// A joint that takes no axis, in the place of a hinge.
template <class Ball>
struct BallAsHinge : Ball {
  BallAsHinge(btRigidBody& body, const btVector3& pivot, const btVector3&) : Ball(body, pivot) {}
};
using OurBall = BallAsHinge<pintle::BallJoint>;
using StockBall = BallAsHinge<btPoint2PointConstraint>;

struct Comparison {
  double dt;
  PendulumResult ours, stock;
};

template <class Ours, class Stock>
std::vector<Comparison> runs(PendulumSettings settings) {
  std::vector<Comparison> result;
  for (const double rate : {60, 120, 240, 500, 1000}) {
    settings.dt = 1 / rate;
    result.push_back(
        {settings.dt, scenes::pendulum<Ours>(settings), scenes::pendulum<Stock>(settings)});
  }
  return result;
}

// The slope of log error over log dt, by least squares.
template <class Error>
double order(const std::vector<Comparison>& all, Error error) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const Comparison& run : all) {
    const double log_dt = std::log(run.dt), log_error = std::log(std::abs(error(run)));
    n += 1;
    x += log_dt;
    y += log_error;
    xx += log_dt * log_dt;
    xy += log_dt * log_error;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

struct Case {
  const char* name;
  std::vector<Comparison> (*runs)(PendulumSettings);
  double amplitude, tilt;  // degrees

  PendulumSettings settings() const {
    PendulumSettings result;
    result.amplitude = scenes::radians(amplitude);
    result.tilt = scenes::radians(tilt);
    return result;
  }
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

class Pendulum : public testing::TestWithParam<Case> {};

std::string name(const testing::TestParamInfo<Case>& info) { return info.param.name; }

TEST_P(Pendulum, PeriodAndEnergyConvergeToTheClosedForm) {
  const std::vector<Comparison> all = GetParam().runs(GetParam().settings());
  const double period = order(all, [](const Comparison& run) { return run.ours.period_error; });
  const double energy = order(all, [](const Comparison& run) { return run.ours.max_energy_error; });
  RecordProperty("period_order", std::to_string(period));
  RecordProperty("energy_order", std::to_string(energy));
  // First order is asked for. The energy of symplectic Euler swings with dt in every period: its
  // order is 1 and no more, to within what the fit makes of 5 points.
  if (onExactSolver()) {
    // A twentieth of what it is on Bullet's solver at 60 Hz, and at shorter steps rounding.
    for (const Comparison& run : all) EXPECT_LT(std::abs(run.ours.period_error), 1e-3) << run.dt;
  } else {
    EXPECT_GE(period, 1);
  }
  EXPECT_GE(energy, 0.95);
  EXPECT_LT(std::abs(all.back().ours.period_error), 3e-4);
}

INSTANTIATE_TEST_SUITE_P(
    Amplitudes, Pendulum,
    testing::Values(Case{"Hinge10Level", runs<pintle::QuaternionHinge, btHingeConstraint>, 10, 0},
                    Case{"Hinge60Tilted", runs<pintle::QuaternionHinge, btHingeConstraint>, 60, 30},
                    Case{"Hinge170Level", runs<pintle::QuaternionHinge, btHingeConstraint>, 170, 0},
                    Case{"Ball60", runs<OurBall, StockBall>, 60, 0}),
    name);

// Swings so wide that stock's loss of energy decides its error. (In small ones two errors of stock,
// the integrator's and the lost swing's, have opposite signs and cancel at some step.)
class WidePendulum : public Pendulum {};

TEST_P(WidePendulum, IsCloserToTheClosedFormThanStockAtEveryStep) {
  // What 20000 steps in single precision add to the energy of either.
  const double energy_rounding = rounding(1e-4, 0);
  for (const Comparison& run : GetParam().runs(GetParam().settings())) {
    SCOPED_TRACE("1/dt = " + std::to_string(std::lround(1 / run.dt)));
    ASSERT_TRUE(run.ours.finite);
    EXPECT_LT(std::abs(run.ours.period_error), std::abs(run.stock.period_error));
    EXPECT_LT(run.ours.max_energy_error, run.stock.max_energy_error + energy_rounding);
    EXPECT_LT(run.ours.max_gap, run.stock.max_gap);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Amplitudes, WidePendulum,
    testing::Values(
        Case{"Hinge120Tilted", runs<pintle::QuaternionHinge, btHingeConstraint>, 120, 30},
        Case{"Hinge120Level", runs<pintle::QuaternionHinge, btHingeConstraint>, 120, 0},
        Case{"Hinge150Tilted", runs<pintle::QuaternionHinge, btHingeConstraint>, 150, 30},
        Case{"Ball120", runs<OurBall, StockBall>, 120, 0}),
    name);

// Symplectic Euler on the hinge angle itself: what is left when the joint adds no error.
double ideal_period(double inertia, double torque, double amplitude, double dt, double seconds) {
  double angle = amplitude, speed = 0, first = 0, last = 0;
  int passes = 0;
  for (int step = 1; step <= std::lround(seconds / dt); ++step) {
    const double before = angle;
    speed -= dt * torque / inertia * std::sin(angle);
    angle += dt * speed;
    if (before < 0 && angle >= 0) {
      last = (step - 1 - before / (angle - before)) * dt;
      if (passes++ == 0) first = last;
    }
  }
  return (last - first) / (passes - 1);
}

TEST(SmallPendulum, HasThePeriodOfTheIntegratorAndNoErrorOfItsOwn) {
  PendulumSettings settings;
  settings.amplitude = scenes::radians(10);
  settings.tilt = 0;
  for (const double rate : {60, 120, 240}) {
    settings.dt = 1 / rate;
    const PendulumResult ours = scenes::pendulum<pintle::QuaternionHinge>(settings);
    const double inertia = (0.25 + 0.01) / 3 + 0.25, torque = scenes::standard_gravity * 0.5;
    const double ideal =
        ideal_period(inertia, torque, settings.amplitude, settings.dt, settings.seconds);
    // The joint's own error is to be a small part, 1/15, of the integrator's (w dt)^2 / 24. Single
    // precision times the passes to 1e-6.
    const double integrators = torque / inertia * settings.dt * settings.dt / 24;
    EXPECT_NEAR(ours.period / ideal, 1, integrators / 15 + rounding(1e-6, 0)) << rate << " Hz";
  }
}

// m, from the centre: no principal direction, and not in the swing's plane.
const Eigen::Vector3d offset_pivot(0.3, -0.4, 0.5);

struct OffsetRun {
  double period_error;
  double max_energy_error;
};

// A cube of 2 kg on a ball at a general point. All its moments of inertia are equal, so that it
// swings in one plane, whichever that is.
template <class Ball>
OffsetRun offset_pendulum(double amplitude, double heading, double dt) {
  const double mass = 2, arm = offset_pivot.norm();
  const Eigen::Vector3d level(std::cos(heading), std::sin(heading), 0), up(0, 0, 1);
  const Eigen::Vector3d start = arm * (std::sin(amplitude) * level - std::cos(amplitude) * up);
  const Eigen::Quaterniond turn = scenes::turn_between(-offset_pivot, start);
  scenes::World world;
  btRigidBody& cube = world.add_box(
      mass, vector(0.2, 0.2, 0.2),
      btTransform(scenes::matrix_to_bullet(turn.toRotationMatrix()), scenes::to_bullet(start)));
  world.add_joint<Ball>(cube, scenes::to_bullet(offset_pivot));

  const double torque = mass * scenes::standard_gravity * arm;
  const double inertia = double(cube.getLocalInertia().x()) + mass * arm * arm;
  const double start_energy = scenes::energy(cube, scenes::standard_gravity);
  OffsetRun result = {};
  double last = arm, first_pass = 0, last_pass = 0;
  int passes = 0;
  for (int step = 1; step <= std::lround(20 / dt); ++step) {
    world.step(dt);
    const double across = scenes::position(cube).dot(level);
    if (last < 0 && across >= 0 && scenes::position(cube).z() < 0) {
      last_pass = (step - 1 - last / (across - last)) * dt;
      if (passes++ == 0) first_pass = last_pass;
    }
    last = across;
    result.max_energy_error =
        std::max(result.max_energy_error,
                 std::abs(scenes::energy(cube, scenes::standard_gravity) - start_energy) /
                     (torque * (1 - std::cos(amplitude))));
  }
  result.period_error = (last_pass - first_pass) / (passes - 1) /
                            scenes::pendulum_period(inertia, torque, amplitude) -
                        1;
  return result;
}

TEST(BallPendulum, AboutAnOffsetPivotConvergesAndIsCloserThanStock) {
  for (const double heading : {0., 2.}) {
    std::vector<double> errors;
    for (const double rate : {60, 120, 240, 480}) {
      const auto ours = offset_pendulum<pintle::BallJoint>(scenes::radians(100), heading, 1 / rate);
      const auto stock =
          offset_pendulum<btPoint2PointConstraint>(scenes::radians(100), heading, 1 / rate);
      SCOPED_TRACE(std::to_string(rate) + " Hz");
      EXPECT_LT(std::abs(ours.period_error), std::abs(stock.period_error));
      EXPECT_LT(ours.max_energy_error, stock.max_energy_error);
      errors.push_back(std::abs(ours.period_error));
    }
    // 8 times the steps: first order is an 8th.
    EXPECT_LT(errors.back(), errors.front() / 8);
  }
}

// Mean over the last 5 s of a minute: its energy swings within each period. `ahead`: by how much of a step velocities are ahead of
// poses, which over no whole number of periods has a mean of first order.
template <class Hinge>
double late_energy(double rate, double ahead = 0) {
  const double arm = 0.5, amplitude = scenes::radians(120);
  scenes::World world;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(scenes::radians(90) - amplitude, Eigen::Vector3d(0, 1, 0))
          .toRotationMatrix();
  btRigidBody& box = world.add_box(
      1, vector(arm, 0.1, 0.1),
      btTransform(scenes::matrix_to_bullet(turn), scenes::to_bullet(turn.col(0) * arm)));
  world.add_joint<Hinge>(box, vector(-arm, 0, 0), vector(0, 1, 0));
  const double start = scenes::energy(box, scenes::standard_gravity);
  const int steps = int(60 * rate), late = int(5 * rate);
  double sum = 0;
  for (int step = 0; step < steps; ++step) {
    world.step(1 / rate);
    if (step >= steps - late)
      sum += scenes::energy(box, scenes::standard_gravity) - start -
             ahead / rate * scenes::standard_gravity * double(box.getLinearVelocity().z());
  }
  return sum / late / (scenes::standard_gravity * arm * (1 - std::cos(amplitude)));
}

TEST(LongPendulum, DriftsLessInEnergyThanStockAndEverLessAtShorterSteps) {
  double before = HUGE_VAL;
  for (const double rate : {60, 120, 240}) {
    const double ours = late_energy<pintle::QuaternionHinge>(rate, onExactSolver() ? 0.5 : 0);
    const double stock = late_energy<btHingeConstraint>(rate);
    RecordProperty("energy_after_60_s_at_" + std::to_string(std::lround(rate)) + "_Hz",
                   std::to_string(ours) + ", stock " + std::to_string(stock));
    EXPECT_LT(std::abs(ours), std::abs(stock)) << rate << " Hz";
    if (onExactSolver()) {
      // Not as much as the integrator's own error, (w dt)^2 / 24.
      const double inertia = (0.25 + 0.01) / 3 + 0.25, torque = scenes::standard_gravity * 0.5;
      EXPECT_LT(std::abs(ours), torque / inertia / (rate * rate) / 24) << rate;
      continue;
    }
    // Second order at least.
    EXPECT_LT(std::abs(ours), before / 4) << rate << " Hz";
    before = std::abs(ours);
  }
}

}  // namespace physics_pendulum_test
