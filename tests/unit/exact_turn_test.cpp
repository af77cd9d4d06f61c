// How a body turns in a step, and the derivatives of that: against Bullet's own integration, a quadrature, and differences.
#include <pintle/solver/turn.h>

#include <LinearMath/btTransformUtil.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "support.h"

namespace exact_turn_test {

using pintle::crossMatrix;
using pintle::Matrix3d;
using pintle::Turn;
using pintle::Vector3d;
using support::Random;

constexpr double time_step = 1. / 60;

Vector3d numbers(const btVector3& v) { return {double(v.x()), double(v.y()), double(v.z())}; }

// By fourth-order differences. Its step stays on one side of the threshold for every size that is tested.
template <class Function>
auto derivative(const Function& function) {
  constexpr double h = 1e-3;
  using Value = decltype(function(h));
  return Value((8 * (function(h) - function(-h)) - (function(2 * h) - function(-2 * h))) /
               (12 * h));
}

// dt |w|, rad: on both sides of where series end (1e-3 and 0.1), and of Bullet's threshold of 0.785.
class TurnOfSize : public testing::TestWithParam<double> {
 protected:
  static constexpr int trials = 10;
  Vector3d velocity() { return GetParam() / time_step * numbers(random.unit()).normalized(); }
  bool isBeyond() const { return GetParam() > double(ANGULAR_MOTION_THRESHOLD); }

  Random random{1};
};

TEST_P(TurnOfSize, PhiIsWhatBulletTurnsBy) {
  for (int n = 0; n < trials; ++n) {
    const Vector3d w = velocity();
    const Turn turn(w, time_step);
    EXPECT_LE((turn.phi - turn.part * time_step * w).norm(), 1e-15 * GetParam());
    if (isBeyond()) {
      const double most = double(ANGULAR_MOTION_THRESHOLD);
      EXPECT_NEAR(std::tan(turn.phi.norm() / 2), std::tan(most / 2) / most * GetParam(), 1e-14);
    } else {
      EXPECT_EQ(turn.part, 1);
    }
    const btVector3 velocity(btScalar(w.x()), btScalar(w.y()), btScalar(w.z()));
    const btTransform start = random.pose(1);
    btTransform end;
    btTransformUtil::integrateTransform(start, btVector3(0, 0, 0), velocity, btScalar(time_step),
                                        end);
    const Matrix3d R = turn.rotation();
    for (int i = 0; i < 3; ++i) {
      const btVector3 axis = start.getBasis().getColumn(i), bullets = end.getBasis().getColumn(i);
      EXPECT_LT((R * numbers(axis) - numbers(bullets)).norm(), support::is_double ? 1e-14 : 2e-6);
    }
  }
}

TEST_P(TurnOfSize, RotatesByPhi) {
  for (int n = 0; n < trials; ++n) {
    const Turn turn(velocity(), time_step);
    const Eigen::AngleAxisd eigens(turn.phi.norm(), turn.phi.normalized());
    EXPECT_LT((turn.rotation() - eigens.toRotationMatrix()).norm(), 2e-15);
  }
}

TEST_P(TurnOfSize, MeanIsTheMeanOfTheStep) {
  for (int n = 0; n < trials; ++n) {
    const Turn turn(velocity(), time_step);
    const double angle = turn.phi.norm();
    const Vector3d axis = turn.phi.normalized();
    constexpr int parts = 800;        // Simpson's rule
    Matrix3d sum = Matrix3d::Zero();  // of what differs from 1, for it is small
    for (int i = 0; i <= parts; ++i) {
      const double weight = i == 0 || i == parts ? 1 : i % 2 ? 4 : 2;
      const Eigen::AngleAxisd at(angle * i / parts, axis);
      sum += weight / (3 * parts) * (at.toRotationMatrix() - Matrix3d::Identity());
    }
    EXPECT_LT((turn.mean - Matrix3d::Identity() - sum).norm(), 1e-15 + 1e-11 * angle);
  }
}

TEST_P(TurnOfSize, PartSlopeIsItsDerivative) {
  for (int n = 0; n < trials; ++n) {
    const Vector3d w = velocity();
    const Turn turn(w, time_step);
    for (int k = 0; k < 3; ++k) {
      const double slope = derivative(
          [&](double h) { return Turn(w + h / time_step * Vector3d::Unit(k), time_step).part; });
      EXPECT_NEAR(turn.part_slope[k], slope, 1e-11) << k;
    }
  }
}

// dR/dx R^T = [d]x
TEST_P(TurnOfSize, SlopeIsHowTheEndTurns) {
  for (int n = 0; n < trials; ++n) {
    const Vector3d w = velocity();
    const Turn turn(w, time_step);
    const Matrix3d R = turn.rotation();
    for (int k = 0; k < 3; ++k) {
      const Matrix3d moved = derivative([&](double h) {
        return Turn(w + h / time_step * Vector3d::Unit(k), time_step).rotation();
      });
      EXPECT_LT((crossMatrix(turn.slope.col(k)) * R - moved).norm(), 1e-11) << k;
    }
  }
}

TEST_P(TurnOfSize, MeanSlopeIsTheDerivativeOfTheLever) {
  for (int n = 0; n < trials; ++n) {
    const Vector3d w = velocity(), r = numbers(random.vector(1));
    const Matrix3d slope = Turn(w, time_step).meanSlope(r);
    for (int k = 0; k < 3; ++k) {
      const Vector3d moved = derivative([&](double h) {
        const Turn turn(w + h / time_step * Vector3d::Unit(k), time_step);
        return Vector3d(turn.part * turn.mean * r);
      });
      EXPECT_LT((slope.col(k) - moved).norm(), 1e-11) << k;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, TurnOfSize,
                         testing::Values(1e-9, 1e-6, 1e-4, 9.9e-4, 1.01e-3, 0.01, 0.099, 0.101, 0.5,
                                         0.78, 0.79, 3));

TEST(Turn, OfNothingIsNothing) {
  const Turn turn(Vector3d::Zero(), time_step);
  EXPECT_EQ(turn.phi, Vector3d::Zero());
  EXPECT_EQ(turn.rotation(), Matrix3d::Identity());
  EXPECT_EQ(turn.mean, Matrix3d::Identity());
  EXPECT_EQ(turn.slope, Matrix3d::Identity());
  const Vector3d r(1, 2, 3);
  EXPECT_LT((turn.meanSlope(r) + crossMatrix(r) / 2).norm(), 1e-15);
}

}  // namespace exact_turn_test
