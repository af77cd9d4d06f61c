// How the impulses of a row turn with the velocities of its bodies: against differences of those with which Newton's iteration works.
#include <pintle/solver/geometric_derivative.h>
#include <pintle/solver/iterate.h>

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "support.h"

namespace exact_geometric_derivative_test {

using pintle::BodyAtEnd;
using pintle::GeometricDerivative;
using pintle::Island;
using pintle::IslandRow;
using pintle::Iterate;
using pintle::Matrix3d;
using pintle::RowAtEnd;
using pintle::RowShape;
using pintle::Vector3d;
using pintle::Vector6d;
using support::Random;

using Velocities = Eigen::Matrix<double, 12, 1>;
using Matrix = GeometricDerivative::Matrix;

constexpr double time_step = 1. / 60;

pintle::Vec3 inScalar(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

IslandRow rowOf(RowShape::Kind kind, Random& random) {
  IslandRow row = {};
  row.start.L = row.start.A_a = row.start.A_b = pintle::Vec3::Zero();
  if (kind != RowShape::dot) row.start.L = inScalar(random.unit());
  row.start.axis = -1;
  row.shape = {kind, inScalar(random.vector(1)), inScalar(random.vector(1)),
               support::scalar(random.uniform(0.1, 2))};
  row.has_position = true;
  row.K = 1;
  return row;
}

// Two bodies and a joint of one row. It asks no constraint: its row is made of arms of the bodies.
class Pair {
 public:
  Pair(RowShape::Kind kind, Random& random) : m_lambda(random.uniform(-3, 3)) {
    m_island.dt = time_step;
    for (int i = 0; i < 2; ++i) {
      pintle::IslandBody body = {};
      body.start = random.pose(2);
      body.mass = 1;
      body.inertia = Matrix3d::Identity();
      body.v0 = body.v_free = Vector6d::Zero();
      m_island.bodies.push_back(body);
    }
    m_island.joints.push_back({nullptr, nullptr, {0, 1}, 0, 1, 0, 1});
    m_island.rows.push_back(rowOf(kind, random));
    m_island.unmoved_bodies.resize(1);
    m_at.horizon = time_step;
    m_at.bodies.resize(2);
    m_at.rows.resize(1);
  }

  // The other body does not move.
  void hold(int side) { m_island.joints[0].body[size_t(side)] = -1; }

  void moveTo(const Velocities& v) {
    m_at.bodies[0].v = v.head<6>();
    m_at.bodies[1].v = v.tail<6>();
    pintle::moveTo(m_island, {0, 2, 0, 1, 1}, m_at);
  }

  /// -G^T lambda
  Velocities impulse(const Velocities& v) {
    moveTo(v);
    const pintle::RowJacobian& G = m_at.rows[0].G;
    Velocities all;
    all << G.L_a, G.A_a, G.L_b, G.A_b;
    return -m_lambda * all;
  }

  void addTo(GeometricDerivative& H, const Velocities& v) {
    moveTo(v);
    const pintle::IslandJoint& joint = m_island.joints[0];
    H.add(m_island.rows[0], m_at.rows[0], m_lambda,
          pintle::bodyOf(m_island, joint, 0, {0, 2, 0, 1, 1}, m_at),
          pintle::bodyOf(m_island, joint, 1, {0, 2, 0, 1, 1}, m_at), time_step);
  }

  Matrix derivative(const Velocities& v) {
    GeometricDerivative H;
    addTo(H, v);
    return H.matrix();
  }

  // By fourth-order differences, of how far a body goes in the step.
  Matrix differences(const Velocities& v) {
    constexpr double h = 1e-3;
    Matrix all;
    for (int k = 0; k < 12; ++k) {
      const auto at = [&](double step) {
        return impulse(v + step / time_step * Velocities::Unit(k));
      };
      all.col(k) = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h) * time_step;
    }
    return all;
  }

 private:
  Island m_island;
  Iterate m_at;
  double m_lambda;
};

// Each body moves by up to 0.1 m, and turns by the size.
Velocities velocities(double turn_a, double turn_b, Random& random) {
  const auto numbers = [](const btVector3& v) { return pintle::inDouble(v); };
  Velocities v;
  v << 0.1 / time_step * numbers(random.vector(1)),
      turn_a / time_step * numbers(random.unit()).normalized(),
      0.1 / time_step * numbers(random.vector(1)),
      turn_b / time_step * numbers(random.unit()).normalized();
  return v;
}

// rad: from where series are used to beyond what Bullet turns a body by.
constexpr double turns[] = {0, 1e-9, 1e-4, 0.05, 0.5, 0.78, 0.79, 2};

class RowOfKind : public testing::TestWithParam<RowShape::Kind> {};

TEST_P(RowOfKind, DerivativeIsThatOfTheImpulses) {
  Random random(1);
  for (const double turn_a : turns)
    for (const double turn_b : turns)
      for (int n = 0; n < 5; ++n) {
        Pair pair(GetParam(), random);
        const Velocities v = velocities(turn_a, turn_b, random);
        const Matrix H = pair.derivative(v), measured = pair.differences(v);
        ASSERT_GT(H.norm(), 0);
        ASSERT_LT((H - measured).norm(), 1e-6 * measured.norm()) << turn_a << " " << turn_b;
      }
}

TEST_P(RowOfKind, DerivativeIsThatOfOneBodyAgainstTheWorld) {
  Random random(2);
  for (int held = 0; held < 2; ++held)
    for (const double turn : turns)
      for (int n = 0; n < 5; ++n) {
        Pair pair(GetParam(), random);
        pair.hold(held);
        const Velocities v = velocities(turn, turn, random);
        const int mine = held == 0 ? 6 : 0;
        const Eigen::Matrix<double, 6, 6> H = pair.derivative(v).block<6, 6>(mine, mine),
                                          measured = pair.differences(v).block<6, 6>(mine, mine);
        ASSERT_LT((H - measured).norm(), 1e-6 * measured.norm()) << held << " " << turn;
      }
}

TEST_P(RowOfKind, RowsAddUp) {
  Random random(3);
  for (int n = 0; n < 20; ++n) {
    Pair pair(GetParam(), random), other(RowShape::dot, random);
    const Velocities v = velocities(0.3, 1, random);
    GeometricDerivative H;
    pair.addTo(H, v);
    other.addTo(H, v);
    const Matrix sum = pair.derivative(v) + other.derivative(v);
    EXPECT_LT((H.matrix() - sum).norm(), 1e-14 * sum.norm());
  }
}

INSTANTIATE_TEST_SUITE_P(Closed, RowOfKind,
                         testing::Values(RowShape::point, RowShape::distance, RowShape::dot),
                         [](const testing::TestParamInfo<RowShape::Kind>& kind) {
                           return kind.param == RowShape::point      ? "Point"
                                  : kind.param == RowShape::distance ? "Distance"
                                                                     : "Dot";
                         });

// What is known of the start alone does not turn.
TEST(GeometricDerivative, RowsOfTheStartHaveNone) {
  Random random(4);
  const BodyAtEnd body = {Vector6d::Ones(), pintle::Turn(Vector3d::Ones(), time_step),
                          btTransform()};
  const RowAtEnd end = {};
  GeometricDerivative H;
  IslandRow row = rowOf(RowShape::point, random);
  row.has_position = false;
  H.add(row, end, 3, body, body, time_step);
  H.add(rowOf(RowShape::other, random), end, 3, body, body, time_step);
  H.add(rowOf(RowShape::distance, random), end, 0, body, body, time_step);
  EXPECT_EQ(H.matrix(), Matrix::Zero());
}

// The nearest of all without negative eigenvalues: what is cut off is one, too, across what is left.
template <class M>
void expectPositivePart(const M& clipped, const M& of) {
  const M symmetric = (of + of.transpose()) / 2, cut = clipped - symmetric;
  const double size = symmetric.norm();
  EXPECT_LT((clipped - clipped.transpose()).norm(), 1e-14 * size);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<M>(clipped).eigenvalues().minCoeff(), -1e-14 * size);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<M>(cut).eigenvalues().minCoeff(), -1e-14 * size);
  EXPECT_LT((clipped * cut).norm(), 1e-14 * size * size);
}

