// The order in which ExactJointSolver eliminates joints, and its factors of their K.
#include <pintle/solver/block_factor.h>
#include <pintle/solver/block_lu.h>

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace {

using pintle::BlockFactor;
using pintle::Elimination;

std::vector<Elimination::Edge> chain(int joints, bool closed) {
  std::vector<Elimination::Edge> edges;
  for (int i = 0; i + 1 < joints; ++i) edges.emplace_back(i, i + 1);
  if (closed) edges.emplace_back(joints - 1, 0);
  return edges;
}

// What the solution of one joint depends on.
int depth(const Elimination& elimination, int node) {
  std::vector<char> marked(size_t(elimination.columns()), false);
  std::vector<int> columns;
  marked[size_t(elimination.column(node))] = true;
  elimination.close(marked, columns);
  return int(columns.size());
}

TEST(Elimination, AChainIsEliminatedFromBothEndsWithoutFill) {
  constexpr int joints = 101;
  Elimination elimination;
  elimination.analyse(joints, chain(joints, false));
  EXPECT_EQ(elimination.blocks(), joints + joints - 1);
  EXPECT_EQ(depth(elimination, joints / 2), 1);
  for (int i = 0; i < joints; ++i) EXPECT_LE(depth(elimination, i), joints / 2 + 1) << i;
}

TEST(Elimination, ALoopIsEliminatedByHalves) {
  constexpr int joints = 128, halvings = 7;
  Elimination elimination;
  elimination.analyse(joints, chain(joints, true));
  EXPECT_LE(elimination.blocks(), joints + 2 * joints);
  // Two neighbours at each halving.
  for (int i = 0; i < joints; ++i) EXPECT_LE(depth(elimination, i), 2 * halvings + 1) << i;
}

// K of blocks of several sizes, among them none, positive definite, in a loop with a branch.
struct Problem {
  Problem() {
    constexpr int joints = 9;
    auto edges = chain(joints - 1, true);
    edges.emplace_back(3, joints - 1);
    elimination.analyse(joints, edges);
    for (int c = 0; c < joints; ++c) rows.push_back(c % (pintle::block_rows + 1));
    factor.resize(elimination, rows);
    std::mt19937 generator(5);
    std::uniform_real_distribution<double> number(-1, 1);
    K.setZero(joints * n, joints * n);
    for (int c = 0; c < joints; ++c) {
      for (int r = 0; r < rows[size_t(c)]; ++r) K(n * c + r, n * c + r) = 30;
      for (int i = elimination.first(c); i < elimination.first(c + 1); ++i)
        for (int q = 0; q < rows[size_t(c)]; ++q)
          for (int p = 0; p < rows[size_t(elimination.row(i))]; ++p)
            K(n * elimination.row(i) + p, n * c + q) = K(n * c + q, n * elimination.row(i) + p) =
                number(generator);
    }
    for (int c = 0; c < joints; ++c) {
      set(factor.block(c), c, c);
      for (int i = elimination.first(c); i < elimination.first(c + 1); ++i)
        set(factor.block(i), elimination.row(i), c);
    }
    factor.factorise(1e-12);
    b.setZero(joints * n);
    for (int c = 0; c < joints; ++c)
      for (int r = 0; r < rows[size_t(c)]; ++r) b[n * c + r] = number(generator);
  }
  void set(double* block, int row, int column) {
    const int h = pintle::column_height(rows[size_t(row)]), w = rows[size_t(column)];
    Eigen::Map<Eigen::MatrixXd>(block, h, w) = K.block(n * row, n * column, h, w);
  }

  static constexpr int n = pintle::block_rows;
  Elimination elimination;
  std::vector<int> rows;
  BlockFactor factor;
  Eigen::MatrixXd K;
  Eigen::VectorXd b;
};

TEST(BlockFactor, Solves) {
  Problem problem;
  Eigen::VectorXd x = problem.b;
  problem.factor.solve(x.data());
  EXPECT_LT((problem.K * x - problem.b).norm(), 1e-13);
}

TEST(BlockFactor, SolvesForSomeColumnsAsForAll) {
  Problem problem;
  constexpr int n = Problem::n;
  for (int asked = 0; asked < problem.elimination.columns(); ++asked) {
    std::vector<char> marked(size_t(problem.elimination.columns()), false);
    std::vector<int> columns;
    marked[size_t(asked)] = true;
    problem.elimination.close(marked, columns);
    Eigen::VectorXd all = Eigen::VectorXd::Zero(problem.b.size());
    all.segment<n>(n * asked) = problem.b.segment<n>(n * asked);
    const Eigen::VectorXd x = all;
    Eigen::VectorXd some = all, left = all;
    problem.factor.solve(all.data());
    problem.factor.solve(some.data(), columns);
    EXPECT_NEAR(problem.factor.product(left.data(), columns), x.dot(all), 1e-15) << asked;
    for (const int c : columns)
      EXPECT_LT((all.segment<n>(n * c) - some.segment<n>(n * c)).norm(), 1e-15) << asked;
  }
}

// The same blocks, those above the diagonal others than those below it. One row says nothing.
TEST(BlockLU, Solves) {
  Problem problem;
  constexpr int n = Problem::n, idle = 3;
  const Elimination& e = problem.elimination;
  std::mt19937 generator(6);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int row = 0; row < problem.K.rows(); ++row)
    for (int column = 0; column < problem.K.cols(); ++column)
      if (row != column && problem.K(row, column) != 0) problem.K(row, column) = number(generator);
  problem.K.row(n * idle).setZero();
  problem.K.col(n * idle).setZero();
  problem.b[n * idle] = 0;
  const Eigen::MatrixXd A = problem.K;

  pintle::BlockLU factor;
  factor.reserve(problem.factor);
  const size_t bytes = factor.bytes();
  factor.begin(problem.factor);
  EXPECT_EQ(factor.bytes(), bytes);
  for (int c = 0; c < e.columns(); ++c) {
    problem.set(factor.lower(c), c, c);
    for (int i = e.first(c); i < e.first(c + 1); ++i) problem.set(factor.lower(i), e.row(i), c);
  }
  problem.K.transposeInPlace();
  for (int c = 0; c < e.columns(); ++c)
    for (int i = e.first(c); i < e.first(c + 1); ++i) problem.set(factor.upper(i), e.row(i), c);
  factor.factorise();
  Eigen::VectorXd x = problem.b;
  for (int c = 0; c < e.columns(); ++c) factor.eliminate(c, x.data());
  for (int c = e.columns(); c-- > 0;) factor.substitute(c, x.data());
  EXPECT_LT((A * x - problem.b).norm(), 1e-13);
  EXPECT_EQ(x[n * idle], 0);
}

}  // namespace
