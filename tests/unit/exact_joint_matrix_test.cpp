// K = J A^-1 J^T of a component, factorised, against Eigen's dense one: whatever hangs together how.
#include <pintle/solver/system/joint_matrix.h>

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <algorithm>
#include <numeric>

#include "joint_graphs.h"
#include "joint_matrix_problem.h"

namespace exact_joint_matrix_test {

using namespace joint_matrix_problem;

void compareAll(const std::vector<Graph>& graphs, bool all_act) {
  Random random(5);
  JointMatrix matrix;
  for (const Graph& graph : graphs) {
    matrix.analyse(graph.joints, pintle::JointMatrix::Locks(size_t(graph.bodies)));
    for (int round = 0; round < 3; ++round) {  // other sizes, the same order
      std::vector<int> sizes;
      for (size_t c = 0; c < graph.joints.size(); ++c) sizes.push_back(1 + below(random, 7));
      matrix.setSizes(sizes);
      for (int again = 0; again < 2; ++again) {
        Problem problem(matrix, graph, sizes, all_act, random);
        problem.compare(matrix, graph.name, random);
        if (all_act) continue;
        problem.actOtherwise(matrix, random);
        problem.compare(matrix, graph.name, random);
      }
    }
  }
}

TEST(JointMatrix, IsThatOfAnyTree) { compareAll(trees(), true); }
TEST(JointMatrix, IsThatOfAnyLoops) { compareAll(loops(), true); }
TEST(JointMatrix, RowsThatDoNotActAnswerAlone) { compareAll(loops(), false); }

// A factor serves as long as its matrix is the same. Of a body that stays an unknown, the inertia is in the matrix beside its rows.
TEST(JointMatrix, OtherNumbersAreAnotherMatrix) {
  Random random(8);
  constexpr int spokes = 20;
  JointMatrix matrix;
  std::vector<JointMatrix::Joint> joints;
  for (int i = 1; i <= spokes; ++i) joints.push_back({0, i});
  matrix.analyse(joints, JointMatrix::Locks(spokes + 1));
  matrix.setSizes(std::vector<int>(spokes, 3));
  std::vector<IslandBody> bodies;
  for (int i = 0; i <= spokes; ++i) bodies.push_back(body(random, false));
  struct Numbers {
    Matrix3d inertia_of_hub;
    double lever = 1, least_pivot = 0;
    bool first_acts = true;
  };
  const auto solved = [&](const Numbers& of) {
    IslandBody hub = bodies[0];
    hub.inertia = of.inertia_of_hub;
    hub.inverse_inertia = of.inertia_of_hub.inverse();
    matrix.bodies().clear();
    for (const IslandBody& one : bodies)
      matrix.bodies().emplace_back(&one == &bodies[0] ? hub : one, Matrix3d::Zero());
    for (int c = 0; c < spokes; ++c)
      for (int i = 0; i < 3; ++i) {
        const Vector3d n = Vector3d::Unit(i), r = Vector3d(0, c % 2 ? of.lever : 0, 0);
        matrix.setRow(c, i, {-n, -r.cross(n), n, Vector3d::Zero()}, 1, 1);
        matrix.setActing(matrix.row(c, i), of.first_acts || c > 0, 1);
      }
    EXPECT_TRUE(matrix.factorise(of.least_pivot));
    std::vector<double> x(matrix.vectorSize(), 0.);
    for (int c = 0; c < spokes; ++c) x[matrix.row(c, 0)] = 1 + c;
    matrix.solve(x.data());
    return x;
  };
  const Matrix3d& inertia = bodies[0].inertia;
  const std::vector<Numbers> different = {
      {inertia}, {2 * inertia}, {inertia, 2}, {inertia, 1, 100}, {inertia, 1, 0, false}};
  std::vector<std::vector<double>> alone;  // by a matrix that has known no other numbers
  for (const Numbers& of : different) {
    matrix.setSizes(std::vector<int>(spokes, 3));
    alone.push_back(solved(of));
    for (size_t k = 0; k + 1 < alone.size(); ++k) EXPECT_NE(alone[k], alone.back()) << k;
  }
  for (size_t from = 0; from < different.size(); ++from)
    for (size_t to = 0; to < different.size(); ++to) {
      EXPECT_EQ(solved(different[from]), alone[from]);
      EXPECT_EQ(solved(different[to]), alone[to]) << from << ", " << to;
    }
}

// A body on a joint to the world, with so many rows.
void analyseOneJoint(JointMatrix& matrix, int rows, Random& random) {
  matrix.analyse({{-1, 0}}, JointMatrix::Locks(1));
  matrix.setSizes({rows});
  matrix.bodies().emplace_back(body(random, false), Matrix3d::Zero());
}

// What has no solution leaves no factor behind.
TEST(JointMatrix, ARefusedFactorIsNotKept) {
  Random random(10);
  JointMatrix matrix;
  analyseOneJoint(matrix, 3, random);
  const auto setRows = [&](const Vector3d& last) {
    for (int i = 0; i < 3; ++i) {
      const Vector3d n = i < 2 ? Vector3d(Vector3d::Unit(i)) : last;
      matrix.setRow(0, i, {-n, Vector3d::Zero(), n, Vector3d::Zero()}, 1, 1);
      matrix.setActing(matrix.row(0, i), true, 0);
    }
  };
  setRows(Vector3d::Zero());
  EXPECT_FALSE(matrix.factorise(0));
  EXPECT_FALSE(matrix.factorise(0));
  setRows(Vector3d::UnitZ());
  EXPECT_TRUE(matrix.factorise(0));
}

/// M^-1 J^T is the same for both rows of a body that its factors hold along z, and J is not.
TEST(JointMatrix, RowsMayDifferAlongAxesThatAreHeld) {
  Random random(12);
  JointMatrix matrix;
  analyseOneJoint(matrix, 1, random);
  matrix.bodies().front().linear.z() = 0;
  const Vector6d v = Vector6d::Unit(2);
  for (const double z : {1., 2.}) {
    const Vector3d n(1, 0, z);
    matrix.setRow(0, 0, {-n, Vector3d::Zero(), n, Vector3d::Zero()}, 1, 1);
    matrix.setActing(matrix.row(0, 0), true, 0);
    EXPECT_TRUE(matrix.factorise(0));
    std::vector<double> u(matrix.vectorSize(), 0.);
    matrix.subtractVelocities(&v, u.data());
    EXPECT_EQ(u[matrix.row(0, 0)], -z);
  }
}

/// A row that overflows, and acts no more.
TEST(JointMatrix, ARefusedFactorLeavesNothing) {
  Random random(11);
  JointMatrix matrix;
  matrix.analyse({{0, 1}, {1, 2}}, JointMatrix::Locks(3));
  matrix.setSizes({3, 4});
  for (int i = 0; i < 3; ++i) matrix.bodies().emplace_back(body(random, false), Matrix3d::Zero());
  const auto solve = [&](double last, bool acts) {
    for (int c = 0; c < 2; ++c)
      for (int i = 0; i < 3 + c; ++i) {
        const Vector3d n = Vector3d::Unit(i % 3), by = (i < 3 ? 1 : last) * n;
        const Vector3d along = i < 3 ? n : Vector3d(Vector3d::Zero());
        matrix.setRow(c, i, {-along, -by, along, by}, 1, 1);
        matrix.setActing(matrix.row(c, i), i < 3 || acts, 1e-3);
      }
    std::vector<double> x(matrix.vectorSize(), 0.);
    x[matrix.row(0, 0)] = 1;
    if (matrix.factorise(1e-13))
      matrix.solve(x.data());
    else
      x.clear();
    return x;
  };
  const std::vector<double> before = solve(1, false);
  EXPECT_TRUE(solve(1e300, true).empty()) << "it overflows";
  EXPECT_EQ(solve(1, false), before);
  EXPECT_EQ(solve(2, false), before);
}

TEST(FourLanes, AreFourNumbers) {
  Random random(9);
  for (int trial = 0; trial < 100; ++trial) {
    double anywhere[5], *const a = anywhere + 1, b[4], sum[4], by = random.uniform(-2, 2);
    for (int i = 0; i < 4; ++i) {
      a[i] = random.uniform(-2, 2);
      b[i] = random.uniform(-2, 2);
    }
    pintle::FourLanes of(a);
    of.add(pintle::FourLanes(b), by);
    of.subtract(pintle::FourLanes(a), pintle::FourLanes(b));
    of.scale(by);
    of.store(sum);
    for (int i = 0; i < 4; ++i) {
      EXPECT_NEAR(sum[i], (a[i] + b[i] * by - a[i] * b[i]) * by, 1e-14);
      EXPECT_EQ(of[i], sum[i]);
    }
    pintle::FourLanes most;
    for (const double* const to : {a, &b[0]}) most.maxAbs(pintle::FourLanes(to));
    for (int i = 0; i < 4; ++i) EXPECT_EQ(most[i], std::max(std::abs(a[i]), std::abs(b[i])));
    b[2] = std::nan("");  // is not lost
    for (const double* const to : {a, &b[0], a}) most.maxAbs(pintle::FourLanes(to));
    EXPECT_TRUE(std::isnan(most[2]));
    EXPECT_FALSE(std::isnan(most[1]));
  }
}

// Two bodies of many joints that are joined themselves: such a joint has no pivot before one of them.
TEST(JointMatrix, HoldsStarsThatAreJoined) {
  Graph stars{"stars", 32, {}};
  for (int i = 2; i < 17; ++i) stars.joints.push_back({0, i});
  for (int i = 17; i < 32; ++i) stars.joints.push_back({i, 1});
  stars.joints.push_back({0, 1});
  compareAll({stars, with(stars, "twice", {{1, 0}}), with(stars, "held", {{-1, 0}, {1, -1}})},
             true);
}

// A star's joints are not all coupled to each other.
TEST(JointMatrix, IsLinearInTheJointsOfABody) {
  const auto bytes = [](int leaves) {
    const Graph graph = star(leaves);
    JointMatrix matrix;
    matrix.analyse(graph.joints, pintle::JointMatrix::Locks(size_t(graph.bodies)));
    matrix.setSizes(std::vector<int>(graph.joints.size(), 3));
    return double(matrix.bytes());
  };
  EXPECT_LT(bytes(1000), 11 * bytes(100));
}

}  // namespace exact_joint_matrix_test