TEST(GeometricDerivative, ClipLeavesThePositivePart) {
  Random random(5);
  for (int n = 0; n < support::trials(100); ++n) {
    GeometricDerivative H;
    for (const auto kind : {RowShape::point, RowShape::distance, RowShape::dot}) {
      Pair pair(kind, random);
      pair.addTo(H, velocities(0.3, 1, random));
    }
    const Matrix before = H.matrix();
    H.clip();
    expectPositivePart(H.matrix(), before);
    EXPECT_GT(H.matrix().norm(), 0);

    const Matrix3d block = before.block<3, 3>(3, 3);
    expectPositivePart(pintle::clipped(block), block);
  }
}

// Of the torque -(mean lever x f).
TEST(GeometricDerivative, LeverOfABodyThatTurnsSlowly) {
  Random random(6);
  for (int n = 0; n < 20; ++n) {
    const Vector3d f = pintle::inDouble(random.vector(3)), r = pintle::inDouble(random.vector(1));
    const Matrix3d derivative = pintle::leverDerivative(f, r, time_step);
    for (int k = 0; k < 3; ++k) {
      const auto torque = [&](double h) {
        const pintle::Turn turn(h / time_step * Vector3d::Unit(k), time_step);
        return Vector3d(pintle::cross(f, Vector3d(turn.part * turn.mean * r)));
      };
      constexpr double h = 1e-4;
      const Vector3d measured = (torque(h) - torque(-h)) / (2 * h) * time_step;
      EXPECT_LT((derivative.col(k) - measured).norm(), 1e-8 * f.norm() * r.norm());
    }
  }
}

}  // namespace exact_geometric_derivative_test
