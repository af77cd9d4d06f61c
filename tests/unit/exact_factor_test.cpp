// A sparse symmetric matrix of blocks: the order of its elimination, and its factor against Eigen's dense one.
#include <pintle/solver/linalg/minimum_degree.h>
#include <pintle/solver/linalg/symmetric_factor.h>

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <algorithm>
#include <utility>
#include <vector>

#include "joint_graphs.h"

namespace exact_factor_test {

using Eigen::Matrix3d;
using pintle::SymmetricFactor;
using namespace joint_graphs;

// By a factor, whose vectors have gaps.
Eigen::VectorXd solved(const SymmetricFactor& factor, const Eigen::VectorXd& b) {
  std::vector<double> x(size_t(pintle::block_stride * factor.blocks()), 0.);
  const auto at = [](Eigen::Index k) { return size_t(k / 3 * pintle::block_stride + k % 3); };
  for (Eigen::Index k = 0; k < b.size(); ++k) x[at(k)] = b[k];
  factor.solve(x.data());
  Eigen::VectorXd found(b.size());
  for (Eigen::Index k = 0; k < b.size(); ++k) found[k] = x[at(k)];
  return found;
}

// What lies between columns and blocks takes part in all sums.
void expectGapsAreZero(SymmetricFactor& factor) {
  std::vector<double> x(size_t(pintle::block_stride * factor.blocks()), 0.);
  for (size_t k = 0; k < x.size(); ++k) x[k] = k % pintle::block_stride < 3 ? 1 : 0;
  factor.solve(x.data());
  for (size_t at = 3; at < factor.numbers(); at += pintle::block_stride) {
    ASSERT_EQ(*factor.at(at), 0);
  }
  for (size_t at = 3; at < x.size(); at += pintle::block_stride) ASSERT_EQ(x[at], 0);
}

// From 13 blocks on, some are idle.
TEST(SymmetricFactor, SolvesAnyQuasiDefiniteMatrix) {
  Random random(3);
  for (int n = 1; n <= 30; ++n) {
    std::vector<char> idle;
    for (int k = 0; k < n; ++k) idle.push_back(n > 12 && below(random, 4) == 0);
    std::vector<std::vector<int>> coupled(static_cast<size_t>(n));
    for (int k = 0; k < n; ++k)
      for (int i = k + 1; i < n; ++i)
        if (below(random, 3) == 0) coupled[size_t(k)].push_back(i);
    SymmetricFactor factor;
    factor.analyse(coupled);
    ASSERT_EQ(factor.blocks(), n);
    factor.set({}, {});
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    std::vector<double> sign;
    for (int k = 0; k < n; ++k) sign.push_back(below(random, 2) ? 1 : -1);
    const auto add = [&](int i, int k, const Matrix3d& block) {
      A.block<3, 3>(3 * i, 3 * k) = block;
      A.block<3, 3>(3 * k, 3 * i) = block.transpose();
      double* const to = factor.at(factor.place(i, k));
      for (int r = 0; r < 3; ++r)
        for (int s = 0; s < 3; ++s) to[pintle::inBlock(r, s)] += block(r, s);
    };
    for (int k = 0; k < n; ++k) {
      if (idle[size_t(k)]) {
        factor.setIdle(k);
        add(k, k, Matrix3d::Identity());
        continue;
      }
      // The parts of one sign are dominant among themselves.
      const Matrix3d some = 0.1 * numbers(3, 3, random);
      add(k, k, sign[size_t(k)] * (4 * double(n) * Matrix3d::Identity() + some + some.transpose()));
      for (const int i : coupled[size_t(k)])
        if (!idle[size_t(i)]) add(i, k, numbers(3, 3, random));
    }
    ASSERT_TRUE(factor.factorise(0));
    const Eigen::VectorXd b = numbers(3 * n, 1, random), x = A.partialPivLu().solve(b);
    const Eigen::VectorXd y = solved(factor, b);
    expectGapsAreZero(factor);
    ASSERT_LT((y - x).norm(), 1e-12 * x.norm()) << n;
  }
}

// Rows that repeat each other, but for a softness of 1e-9 of their own, in several blocks: what is left of the others is found to the
// digits that the numbers have.
TEST(SymmetricFactor, SolvesWhereRowsRepeatEachOther) {
  constexpr int n = 6;
  constexpr double softness = 1e-9;
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<std::vector<int>> coupled(n);
    for (int k = 0; k < n; ++k)
      for (int i = k + 1; i < n; ++i) coupled[size_t(k)].push_back(i);
    Eigen::MatrixXd J = numbers(3 * n, 4 * n, random);
    for (int k = 0; k < n; ++k) J.row(3 * k + 2) = J.row(3 * k);
    Eigen::MatrixXd K = J * J.transpose();
    K.diagonal().array() += softness;
    SymmetricFactor factor;
    factor.analyse(coupled);
    factor.set({}, {});
    for (int k = 0; k < n; ++k)
      for (int i = k; i < n; ++i) {
        double* const to = factor.at(factor.place(i, k));
        for (int r = 0; r < 3; ++r)
          for (int s = 0; s < 3; ++s) to[pintle::inBlock(r, s)] = K(3 * i + r, 3 * k + s);
      }
    ASSERT_TRUE(factor.factorise(0));
    const Eigen::VectorXd b = J * numbers(4 * n, 1, random);
    const Eigen::VectorXd y = solved(factor, b);
    EXPECT_LT((K * y - b).norm(), 1e-8 * b.norm()) << trial;
  }
}

