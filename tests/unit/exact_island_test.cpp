// What an island says of a joint's rows is what they are.
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/solver/island_builder.h>

#include <gtest/gtest.h>
#include <scenes/world.h>

#include "support.h"

namespace exact_island_test {

using support::scalar;
using support::vec;

btSolverBody asSolverBody(btRigidBody& body) {
  btSolverBody to = {};
  to.m_originalBody = body.getInvMass() > 0 ? &body : nullptr;
  to.m_worldTransform = body.getCenterOfMassTransform();
  to.m_linearVelocity = body.getLinearVelocity();
  to.m_angularVelocity = body.getAngularVelocity();
  to.m_externalForceImpulse = to.m_externalTorqueImpulse = vec(0, 0, 0);
  return to;
}

// A spring without a damper that steps resolve gives an impulse that is known. Of a locked hinge it was an equality before.
TEST(Island, KnowsWhichRowsAreNoEqualities) {
  for (const double frequency : {0., 0.5, 1000.}) {
    for (const double damping : {0., 1.}) {
      scenes::World world(0);
      btRigidBody &post = world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0))),
                  &door = world.add_box(1, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(1, 0, 0)));
      auto& hinge = world.add_joint<pintle::QuaternionHinge>(
          post, door, vec(0, 0, 0), vec(-1, 0, 0), vec(0, 1, 0), vec(0, 1, 0));
      hinge.setLimit(scalar(0.3), scalar(0.3));
      hinge.setLimitSpring(scalar(frequency), scalar(damping));
      btContactSolverInfo info;
      info.m_timeStep = btScalar(1) / 60;
      pintle::SolverBodies bodies;
      bodies.push_back(asSolverBody(post));
      bodies.push_back(asSolverBody(door));
      pintle::Island island;
      const pintle::SolverOptions options;
      pintle::IslandBuilder builder(island, options);
      std::vector<pintle::Component> components;
      builder.begin(info);
      builder.add(hinge, bodies, 0, 1);
      builder.finish(components);
      ASSERT_EQ(island.joints.size(), 1u);
      int bounded = 0;
      for (const pintle::IslandRow& row : island.rows) bounded += !row.law.isEquality();
      EXPECT_EQ(bounded, frequency == 0.5 && damping == 0 ? 1 : 0) << frequency << ' ' << damping;
      EXPECT_EQ(island.joints[0].bounded, bounded) << frequency << ' ' << damping;
    }
  }
}

}  // namespace exact_island_test
