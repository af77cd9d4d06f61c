// The direct solver of bodies and joints: whatever hangs together how, against Eigen's dense factor.
#include <pintle/solver/linear/fronts.h>

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "joint_graphs.h"

namespace exact_fronts_test {

using pintle::Fronts;

using namespace joint_graphs;

std::vector<int> sizes(const Graph& graph, int least, int most, Random& random) {
  std::vector<int> all;
  for (size_t c = 0; c < graph.joints.size(); ++c)
    all.push_back(least + below(random, most - least + 1));
  return all;
}

Eigen::MatrixXd numbers(int rows, int columns, double size, Random& random) {
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random.uniform(-size, size); });
}

// Rows that are nearly orthonormal: a chain of any length is then as well-conditioned as its joints.
Eigen::MatrixXd rowsOfJoint(int rows, Random& random) {
  const Eigen::MatrixXd Q =
      Eigen::HouseholderQR<Eigen::MatrixXd>(numbers(6, 6, 1, random)).householderQ();
  return Q.topRows(rows) + numbers(rows, 6, 0.05, random);
}

// The same random blocks in Fronts and in a dense matrix, in which bodies come first.
class Problem {
 public:
  Problem(Fronts& fronts, const Graph& graph, const std::vector<int>& joint_sizes, double softness,
          Random& random)
      : m_fronts(fronts), m_random(random) {
    int n = 6 * graph.bodies;
    for (const int size : joint_sizes) {
      m_joint.push_back(n);
      n += size;
    }
    A.setZero(n, n);
    fronts.clear();
    for (int i = 0; i < graph.bodies; ++i)
      add(fronts.bodyBlock(i), 6 * i, 6 * i,
          Eigen::MatrixXd::Identity(6, 6) + numbers(6, 6, 0.2, random));
    for (int c = 0; c < int(joint_sizes.size()); ++c) addJoint(graph, c, joint_sizes, softness);
    for (int i = 0; i < graph.bodies; ++i)
      for (int k = 0; k < 6; ++k) m_place.push_back(fronts.body(i) + k);
    for (size_t c = 0; c < joint_sizes.size(); ++c)
      for (int k = 0; k < joint_sizes[c]; ++k) m_place.push_back(fronts.joint(int(c)) + k);
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& b) const {
    Eigen::VectorXd x(b.size()), sorted(b.size());
    for (int i = 0; i < b.size(); ++i) x[m_place[size_t(i)]] = b[i];
    m_fronts.solve(x.data());
    for (int i = 0; i < b.size(); ++i) sorted[i] = x[m_place[size_t(i)]];
    return sorted;
  }

  void compare(const std::string& name) const {
    ASSERT_EQ(m_fronts.size(), A.rows()) << name;
    ASSERT_TRUE(m_fronts.factorise(0)) << name;
    const Eigen::PartialPivLU<Eigen::MatrixXd> dense(A);
    // Twice: a solve leaves the factor as it is.
    for (int i = 0; i < 2; ++i) {
      const Eigen::VectorXd b = numbers(int(A.rows()), 1, 1, m_random), x = dense.solve(b);
      ASSERT_LT((solve(b) - x).norm(), 1e-9 * x.norm()) << name;
    }
  }

  // The second row of a joint becomes its first.
  void repeatRow(const Graph& graph, int c) {
    const int at = m_joint[size_t(c)];
    for (int side = 0; side < 2; ++side) {
      if (graph.joints[size_t(c)][size_t(side)] < 0) continue;
      const Fronts::Block J = m_fronts.jointBodyBlock(c, side),
                          G = m_fronts.bodyJointBlock(c, side);
      for (int k = 0; k < 6; ++k) {
        J.at[J.stride + k] = J.at[k];
        G.at[k * G.stride + 1] = G.at[k * G.stride];
      }
    }
    A.row(at + 1) = A.row(at);
    A.col(at + 1) = A.col(at);
  }

  Eigen::MatrixXd A;
  int coupled = 0;  ///< joints of which both bodies meet

 private:
  void add(const Fronts::Block& to, int row, int column, const Eigen::MatrixXd& block) {
    for (int i = 0; i < block.rows(); ++i)
      for (int j = 0; j < block.cols(); ++j) to.at[i * to.stride + j] += block(i, j);
    A.block(row, column, block.rows(), block.cols()) += block;
  }

