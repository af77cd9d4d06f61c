// Nets of joints with limits and springs (solve/projection.cpp), under a body that its owner moves: skirts as character viewers build them.
#include <pintle/joints/generic_6dof_spring_joint.h>
#include <pintle/solver/exact_joint_solver.h>

#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpringConstraint.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "scenes/world.h"
#include "support.h"

namespace exact_nets_test {
namespace {

using support::scalar;
using support::vec;
constexpr double degree = scenes::pi / 180;
constexpr double dance = 3, end = 7;  // s

scenes::SolverFactory solverOf(bool exact) {
  if (exact) return [] { return std::make_unique<pintle::ExactJointSolver>(); };
  return [] { return std::make_unique<btSequentialImpulseConstraintSolver>(); };
}

btTransform at(double turn, const btVector3& place) {
  return btTransform(btQuaternion(vec(0, 1, 0), scalar(turn)), place);
}

// A body that its owner puts where it is to be, before each step.
void makeKinematic(btRigidBody& body) {
  body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
}

// 16 columns of 5 plates of boxes of 0.1 m. Joint: of each plate with the one above it or the hip, and, at its middle, with the one beside it.
// Points hold, angles are limited, with springs of k N m/rad.
template <class Joint>
class Skirt {
 public:
  Skirt(bool exact, double k) : m_world(0, 10, solverOf(exact)), m_k(k) {
    m_world.bullet().setGravity(vec(0, -98, 0));
    makeKinematic(m_hip);
    build();
  }

  double gap = 0;     // the largest, in 0.1 m
  double passed = 0;  // degrees: the most that a limit is passed by
  double speed = 0;   // rad/s: the largest in the last second
  int not_converged = 0, steps = 0;

  void play(bool exact) {
    constexpr double rate = 60;
    for (int i = 0; i < int(end * rate); ++i, ++steps) {
      const double t = std::min(dance, (i + 1) / rate);
      m_hip.setWorldTransform(at(0.7 * std::sin(2 * scenes::pi * 1.2 * t),
                                 vec(2 * std::sin(2 * scenes::pi * 0.8 * t), 10, 0)));
      m_world.step(1 / rate);
      if (exact) not_converged += pintle::lastStep(m_world.bullet()).not_converged > 0;
      measure(i / rate > end - 1);
    }
  }

 private:
  struct Limited {
    Joint* joint;
    btVector3 low, high;  // degrees
  };

  void build() {
    constexpr int columns = 16, rows = 5;
    constexpr double column = 2 * scenes::pi / columns;
    btRigidBody* plates[columns][rows];
    const auto place = [](double turn, double radius, double below) {
      return at(turn, vec(radius * std::sin(turn), 10 - 0.9 * below, radius * std::cos(turn)));
    };
    for (int c = 0; c < columns; ++c)
      for (int r = 0; r < rows; ++r) {
        const double turn = column * c;
        plates[c][r] = &m_world.add_box(1 - 0.1 * r, vec(0.22, 0.42, 0.05),
                                        place(turn, 1.2 + 0.18 * (r + 0.5), r + 0.5));
        plates[c][r]->setDamping(scalar(0.9), scalar(0.9));
        join(r > 0 ? *plates[c][r - 1] : m_hip, *plates[c][r], place(turn, 1.2 + 0.18 * r, r),
             vec(-30, -5, -10), vec(40, 5, 10));
      }
    for (int c = 0; c < columns; ++c)
      for (int r = 1; r < rows; ++r)
        join(*plates[c][r], *plates[(c + 1) % columns][r],
             place(column * (c + 0.5), (1.2 + 0.18 * (r + 0.5)) * std::cos(column / 2), r + 0.5),
             vec(-20, -20, -20), vec(20, 20, 20));
  }

  void join(btRigidBody& a, btRigidBody& b, const btTransform& frame, const btVector3& low,
            const btVector3& high) {
    auto& joint = m_world.join<Joint>(a, b, frame, true);
    joint.setLinearLowerLimit(vec(0, 0, 0));
    joint.setLinearUpperLimit(vec(0, 0, 0));
    joint.setAngularLowerLimit(low * scalar(degree));
    joint.setAngularUpperLimit(high * scalar(degree));
    for (int i = 3; i < 6 && m_k > 0; ++i) {
      joint.enableSpring(i, true);
      joint.setStiffness(i, scalar(m_k));
    }
    m_joints.push_back({&joint, low, high});
  }

  // (Where Bullet's joints are, with their hip, is known in the next step.)
  void measure(bool at_rest) {
    for (const Limited& of : m_joints) {
      if (&of.joint->getRigidBodyA() == &m_hip) continue;
      of.joint->calculateTransforms();
      const btVector3 apart = of.joint->getCalculatedTransformA().getOrigin() -
                              of.joint->getCalculatedTransformB().getOrigin();
      gap = std::max(gap, double(apart.length()));
      for (int i = 0; i < 3; ++i) {
        const double angle = double(of.joint->getAngle(i)) / degree;
        passed = std::max({passed, angle - double(of.high[i]), double(of.low[i]) - angle});
      }
      if (at_rest)
        speed = std::max(speed, double(of.joint->getRigidBodyB().getAngularVelocity().length()));
    }
  }

  scenes::World m_world;
  const double m_k;
  btRigidBody& m_hip = m_world.add_box(0, vec(0.8, 0.5, 0.6), at(0, vec(0, 10, 0)));
  std::vector<Limited> m_joints;
};

template <class Joint>
class Nets : public testing::Test {};
using Joints = testing::Types<pintle::Generic6DofSpringJoint, btGeneric6DofSpringConstraint>;
TYPED_TEST_SUITE(Nets, Joints);

// Plates in loops have ways to move that close next to nothing, and limits that many of them meet at once.
TYPED_TEST(Nets, ASkirtHoldsTogetherWithinItsLimitsAndComesToRest) {
  for (const double k : {10., 100.}) {
    SCOPED_TRACE(k);
    Skirt<btGeneric6DofSpringConstraint> stock(false, k);
    stock.play(false);
    Skirt<TypeParam> skirt(true, k);
    skirt.play(true);
    EXPECT_LT(skirt.gap, stock.gap / 10);
    EXPECT_LT(skirt.passed, 10) << "degrees";
    EXPECT_LT(skirt.passed, stock.passed / 5) << "degrees";
    EXPECT_LT(skirt.speed, 0.1) << "rad/s";
    EXPECT_LT(skirt.not_converged, skirt.steps / 2);
  }
}

// Without springs nothing but friction of the air brings plates to rest between their limits: they tremble, as on Bullet's solver.
TEST(Net, OfLimitsAloneHoldsTogether) {
  Skirt<pintle::Generic6DofSpringJoint> skirt(true, 0);
  skirt.play(true);
  EXPECT_LT(skirt.gap, 0.05) << "of plates 0.84 high";
  EXPECT_LT(skirt.passed, 10) << "degrees";
}

}  // namespace
}  // namespace exact_nets_test
