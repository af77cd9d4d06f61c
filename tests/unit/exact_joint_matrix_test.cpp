// K = J A^-1 J^T of a component, factorised, against Eigen's dense one: whatever hangs together how.
#include <pintle/solver/joint_matrix.h>
#include <pintle/solver/solver_options.h>

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <algorithm>
#include <numeric>

#include "joint_graphs.h"

namespace exact_joint_matrix_test {

using pintle::all_blocks;
using pintle::InverseInertia;
using pintle::IslandBody;
using pintle::JointMatrix;
using pintle::Matrix3d;
using pintle::RowJacobian;
using pintle::Vector3d;
using pintle::Vector6d;
using namespace joint_graphs;

IslandBody body(Random& random, bool is_locked) {
  IslandBody of = {};
  of.mass = random.uniform(0.1, 3);
  of.inverse_mass.setConstant(1 / of.mass);
  const Matrix3d some = numbers(3, 3, random);
  of.inertia = some * some.transpose() + 0.3 * Matrix3d::Identity();
  of.inverse_inertia = of.inertia.inverse();
  of.scale[0] = std::sqrt(of.mass);
  of.scale[1] = std::sqrt(of.inertia.trace() / 3);
  if (!is_locked) return of;
  of.locked = {false, true, false, true, true, false};
  of.inverse_mass[1] = 0;
  of.inverse_inertia.setZero();
  of.inverse_inertia(2, 2) = 1 / of.inertia(2, 2);
  return of;
}

// The same rows in a JointMatrix and in dense ones.
struct Problem {
  Eigen::MatrixXd J, acting, inverse_A, K;
  std::vector<std::vector<char>> acts;  ///< of each joint
  std::vector<int> first;
  std::vector<double> roots;  ///< of K, of each row

  Problem(JointMatrix& matrix, const Graph& graph, const std::vector<int>& sizes, bool all_act,
          Random& random) {
    const int n = graph.bodies;
    inverse_A.setZero(6 * n, 6 * n);
    std::vector<InverseInertia>& bodies = matrix.bodies();
    bodies.clear();
    for (int b = 0; b < n; ++b) {
      const Matrix3d some = numbers(3, 3, random);
      const Matrix3d stiffness =
          below(random, 2) ? Matrix3d(some * some.transpose()) : Matrix3d(Matrix3d::Zero());
      bodies.emplace_back(body(random, below(random, 8) == 0), stiffness);
      inverse_A.block<3, 3>(6 * b, 6 * b) = bodies.back().linear.asDiagonal();
      inverse_A.block<3, 3>(6 * b + 3, 6 * b + 3) = bodies.back().angular;
    }
    int rows = 0;
    for (const int size : sizes) {
      first.push_back(rows);
      rows += size;
    }
    J.setZero(rows, 6 * n);
    Eigen::VectorXd softness = Eigen::VectorXd::Ones(rows);
    for (size_t c = 0; c < sizes.size(); ++c) {
      acts.emplace_back();
      for (int i = 0; i < sizes[c]; ++i) {
        acts[c].push_back(all_act || below(random, 4) > 0);
        const int r = first[c] + i;
        const RowJacobian row = {numbers(3, 1, random), numbers(3, 1, random),
                                 numbers(3, 1, random), numbers(3, 1, random)};
        const double root_K = random.uniform(0.5, 2);
        roots.push_back(root_K);
        if (acts[c].back()) softness[r] = 0.1;
        for (int side = 0; side < 2; ++side) {
          const int b = graph.joints[c][size_t(side)];
          if (b < 0) continue;
          J.block<1, 3>(r, 6 * b) = row.L(side).transpose() / root_K;
          J.block<1, 3>(r, 6 * b + 3) = row.A(side).transpose() / root_K;
        }
        matrix.setRow(int(c), i, row, root_K, 1 / root_K);
        matrix.setActing(matrix.row(int(c), i), acts[c].back(), softness[r]);
      }
    }
    acting = J;
    for (size_t c = 0; c < acts.size(); ++c)
      for (size_t i = 0; i < acts[c].size(); ++i)
        if (!acts[c][i]) acting.row(first[c] + Eigen::Index(i)).setZero();
    K = acting * inverse_A * acting.transpose();
    K.diagonal() += softness;
  }

