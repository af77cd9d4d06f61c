// What an island says of a joint's rows is what they are.
#include <pintle/joints/quaternion_hinge.h>

#include <gtest/gtest.h>

#include "island_problem.h"
#include "support.h"

namespace exact_island_test {

using island_problem::IslandProblem;
using support::scalar;
using support::vec;

// A spring without a damper that steps resolve gives an impulse that is known. Of a locked hinge it was an equality before.
TEST(Island, KnowsWhichRowsAreNoEqualities) {
  for (const double frequency : {0., 0.5, 1000.}) {
    for (const double damping : {0., 1.}) {
      IslandProblem of;
      btRigidBody &post = of.add(0, vec(0, 0, 0)), &door = of.add(1, vec(1, 0, 0));
      auto& hinge = of.join<pintle::QuaternionHinge>(post, door, vec(0, 0, 0), vec(-1, 0, 0),
                                                     vec(0, 1, 0), vec(0, 1, 0));
      hinge.setLimit(scalar(0.3), scalar(0.3));
      hinge.setLimitSpring(scalar(frequency), scalar(damping));
      of.build(0.2);
      const pintle::Island& island = of.island;
      ASSERT_EQ(island.joints.size(), 1u);
      int bounded = 0;
      for (const pintle::IslandRow& row : island.rows) bounded += !row.law.isEquality();
      EXPECT_EQ(bounded, frequency == 0.5 && damping == 0 ? 1 : 0) << frequency << ' ' << damping;
      EXPECT_EQ(island.joints[0].bounded, bounded) << frequency << ' ' << damping;
    }
  }
}

}  // namespace exact_island_test
