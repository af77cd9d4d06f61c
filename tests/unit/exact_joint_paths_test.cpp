// What joints do to impulses on their bodies, by paths through the factor, against dense matrices.
#include <pintle/solver/system/joint_matrix.h>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

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
  const Vector3d zero = Vector3d::Zero();
  const pintle::RowJacobian along{zero, zero, Vector3d::UnitX(), zero};
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
      matrix.findPath({-1, body}, none, blocks);
    }
    act(true);
    blocks.clear();
    for (int body = 0; body <= joints; ++body) matrix.findPath({-1, body}, along, blocks);
    for (const pintle::PathBlock& block : blocks)
      for (const double number : block.adds) EXPECT_TRUE(std::isfinite(number)) << idle;
  }
}

}  // namespace exact_joint_paths_test
