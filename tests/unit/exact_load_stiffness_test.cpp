// What bodies get as inertia where they swing about the loads of their joints faster than steps resolve.
#include <pintle/solver/system/load_stiffness.h>

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <cmath>

#include "support.h"

namespace exact_load_stiffness_test {

using pintle::Matrix3d;
using pintle::Vector3d;
using support::Random;

constexpr double dt = 1. / 60, stable_swing = 2;

Vector3d vector(Random& random) {
  return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
}

// A body of which each joint holds a point, under an impulse.
struct Loaded {
  pintle::Island island;
  pintle::Component component;
  pintle::Workspace work;
  Matrix3d expected = Matrix3d::Zero();

  Loaded(Random& random, int joints, double load) {
    island.dt = dt;
    pintle::IslandBody body = {};
    const Vector3d principal(random.uniform(0.1, 1), random.uniform(0.1, 1),
                             random.uniform(0.1, 1));
    const Matrix3d R = pintle::turnBy(3 * vector(random));
    body.inertia = R * principal.asDiagonal() * R.transpose();
    body.least_inertia = principal.minCoeff();
    island.bodies.push_back(body);
    component = {0, 1, 0, joints, 3 * joints};
    for (int c = 0; c < joints; ++c) {
      pintle::IslandJoint joint = {};
      joint.body = {-1, 0};
      joint.first_row = joint.row_of_component = 3 * c;
      joint.rows = 3;
      const Vector3d r = vector(random), p = load * vector(random);
      for (int i = 0; i < 3; ++i) {
        pintle::IslandRow row;
        row.has_position = true;
        row.shape.kind = pintle::RowShape::point;
        row.shape.b = r.cast<pintle::Scalar>();
        const Vector3d n = Vector3d::Unit(i);
        row.J = {-n, Vector3d::Zero(), n, r.cross(n)};
        row.setK(1);
        row.index = i;
        island.rows.push_back(row);
        work.load.push_back(p[i]);
      }
      joint.finishShapes(&island.rows[size_t(3 * c)]);
      island.joints.push_back(joint);
      const Matrix3d rp = pintle::inDouble(row(3 * c).shape.b) * p.transpose();
      expected += rp.trace() * Matrix3d::Identity() - (rp + rp.transpose()) / 2;
    }
    expected = dt / stable_swing * expected - body.inertia;
  }
  const pintle::IslandRow& row(int i) const { return island.rows[size_t(i)]; }
};

// dt / stable_swing of the stiffness is more than the inertia by that: none where that is negative, be the load small or not.
TEST(LoadStiffness, IsWhatTheInertiaLacks) {
  Random random(7);
  int none = 0, some = 0;
  for (int trial = 0; trial < support::trials(3000); ++trial) {
    Loaded of(random, 1 + trial % 4, std::pow(10, random.uniform(-1, 3)));
    pintle::findStiffness(of.island, of.component, stable_swing, of.work);
    const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(of.expected);
    const Matrix3d lacks = axes.eigenvectors() * axes.eigenvalues().cwiseMax(0).asDiagonal() *
                           axes.eigenvectors().transpose();
    const Matrix3d found = of.work.is_resolved ? Matrix3d(Matrix3d::Zero()) : of.work.stiffness[0];
    EXPECT_LT((found - lacks).norm(), 1e-6 * (1 + lacks.norm())) << trial;
    EXPECT_EQ(of.work.is_resolved, axes.eigenvalues().maxCoeff() <= 1e-12) << trial;
    ++(lacks.isZero(0) ? none : some);
  }
  EXPECT_GT(none, support::trials(500));
  EXPECT_GT(some, support::trials(500));
}

}  // namespace exact_load_stiffness_test