  void compare(JointMatrix& matrix, const std::string& name, Random& random) const {
    ASSERT_TRUE(matrix.factorise(0)) << name;
    const Eigen::VectorXd b = numbers(int(K.rows()), 1, random), x = K.llt().solve(b);
    std::vector<double> y(matrix.vectorSize(), 0.);
    for (size_t c = 0; c < first.size(); ++c)
      for (size_t i = 0; i < acts[c].size(); ++i)
        y[matrix.row(int(c), int(i))] = b[first[c] + Eigen::Index(i)];
    matrix.solve(y.data());
    Eigen::VectorXd found(b.size());
    for (size_t c = 0; c < first.size(); ++c)
      for (size_t i = 0; i < acts[c].size(); ++i)
        found[first[c] + Eigen::Index(i)] = y[matrix.row(int(c), int(i))];
    ASSERT_LE((found - x).norm(), 1e-9 * x.norm()) << name;
    std::vector<Vector6d> v(size_t(J.cols() / 6), Vector6d::Ones());
    matrix.addResponse(y.data(), v.data());
    const Eigen::VectorXd expected =
        inverse_A * J.transpose() * x + Eigen::VectorXd::Ones(J.cols());
    for (size_t k = 0; k < v.size(); ++k)
      ASSERT_LT((v[k] - expected.segment<6>(6 * Eigen::Index(k))).norm(), 1e-8 * expected.norm())
          << name;
    comparePaths(matrix, name, random);
    compareResidual(matrix, name, random);
    std::vector<Vector6d> w;
    Eigen::VectorXd all_w(J.cols());
    for (size_t k = 0; k < v.size(); ++k) {
      w.push_back(numbers(6, 1, random));
      all_w.segment<6>(6 * Eigen::Index(k)) = w.back();
    }
    std::fill(y.begin(), y.end(), 0.);
    matrix.subtractVelocities(w.data(), y.data());
    const Eigen::VectorXd along = acting * all_w;
    for (size_t c = 0; c < first.size(); ++c)
      for (size_t i = 0; i < acts[c].size(); ++i)
        ASSERT_NEAR(y[matrix.row(int(c), int(i))], -along[first[c] + Eigen::Index(i)], 1e-12)
            << name;
  }
  void compareResidual(const JointMatrix& matrix, const std::string& name, Random& random) const {
    const Eigen::VectorXd v = numbers(int(J.cols()), 1, random),
                          aims = numbers(int(J.rows()), 1, random),
                          impulses = numbers(int(J.rows()), 1, random),
                          softness = (K - acting * inverse_A * acting.transpose()).diagonal();
    std::vector<Vector6d> of_bodies;
    for (Eigen::Index k = 0; k < v.size(); k += 6) of_bodies.push_back(v.segment<6>(k));
    std::vector<double> aim(matrix.vectorSize(), 0.), y = aim, x = aim;
    const auto forEach = [&](const auto& visit) {
      for (size_t c = 0; c < first.size(); ++c)
        for (size_t i = 0; i < acts[c].size(); ++i)
          visit(first[c] + Eigen::Index(i), matrix.row(int(c), int(i)), acts[c][i] != 0);
    };
    forEach([&](Eigen::Index r, size_t at, bool) {
      aim[at] = aims[r];
      y[at] = impulses[r];
    });
    const auto find = [&] {
      return matrix.findResidual(aim.data(), y.data(), of_bodies.data(), x.data());
    };
    const double most = find();
    double largest = 0;
    size_t last = aim.size();
    forEach([&](Eigen::Index r, size_t at, bool is_acting) {
      const double left =
          is_acting ? aims[r] - softness[r] * impulses[r] - acting.row(r).dot(v) : 0;
      ASSERT_NEAR(x[at], left, 1e-12) << name;
      largest = std::max(largest, std::abs(left) * roots[size_t(r)]);
      if (is_acting) last = at;
    });
    ASSERT_NEAR(most, largest, 1e-12) << name;
    if (last == aim.size()) return;
    aim[last] = std::nan("");
    ASSERT_EQ(find(), pintle::infinity) << name;
  }
  // Other rows of those that are set.
  void actOtherwise(JointMatrix& matrix, Random& random) {
    acting = J;
    for (size_t c = 0; c < acts.size(); ++c)
      for (size_t i = 0; i < acts[c].size(); ++i) {
        const Eigen::Index r = first[c] + Eigen::Index(i);
        acts[c][i] = below(random, 2);
        matrix.setActing(matrix.row(int(c), int(i)), acts[c][i], 0.2);
        if (!acts[c][i]) acting.row(r).setZero();
      }
    K = acting * inverse_A * acting.transpose();
    for (size_t c = 0; c < acts.size(); ++c)
      for (size_t i = 0; i < acts[c].size(); ++i) {
        const Eigen::Index r = first[c] + Eigen::Index(i);
        K(r, r) += acts[c][i] ? 0.2 : 1;
      }
  }

