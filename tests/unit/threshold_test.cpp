// A breaking threshold changes nothing until it is exceeded, and it is exceeded by the load that the joint bears.
#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <gtest/gtest.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <scenes/chain.h>

#include <functional>

#include "solver_of_tests.h"
#include "support.h"

namespace threshold_test {

using support::scalar;
using support::vec;

constexpr double dt = 1. / 60;

// Mean gap of a chain of ten links that is let go from the horizontal, m.
double gap(double threshold, double load, int iterations) {
  scenes::World world(scenes::standard_gravity, iterations);
  std::vector<btRigidBody*> links;
  for (int i = 0; i < 10; ++i) {
    links.push_back(
        &world.add_box(i == 9 ? load : 1, vec(0.5, 0.1, 0.1), scenes::pose_at(vec(i + 0.5, 0, 0))));
    const btVector3 axis = i % 2 == 0 ? vec(0, 1, 0) : vec(0, 0.8, 0.6);
    pintle::QuaternionHinge& hinge =
        i == 0
            ? world.add_joint<pintle::QuaternionHinge>(*links[0], vec(-0.5, 0, 0), axis)
            : world.add_joint<pintle::QuaternionHinge>(*links[size_t(i) - 1], *links[size_t(i)],
                                                       vec(0.5, 0, 0), vec(-0.5, 0, 0), axis, axis);
    if (threshold > 0) hinge.setBreakingImpulseThreshold(scalar(threshold));
  }
  double sum = 0;
  for (int step = 0; step < 180; ++step) {
    world.step(dt);
    double most = 0;
    for (size_t i = 0; i < links.size(); ++i) {
      const Eigen::Vector3d held =
          i == 0 ? Eigen::Vector3d(0, 0, 0) : scenes::point_in_world(*links[i - 1], {0.5, 0, 0});
      most = std::max(most, (scenes::point_in_world(*links[i], {-0.5, 0, 0}) - held).norm());
    }
    sum += most / 180;
  }
  return sum;
}

TEST(Threshold, ChangesNothingUntilItIsExceeded) {
  for (const double load : {1., 10., 100.})
    for (const int iterations : {10, 100})
      EXPECT_LT(gap(1e6, load, iterations), 1.05 * gap(0, load, iterations) + 1e-6)
          << load << ' ' << iterations;
}

// Whether a box of 3 kg that hangs at rest stays on its joint when the threshold is so many times m g dt, at a rate of steps, Hz.
template <class Joint, class... Arguments>
bool holds(double times, double rate, Arguments... pivot) {
  constexpr double mass = 3;
  scenes::World world;
  btRigidBody& body = world.add_box(mass, vec(0.2, 0.2, 0.2), scenes::pose_at(vec(0, 0, -0.5)));
  Joint& joint = world.add_joint<Joint>(body, pivot...);
  const int steps = int(2 * rate);
  for (int i = 0; i < steps; ++i) world.step(1 / rate);
  joint.setBreakingImpulseThreshold(scalar(times * mass * scenes::standard_gravity / rate));
  for (int i = 0; i < steps; ++i) world.step(1 / rate);
  return joint.isEnabled();
}

TEST(Threshold, IsExceededByTheLoadAsOfStockJoints) {
  const btVector3 pivot = vec(0, 0, 0.5), axis = vec(0, 1, 0);
  for (const double rate : {30., 60., 120., 240.})
    for (const double times : {0.5, 0.9, 1.1, 2.}) {
      SCOPED_TRACE(testing::Message() << times << ", " << rate << " Hz");
      EXPECT_EQ((holds<pintle::BallJoint>(times, rate, pivot)), times > 1);
      EXPECT_EQ((holds<btPoint2PointConstraint>(times, rate, pivot)), times > 1);
      EXPECT_EQ((holds<pintle::QuaternionHinge>(times, rate, pivot, axis)), times > 1);
      EXPECT_EQ((holds<btHingeConstraint>(times, rate, pivot, axis)), times > 1);
    }
}

// What a blow may give through a joint that breaks by it is the threshold, as with stock's. The exact solver takes the step without
// such a joint.
TEST(Threshold, IsAllThatAJointThatBreaksGives) {
  constexpr double threshold = 2, speed = 10;
  scenes::World world(0);
  btRigidBody& body = world.add_box(1, vec(0.2, 0.2, 0.2), scenes::pose_at(vec(0, 0, 0)));
  auto& joint = world.add_joint<pintle::BallJoint>(body, vec(0, 0, 0));
  joint.setBreakingImpulseThreshold(scalar(threshold));
  for (int i = 0; i < 3; ++i) world.step(dt);
  body.setLinearVelocity(vec(speed, 0, 0));
  world.step(dt);
  EXPECT_FALSE(joint.isEnabled());
  const double given = onExactSolver() ? 0 : threshold;
  EXPECT_NEAR(double(body.getLinearVelocity().x()), speed - given, 1e-3);
}

// A body that its factors hold along some axes moves as the joint says along the others, and gains nothing.
TEST(LockedFactors, GainNoEnergy) {
  const btVector3 kinds[] = {vec(0, 1, 0), vec(0, 0, 1), vec(1, 0, 1), vec(0, 0, 0)};
  for (const btVector3& factor : kinds)
    for (const double tilt : {0.3, 1., 2.}) {
      scenes::World world;
      const btTransform turn(btQuaternion(vec(0.6, 0.8, 0), scalar(tilt)));
      btRigidBody& body = world.add_box(1, vec(0.1, 0.2, 0.5),
                                        btTransform(turn.getBasis(), turn(vec(0, 0.1, -0.5))));
      body.setLinearFactor(factor);
      world.add_joint<pintle::BallJoint>(body, vec(0, -0.1, 0.5));
      const double start = scenes::energy(body, scenes::standard_gravity);
      double most = start;
      for (int i = 0; i < 300; ++i) {
        world.step(dt);
        most = std::max(most, scenes::energy(body, scenes::standard_gravity));
      }
      // 3 % of what a swing exchanges; a body that its joint pulled along a held axis gained hundreds of joules.
      const double exchanged = 2 * 0.51 * scenes::standard_gravity;
      EXPECT_LT(most, start + 0.03 * exchanged)
          << factor.x() << factor.y() << factor.z() << ' ' << tilt;
    }
}

}  // namespace threshold_test
