// Where velocities go in the next step.
#include <pintle/solver/cache/velocity_forecast.h>

#include <gtest/gtest.h>

#include <cmath>

namespace exact_velocity_forecast_test {

using pintle::IslandBody;
using pintle::Vector6d;
using pintle::VelocityForecast;

// A body whose velocity at the end of a step, at time t, is along(t) in all linear, and about(t) in all angular parts.
class Course {
 public:
  Course() : m_body() { m_body.scale[0] = m_body.scale[1] = 1; }
  template <class Along, class About>
  void go(int steps, const Along& along, const About& about, bool was_enough = false) {
    for (int i = 0; i < steps; ++i) {
      m_body.v0 = m_v;
      m_v.head<3>().setConstant(along(m_time));
      m_v.tail<3>().setConstant(about(m_time));
      m_forecast.take(&m_body, {m_v}, {m_v}, m_dt, was_enough);
      m_time += m_dt;
    }
  }
  void changeStep(double dt) {
    m_time += dt - m_dt;
    m_dt = dt;
  }
  // Of the end of the next step, of which the velocity is foreseen.
  double time() const { return m_time; }
  double alongError(double expected) const { return error(0, expected); }
  double aboutError(double expected) const { return error(3, expected); }

 private:
  double error(int i, double expected) const {
    return std::abs(m_v[i] + m_forecast.change(0, m_dt)[i] - expected);
  }

  IslandBody m_body;
  Vector6d m_v = Vector6d::Zero();
  VelocityForecast m_forecast;
  double m_time = 0, m_dt = 1;
};

// Each half by itself.
TEST(VelocityForecast, IsExactOfPolynomials) {
  const auto quartic = [](double n) { return 3 - n + 0.2 * n * n - 0.01 * std::pow(n, 4); };
  const auto line = [](double n) { return 2 - 7 * n; };
  Course course;
  course.go(12, quartic, line);
  EXPECT_LT(course.alongError(quartic(12)), 1e-9);
  EXPECT_LT(course.aboutError(line(12)), 1e-9);
}

TEST(VelocityForecast, IsFarNearerThanTheLastChangeWhereBodiesSwing) {
  const auto swing = [](double n) { return std::sin(0.1 * n); };
  double far = 0, near = 0;
  for (int steps = 20; steps < 80; ++steps) {
    Course course;
    course.go(steps, swing, swing);
    near += course.alongError(swing(steps));
    far += std::abs(2 * swing(steps - 1) - swing(steps - 2) - swing(steps));
  }
  EXPECT_LT(near, far / 20);
}

// Its differences would make it larger, by up to 8 times.
TEST(VelocityForecast, DoesNotGoOnByRounding) {
  const auto shakes = [](double n) { return std::fmod(n, 2) == 0 ? 1e-9 : -1e-9; };
  const auto line = [](double n) { return 3 * n; };
  Course course;
  course.go(
      12, [&](double n) { return line(n) + shakes(n); }, line);
  EXPECT_LT(course.alongError(line(12)), 6e-9);
}

// Where one solve has led to the end, the last change is enough, and nothing else is looked after. Where it has not, more are found again.
TEST(VelocityForecast, HasNoMoreDifferencesThanAreNeeded) {
  const auto square = [](double n) { return 0.3 * n * n; };
  Course course;
  course.go(10, square, square, true);
  EXPECT_NEAR(course.alongError(square(10)), 0.6, 1e-9);
  course.go(6, square, square);
  EXPECT_LT(course.alongError(square(16)), 1e-9);
  course.go(6, square, square, true);
  EXPECT_LT(course.alongError(square(22)), 1e-9) << "those that help stay";
}

TEST(VelocityForecast, ForgetsABlow) {
  const auto rest = [](double) { return 0.; };
  const auto blow = [](double) { return 5.; };
  Course course;
  course.go(6, rest, rest);
  course.go(2, blow, rest);
  EXPECT_EQ(course.alongError(5), 0);
  EXPECT_EQ(course.aboutError(0), 0);
}

// What falls falls by its acceleration, in a longer step farther.
TEST(VelocityForecast, KnowsHowLongAStepIs) {
  const auto fall = [](double t) { return -10 * t; };
  const auto rest = [](double) { return 0.; };
  for (const bool was_enough : {true, false}) {
    Course course;
    course.go(6, fall, rest, was_enough);
    for (const double dt : {0.5, 2., 0.25}) {
      course.changeStep(dt);
      EXPECT_EQ(course.alongError(fall(course.time())), 0) << dt;
      course.go(1, fall, rest, was_enough);
    }
  }
}

}  // namespace exact_velocity_forecast_test
