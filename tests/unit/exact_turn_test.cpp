// How a body turns in a step: against Bullet's own integration, and Eigen's rotations.
#include <pintle/solver/model/turn.h>

#include <LinearMath/btTransformUtil.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "support.h"

namespace exact_turn_test {

using pintle::Matrix3d;
using pintle::RotationOfStep;
using pintle::Vector3d;
using support::Random;

constexpr double time_step = 1. / 60;

Vector3d numbers(const btVector3& v) { return {double(v.x()), double(v.y()), double(v.z())}; }

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
    const RotationOfStep turn(w, time_step);
    EXPECT_LE(turn.phi.cross(w).norm(), 1e-15 * GetParam() * w.norm());
    if (isBeyond()) {
      const double most = double(ANGULAR_MOTION_THRESHOLD);
      EXPECT_NEAR(std::tan(turn.phi.norm() / 2), std::tan(most / 2) / most * GetParam(), 1e-14);
    } else {
      EXPECT_EQ(turn.phi, time_step * w);
    }
    const btVector3 velocity(btScalar(w.x()), btScalar(w.y()), btScalar(w.z()));
    const btTransform start = random.pose(1);
    btTransform end;
    btTransformUtil::integrateTransform(start, btVector3(0, 0, 0), velocity, btScalar(time_step),
                                        end);
    const Matrix3d R = turn.matrix();
    for (int i = 0; i < 3; ++i) {
      const btVector3 axis = start.getBasis().getColumn(i), bullets = end.getBasis().getColumn(i);
      EXPECT_LT((R * numbers(axis) - numbers(bullets)).norm(), support::is_double ? 1e-14 : 2e-6);
    }
  }
}

TEST_P(TurnOfSize, RotatesByPhi) {
  for (int n = 0; n < trials; ++n) {
    const RotationOfStep turn(velocity(), time_step);
    const Eigen::AngleAxisd eigens(turn.phi.norm(), turn.phi.normalized());
    EXPECT_LT((turn.matrix() - eigens.toRotationMatrix()).norm(), 2e-15);
    const Vector3d r = numbers(random.vector(1));
    EXPECT_LT((turn.turned(r) - eigens * r).norm(), 2e-15);
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, TurnOfSize,
                         testing::Values(1e-9, 1e-6, 1e-4, 9.9e-4, 1.01e-3, 0.01, 0.099, 0.101, 0.5,
                                         0.78, 0.79, 3));

TEST(Turn, OfNothingIsNothing) {
  const RotationOfStep turn(Vector3d::Zero(), time_step);
  EXPECT_EQ(turn.phi, Vector3d::Zero());
  EXPECT_EQ(turn.matrix(), Matrix3d::Identity());
  EXPECT_EQ(turn.turned({1, 2, 3}), Vector3d(1, 2, 3));
}

}  // namespace exact_turn_test