  void addJoint(const Graph& graph, int c, const std::vector<int>& joint_sizes, double softness) {
    const int size = joint_sizes[size_t(c)], at = m_joint[size_t(c)];
    const Fronts::Joint& bodies = graph.joints[size_t(c)];
    if (softness > 0)
      add(m_fronts.jointBlock(c), at, at,
          softness * (Eigen::MatrixXd::Identity(size, size) + numbers(size, size, 0.2, m_random)));
    for (int side = 0; side < 2; ++side) {
      const int body = bodies[size_t(side)];
      if (body < 0) continue;
      const Eigen::MatrixXd J = rowsOfJoint(size, m_random);
      add(m_fronts.jointBodyBlock(c, side), at, 6 * body, J);
      add(m_fronts.bodyJointBlock(c, side), 6 * body, at,
          -J.transpose() + numbers(6, size, 0.05, m_random));
      if (bodies[size_t(1 - side)] < 0 || !m_fronts.couplesBodies(c)) continue;
      add(m_fronts.bodyBodyBlock(c, side), 6 * body, 6 * bodies[size_t(1 - side)],
          numbers(6, 6, 0.1, m_random));
      ++coupled;
    }
  }

  Fronts& m_fronts;
  Random& m_random;
  std::vector<int> m_joint, m_place;
};

/// Compares with the dense solution of random numbers. Returns how many blocks of two bodies there are.
int compareAny(const Graph& graph, int max_size, double softness, Random& random) {
  Fronts fronts;
  fronts.analyse(graph.bodies, graph.joints);
  const auto joint_sizes = sizes(graph, 1, max_size, random);
  fronts.setSizes(joint_sizes);
  const Problem problem(fronts, graph, joint_sizes, softness, random);
  problem.compare(graph.name);
  return problem.coupled;
}

TEST(Fronts, SolvesTreesOfAnyJoints) {
  Random random(3);
  for (const Graph& graph : trees()) {
    // In a tree the bodies of every joint meet.
    int pairs = 0;
    for (const Fronts::Joint& joint : graph.joints) pairs += joint[0] >= 0 && joint[1] >= 0;
    for (int n = 0; n < support::trials(20); ++n)
      EXPECT_EQ(compareAny(graph, 6, 0, random), 2 * pairs) << graph.name;
  }
}

// Few enough rows for the bodies: more would contradict each other.
TEST(Fronts, SolvesLoopsOfRigidJoints) {
  Random random(4);
  for (const Graph& graph : loops())
    for (int n = 0; n < support::trials(20); ++n) compareAny(graph, 2, 0, random);
}

TEST(Fronts, SolvesLoopsOfAnySoftJoints) {
  Random random(5);
  for (const Graph& graph : loops())
    for (int n = 0; n < support::trials(20); ++n) compareAny(graph, 6, 0.5, random);
}

// So many joints for the bodies that fronts are eliminated in panels.
TEST(Fronts, SolvesWhereAllAreCoupledToAll) {
  Random random(6);
  for (int n = 0; n < support::trials(20); ++n)
    compareAny(anyGraph(4 + n, 30 + n, random), 6, 0.5, random);
}

// Limits come and go from step to step: a joint may even have no rows.
TEST(Fronts, SizesMayChangeWithoutAnalysis) {
  Random random(7);
  std::vector<Graph> all = loops();
  for (const Graph& graph : trees()) all.push_back(graph);
  for (const Graph& graph : all) {
    Fronts fronts;
    fronts.analyse(graph.bodies, graph.joints);
    for (int n = 0; n < 6; ++n) {
      const auto joint_sizes = sizes(graph, n % 2, 6, random);
      fronts.setSizes(joint_sizes);
      Problem(fronts, graph, joint_sizes, 0.5, random).compare(graph.name);
    }
    const std::vector<int> none(graph.joints.size(), 0);
    fronts.setSizes(none);
    Problem(fronts, graph, none, 0.5, random).compare(graph.name + ", no rows");
  }
}