using Columns = std::vector<pintle::MinimumDegree::Column>;

Columns orderOf(const Graph& graph) {
  pintle::MinimumDegree order(graph.joints.size());
  std::vector<std::vector<int>> cliques(static_cast<size_t>(graph.bodies));
  std::vector<int> nodes;
  for (size_t c = 0; c < graph.joints.size(); ++c) {
    nodes.push_back(int(c));
    for (const int body : graph.joints[c])
      if (body >= 0) cliques[size_t(body)].push_back(int(c));
  }
  for (const auto& clique : cliques) order.addClique(clique);
  return order.order(nodes);
}

// The most columns that are on a path to the root.
int longestPath(const Columns& columns) {
  std::vector<int> place(columns.size()), length(columns.size(), 1);
  for (size_t k = 0; k < columns.size(); ++k) place[size_t(columns[k].node)] = int(k);
  int most = 0;
  for (size_t k = 0; k < columns.size(); ++k) {
    most = std::max(most, length[k]);
    int parent = int(columns.size());
    for (const int i : columns[k].coupled) parent = std::min(parent, place[size_t(i)]);
    if (parent < int(columns.size()))
      length[size_t(parent)] = std::max(length[size_t(parent)], length[k] + 1);
  }
  return most;
}

// Contacts go along them, however long a chain is.
TEST(MinimumDegree, PathsAreShort) {
  const auto longest = [](int joints, bool is_ring) {
    Graph graph{"", joints + 1, {}};
    for (int i = 0; i < joints; ++i)
      graph.joints.push_back({i, is_ring && i + 1 == joints ? 0 : i + 1});
    return longestPath(orderOf(graph));
  };
  EXPECT_LE(longest(30, false), 16);  // from both ends to the middle
  EXPECT_LE(longest(1000, false), 16 + 20);
  EXPECT_LE(longest(100000, false), 16 + 35);
  EXPECT_LE(longest(100, true), 15);
  EXPECT_LE(longest(100000, true), 35);
}

// Bullet gives joints in any order.
TEST(MinimumDegree, FillsAsMuchHoweverJointsAreNumbered) {
  const auto fill = [](const Graph& graph) {
    double sum = 0;
    for (const auto& column : orderOf(graph)) sum += double(column.coupled.size());
    return sum;
  };
  Graph graph = net(100);
  const double natural = fill(graph);
  Random random(5);
  for (int trial = 0; trial < 5; ++trial) {
    for (size_t k = graph.joints.size(); k > 1; --k)
      std::swap(graph.joints[k - 1], graph.joints[size_t(below(random, int(k)))]);
    EXPECT_LT(fill(graph), 1.2 * natural) << trial;
  }
}

// A column that has children comes right after one of them.
TEST(MinimumDegree, IsInPostorder) {
  Random random(6);
  for (const Graph& graph : {net(7), tree(40, random), star(5)}) {
    const Columns columns = orderOf(graph);
    std::vector<size_t> place(columns.size());
    for (size_t k = 0; k < columns.size(); ++k) place[size_t(columns[k].node)] = k;
    const auto parentOf = [&](size_t k) {
      size_t parent = columns.size();
      for (const int i : columns[k].coupled) parent = std::min(parent, place[size_t(i)]);
      return parent;
    };
    for (size_t k = 0; k < columns.size(); ++k) {
      const size_t parent = parentOf(k);
      ASSERT_GT(parent, k);
      if (parent == columns.size()) continue;
      EXPECT_EQ(parentOf(parent - 1), parent) << graph.name;
    }
  }
}

}  // namespace exact_factor_test
