// Which joints may be in a loop.
#include <pintle/solver/system/softness.h>

#include <gtest/gtest.h>

namespace exact_loops_test {

using Joints = std::vector<std::array<int, 2>>;

std::vector<char> loops(int bodies, const Joints& joints) {
  return pintle::findLoops(bodies, joints);
}

TEST(Loops, AChainHasNone) {
  EXPECT_EQ(loops(3, {{-1, 0}, {0, 1}, {1, 2}}), std::vector<char>(3, false));
  EXPECT_EQ(loops(3, {{0, 1}, {1, 2}}), std::vector<char>(2, false)) << "it is free";
}

TEST(Loops, AChainWithBothEndsOnTheGroundIsOne) {
  EXPECT_EQ(loops(2, {{-1, 0}, {0, 1}, {1, -1}}), std::vector<char>(3, true));
}

TEST(Loops, TwoJointsOfTheSameBodiesAreOne) {
  EXPECT_EQ(loops(2, {{0, 1}, {1, 0}}), std::vector<char>(2, true));
  EXPECT_EQ(loops(1, {{-1, 0}, {-1, 0}}), std::vector<char>(2, true));
}

// A triangle on a post, with a tail of two.
TEST(Loops, WhatHangsOnALoopIsNotInIt) {
  const std::vector<char> expected = {true, true, true, true, false, false};
  const Joints joints = {{-1, 0}, {0, 1}, {1, 2}, {2, 0}, {2, 3}, {3, 4}};
  const std::vector<char> found = loops(5, joints);
  for (size_t c = 1; c < joints.size(); ++c) EXPECT_EQ(found[c], expected[c]) << c;
}

TEST(Loops, AStarOfAThousandIsTakenOffEndByEnd) {
  Joints joints;
  for (int i = 1; i <= 1000; ++i) joints.push_back({0, i});
  EXPECT_EQ(loops(1001, joints), std::vector<char>(1000, false));
}

}  // namespace exact_loops_test