TEST(Fronts, MayBeUsedForOneGraphAfterTheOther) {
  Random random(8);
  Fronts fronts;
  std::vector<Graph> all = loops();
  for (const Graph& graph : trees()) all.push_back(graph);
  std::swap(all.front(), all.back());
  for (const Graph& graph : all) {
    fronts.analyse(graph.bodies, graph.joints);
    const auto joint_sizes = sizes(graph, 1, 6, random);
    fronts.setSizes(joint_sizes);
    Problem(fronts, graph, joint_sizes, 0.5, random).compare(graph.name);
  }
}

// A joint of a tree is eliminated with one of its bodies, on the other one's diagonal: no place is shared. Twice what that takes
// is for lists, which grow by doubling.
TEST(Fronts, NumbersGrowWithTheJoints) {
  const int rows = 3;
  const auto bytes = [rows](const Graph& graph) {
    Fronts fronts;
    fronts.analyse(graph.bodies, graph.joints);
    fronts.setSizes(std::vector<int>(graph.joints.size(), rows));
    return double(fronts.bytes());
  };
  const double of_joint = sizeof(double) * (12 + rows) * (12 + rows),
               of_loop = sizeof(double) * ((6 + 2 * rows) * (6 + 2 * rows) + 9 * rows * rows);
  for (const int n : {10, 100, 1000, 4000}) {
    EXPECT_LT(bytes(star(n)), 2 * of_joint * (n + 1)) << n;
    EXPECT_LT(bytes(chain(n)), 2 * of_joint * n) << n;
    EXPECT_LT(bytes(ring(n)), 2 * of_loop * n) << n;
  }
}

// A joint that is left without a row of its own, and one whose row is no number.
TEST(Fronts, SaysThatAMatrixIsSingular) {
  Random random(9);
  std::vector<Graph> all = loops();
  for (const Graph& graph : trees()) all.push_back(graph);
  for (const Graph& graph : all)
    for (int c = 0; c < int(graph.joints.size()); ++c) {
      Fronts fronts;
      fronts.analyse(graph.bodies, graph.joints);
      const auto joint_sizes = sizes(graph, 1, 2, random);
      fronts.setSizes(joint_sizes);
      for (const double value : {0., std::numeric_limits<double>::quiet_NaN(),
                                 std::numeric_limits<double>::infinity()}) {
        const Problem problem(fronts, graph, joint_sizes, 0, random);
        for (int side = 0; side < 2; ++side) {
          if (graph.joints[size_t(c)][size_t(side)] < 0) continue;
          const Fronts::Block J = fronts.jointBodyBlock(c, side);
          std::fill(J.at, J.at + 6, value);
        }
        EXPECT_FALSE(fronts.factorise(0)) << graph.name << ", joint " << c << ", " << value;
      }
    }
}

// Two rows of a joint that are the same: an unknown that the other one determines. With the least pivot in its place the equations hold.
TEST(Fronts, RowsThatRepeatEachOtherShareTheirImpulse) {
  Random random(11);
  const Graph graph = chain(3);
  Fronts fronts;
  fronts.analyse(graph.bodies, graph.joints);
  const std::vector<int> sizes(graph.joints.size(), 2);
  fronts.setSizes(sizes);
  Problem problem(fronts, graph, sizes, 0, random);
  for (size_t c = 0; c < graph.joints.size(); ++c) problem.repeatRow(graph, int(c));
  ASSERT_TRUE(fronts.factorise(1e-13));
  Eigen::VectorXd b = numbers(int(problem.A.rows()), 1, 1, random);
  for (Eigen::Index r = 6 * graph.bodies; r < b.size(); r += 2) b[r + 1] = b[r];
  EXPECT_LT((problem.A * problem.solve(b) - b).norm(), 1e-2 * b.norm());
}

TEST(Fronts, SaysThatABodyWithoutMassAndJointsIsSingular) {
  Random random(10);
  const Graph graph = apart(chain(1), chain(2));
  for (const int body : {0, 1, 2, 5}) {
    Fronts fronts;
    fronts.analyse(graph.bodies, graph.joints);
    fronts.setSizes({1});
    const Problem problem(fronts, graph, {1}, 0, random);
    const Fronts::Block H = fronts.bodyBlock(body);
    for (int i = 0; i < 6; ++i) std::fill(H.at + i * H.stride, H.at + i * H.stride + 6, 0.);
    EXPECT_FALSE(fronts.factorise(0)) << body;
  }
}

}  // namespace exact_fronts_test
