// A processor is a hundred times as slow with denormal numbers. A solver that converges meets them wherever something
// is exactly 0: a door that turns in one plane.
#include <gtest/gtest.h>
#include <pintle/joints/quaternion_hinge.h>

#include <cfenv>

#include "physics_support.h"
#include "scenes/world.h"
#include "solver_of_tests.h"
#include "support.h"

namespace subnormal_test {

using support::vec;

TEST(Subnormal, ADoorDoesNotConvergeToTheLeastNumbers) {
  scenes::World world;
  const btVector3 half_extents = vec(0.5, 0.1, 0.1);
  btRigidBody& post = world.add_box(0, half_extents, scenes::pose_at(vec(-1, 0, 0)));
  btRigidBody& door = world.add_box(1, half_extents, scenes::pose_at(vec(0, 0, 0)));
  world.add_joint<pintle::QuaternionHinge>(post, door, scenes::pose_at(vec(0.5, 0, 0)),
                                           scenes::pose_at(vec(-0.5, 0, 0)));
  door.applyCentralImpulse(vec(0, 0.5, 0));
  const int steps = 600;
  int slow = 0;
  for (int i = 0; i < steps; ++i) {
    std::feclearexcept(FE_ALL_EXCEPT);
    world.step(1.0 / 60);
    slow += std::fetestexcept(FE_UNDERFLOW) != 0;
  }
  EXPECT_LT(slow, steps / 5);
  // It stays in its plane, exactly. (The exact solver takes all rows of the joint at once, which rounds.)
  const double rounding = onExactSolver() ? 100 * double(SIMD_EPSILON) : 0;
  EXPECT_NEAR(door.getAngularVelocity().x(), 0, rounding);
  EXPECT_NEAR(door.getAngularVelocity().y(), 0, rounding);
  EXPECT_NEAR(door.getCenterOfMassTransform().getBasis()[0].z(), 0, rounding);
  EXPECT_NEAR(door.getCenterOfMassTransform().getBasis()[1].z(), 0, rounding);
  EXPECT_GT(double(door.getAngularVelocity().z()), 0.5);
}

}  // namespace subnormal_test