  // -R^T K^-1 R, R = J A^-1, of impulses on any bodies: by the blocks that two of them share. And A^-1 of bodies that are unknowns.
  void comparePaths(JointMatrix& matrix, const std::string& name, Random& random) const {
    const Eigen::MatrixXd R = acting * inverse_A, all = R.transpose() * K.llt().solve(R);
    const auto bodies = int(J.cols() / 6);
    pintle::PathBlocks blocks;
    std::vector<size_t> end = {0};
    Eigen::MatrixXd impulses = Eigen::MatrixXd::Zero(J.cols(), 2 * bodies);
    for (Eigen::Index i = 0; i < impulses.cols(); ++i) {
      const JointMatrix::Joint on = {below(random, bodies + 1) - 1, below(random, bodies)};
      pintle::RowJacobian along;
      Eigen::Vector3d* const parts[] = {&along.L_a, &along.A_a, &along.L_b, &along.A_b};
      for (int k = 0; k < 4; ++k) {
        *parts[k] = numbers(3, 1, random);
        if (on[size_t(k / 2)] >= 0 && (k > 1 || on[0] != on[1]))
          impulses.col(i).segment<3>(6 * on[size_t(k / 2)] + 3 * (k % 2)) = *parts[k];
      }
      matrix.findPath({on[0] == on[1] ? -1 : on[0], on[1]}, along, all_blocks, blocks);
      end.push_back(blocks.size());
    }
    // What is read of what they all add.
    Eigen::MatrixXd response = -all;
    for (int b = 0; b < bodies; ++b)
      if (matrix.isUnknown(b))
        response.block<6, 6>(6 * b, 6 * b) += inverse_A.block<6, 6>(6 * b, 6 * b);
    const Eigen::MatrixXd expected = impulses.transpose() * response * impulses;
    std::vector<double> state(matrix.vectorSize());
    for (size_t i = 0; i + 1 < end.size(); ++i) {
      std::fill(state.begin(), state.end(), 0.);
      for (size_t p = end[i]; p < end[i + 1]; ++p)
        for (size_t k = 0; k < 4; ++k) state[blocks.begin()[p].at + k] += blocks.begin()[p].adds[k];
      for (size_t j = 0; j + 1 < end.size(); ++j) {
        double read = 0;
        for (size_t p = end[j]; p < end[j + 1]; ++p)
          for (size_t k = 0; k < 4; ++k)
            read += blocks.begin()[p].reads[k] * state[blocks.begin()[p].at + k];
        ASSERT_NEAR(read, expected(Eigen::Index(j), Eigen::Index(i)),
                    1e-8 * (1 + expected.cwiseAbs().maxCoeff()))
            << name << ", " << i << " and " << j;
      }
    }
  }
};

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

// What has no solution leaves no factor behind.
TEST(JointMatrix, ARefusedFactorIsNotKept) {
  Random random(10);
  JointMatrix matrix;
  matrix.analyse({{-1, 0}}, JointMatrix::Locks(1));
  matrix.setSizes({3});
  matrix.bodies().emplace_back(body(random, false), Matrix3d::Zero());
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

// Overflow of a step leaves nothing to the next one, though other rows act there.
TEST(JointMatrix, PathsForgetWhatIsNoNumber) {
  constexpr int joints = 5;
  Graph chain{"chain", joints + 1, {}};
  for (int i = 0; i < joints; ++i) chain.joints.push_back({i, i + 1});
  Random random(7);
  JointMatrix matrix;
  matrix.analyse(chain.joints, JointMatrix::Locks(joints + 1));
  const std::vector<int> sizes(joints, 3);
  matrix.setSizes(sizes);
  const Problem problem(matrix, chain, sizes, true, random);
  pintle::RowJacobian along{};
  along.L_b = Vector3d::UnitX();
  for (int idle = 0; idle < joints; ++idle) {
    const auto act = [&](bool acts) {
      for (int i = 0; i < 3; ++i) matrix.setActing(matrix.row(idle, i), acts, 0.1);
      ASSERT_TRUE(matrix.factorise(0));
    };
    act(false);
    pintle::PathBlocks blocks;
    for (int body = 0; body <= joints; ++body) {
      pintle::RowJacobian none = along;
      none.A_b.setConstant(std::nan(""));
      matrix.findPath({-1, body}, none, all_blocks, blocks);
    }
    act(true);
    blocks.clear();
    for (int body = 0; body <= joints; ++body)
      matrix.findPath({-1, body}, along, all_blocks, blocks);
    for (const pintle::PathBlock& block : blocks)
      for (const double number : block.adds) EXPECT_TRUE(std::isfinite(number)) << idle;
  }
}

// In a large net impulses see the first joints on their paths alone, the same ones for all. So whatever acts, all moves more easily
// than it does: what passes over contacts find by it is never too much.
TEST(JointMatrix, WhatJointsFarAwayDoIsLeftOut) {
  constexpr int size = 16, bodies = size * size, contacts = 60;
  Graph net{"net", bodies, {}};
  for (int i = 0; i < bodies; ++i) {
    if (i % size > 0) net.joints.push_back({i - 1, i});
    if (i >= size) net.joints.push_back({i - size, i});
  }
  Random random(6);
  JointMatrix matrix;
  matrix.analyse(net.joints, JointMatrix::Locks(bodies));
  const std::vector<int> sizes(net.joints.size(), 3);
  matrix.setSizes(sizes);
  Problem problem(matrix, net, sizes, true, random);
  ASSERT_TRUE(matrix.factorise(0));
  const Eigen::MatrixXd R = problem.acting * problem.inverse_A;
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(6 * bodies, contacts), seen(contacts, contacts);
  std::vector<std::vector<double>> reads, adds;
  const pintle::SolverOptions options;
  EXPECT_GT(matrix.longestPath(), options.longest_path);
  for (int i = 0; i < contacts; ++i) {
    // On one body, or on two.
    const int body = below(random, bodies), other = below(random, 2) ? below(random, bodies) : -1;
    const JointMatrix::Joint on = {other == body ? -1 : other, body};
    pintle::RowJacobian along{};
    for (int side = 0; side < 2; ++side) {
      if (on[size_t(side)] < 0) continue;
      Vector3d &L = side ? along.L_b : along.L_a, &A = side ? along.A_b : along.A_a;
      L = numbers(3, 1, random);
      A = numbers(3, 1, random);
      P.block<3, 1>(6 * on[size_t(side)], i) = L;
      P.block<3, 1>(6 * on[size_t(side)] + 3, i) = A;
    }
    pintle::PathBlocks blocks;
    matrix.findPath(on, along, options.cut_path, blocks);
    reads.emplace_back(matrix.vectorSize(), 0.);
    adds.emplace_back(matrix.vectorSize(), 0.);
    for (const pintle::PathBlock& block : blocks)
      for (size_t k = 0; k < 4; ++k) {
        reads.back()[block.at + k] = block.reads[k];
        adds.back()[block.at + k] = block.adds[k];
      }
  }
  for (int i = 0; i < contacts; ++i)
    for (int j = 0; j < contacts; ++j)
      seen(i, j) = std::inner_product(reads[size_t(i)].begin(), reads[size_t(i)].end(),
                                      adds[size_t(j)].begin(), 0.);
  const Eigen::MatrixXd RP = R * P, all = -RP.transpose() * problem.K.llt().solve(RP);
  const Eigen::VectorXd more =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(seen - all).eigenvalues();
  EXPECT_GT(more.minCoeff(), -1e-9 * all.norm());
  EXPECT_GT(seen.norm(), 0.1 * all.norm()) << "but much is seen";
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
