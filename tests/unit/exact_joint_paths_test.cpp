// What joints do to impulses on their bodies, by paths through the factor, against dense matrices.
#include <pintle/solver/joint_matrix.h>
#include <pintle/solver/solver_options.h>

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <algorithm>
#include <numeric>

#include "joint_graphs.h"
#include "joint_matrix_problem.h"

namespace exact_joint_paths_test {

using namespace joint_matrix_problem;

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

}  // namespace exact_joint_paths_test
