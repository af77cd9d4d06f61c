// The exact solver beside multibodies: an arm that pushes, carries and stands by what joints hold.
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/solver/exact_multi_body_joint_solver.h>

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletDynamics/Featherstone/btMultiBodyPoint2Point.h>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "exact_worlds.h"
#include "physics_support.h"
#include "support.h"

namespace exact_worlds {
namespace {

using physics::rounding;
using support::scalar;

constexpr double held = 2e-9;  // m: of three rows, each to 1e-9

/// An arm of two links of 1 m and 2 kg that turn about z, on a base that is fixed at x; its links collide.
class Arm {
 public:
  Arm(btMultiBodyDynamicsWorld& world, const btVector3& x)
      : tree(2, 0, btVector3(0, 0, 0), true, false), m_world(world), m_shape(vec(0.5, 0.1, 0.1)) {
    btVector3 inertia;
    m_shape.calculateLocalInertia(2, inertia);
    const btQuaternion none = btQuaternion::getIdentity();
    for (int i = 0; i < 2; ++i)
      tree.setupRevolute(i, 2, inertia, i - 1, none, vec(0, 0, 1), vec(i > 0 ? 0.5 : 0, 0, 0),
                         vec(0.5, 0, 0), true);
    tree.setBasePos(x);
    tree.finalizeMultiDof();
    tree.setLinearDamping(0);
    tree.setAngularDamping(0);
    tree.setCanSleep(false);
    world.addMultiBody(&tree);
    for (int i = 0; i < 2; ++i) {
      m_colliders.push_back(std::make_unique<btMultiBodyLinkCollider>(&tree, i));
      m_colliders.back()->setCollisionShape(&m_shape);
      m_colliders.back()->setActivationState(DISABLE_DEACTIVATION);
      tree.getLink(i).m_collider = m_colliders.back().get();
      world.addCollisionObject(m_colliders.back().get(), 2, -1 ^ 2);
    }
    btAlignedObjectArray<btQuaternion> turns;
    btAlignedObjectArray<btVector3> origins;
    tree.forwardKinematics(turns, origins);
    tree.updateCollisionObjectWorldTransforms(turns, origins);
  }
  ~Arm() {
    for (const auto& row : m_rows) m_world.removeMultiBodyConstraint(row.get());
    for (const auto& collider : m_colliders) m_world.removeCollisionObject(collider.get());
    m_world.removeMultiBody(&tree);
  }
  Arm(const Arm&) = delete;
  Arm& operator=(const Arm&) = delete;

  void constrain(std::unique_ptr<btMultiBodyConstraint> row) {
    m_world.addMultiBodyConstraint(row.get());
    m_rows.push_back(std::move(row));
  }
  std::vector<btScalar> state() const {
    return {tree.getJointPos(0), tree.getJointPos(1), tree.getJointVel(0), tree.getJointVel(1)};
  }

  btMultiBody tree;

 private:
  btMultiBodyDynamicsWorld& m_world;
  btBoxShape m_shape;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> m_colliders;
  std::vector<std::unique_ptr<btMultiBodyConstraint>> m_rows;
};

template <class Solver>
struct MultiBodyWorld : Bullet {
  Solver solver;
  btMultiBodyDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
};

TEST(ExactMultiBodySolver, HoldsChainsBesideAnArm) {
  MultiBodyWorld<pintle::ExactMultiBodyJointSolver> of;
  Bodies bodies(of.world);
  bodies.addChain(10, vec(0, 5, 0));
  bodies.addChain(5, vec(0, -5, 0), 100);
  Arm arm(of.world, vec(0, 0, 0));
  arm.constrain(std::make_unique<btMultiBodyJointMotor>(&arm.tree, 0, 2, 5));
  for (int i = 0; i < 300; ++i) {
    of.world.stepSimulation(scalar(dt), 0, scalar(dt));
    ASSERT_LE(bodies.largestGap(), rounding(1e-4, held)) << i;
  }
  EXPECT_NEAR(double(arm.tree.getJointVel(0)), 2, 1e-2) << "it turns";
  EXPECT_EQ(of.solver.lastStep().components, 2);
}

/// m: how far the hinge is open.
double gapOf(const pintle::QuaternionHinge& hinge) {
  return double(
      (hinge.getRigidBodyA().getCenterOfMassTransform() * hinge.getFrameOffsetA().getOrigin() -
       hinge.getRigidBodyB().getCenterOfMassTransform() * hinge.getFrameOffsetB().getOrigin())
          .length());
}

TEST(ExactMultiBodySolver, AnArmPushesADoorThatHolds) {
  MultiBodyWorld<pintle::ExactMultiBodyJointSolver> of;
  Bodies bodies(of.world);
  btRigidBody& wall = bodies.add(0, vec(0.1, 0.1, 0.1), vec(1, 1, 0));
  btRigidBody& door = bodies.add(20, vec(0.6, 0.05, 1), vec(1.65, 1, 0), true);
  door.setFriction(scalar(0.5));
  auto made = std::make_unique<pintle::QuaternionHinge>(wall, door, vec(0, 0, 0), vec(-0.65, 0, 0),
                                                        vec(0, 0, 1), vec(0, 0, 1));
  pintle::QuaternionHinge& hinge = *made;
  bodies.join(std::move(made));
  Arm arm(of.world, vec(0, 0.5, 0));
  arm.constrain(std::make_unique<btMultiBodyJointMotor>(&arm.tree, 0, 1, 5));
  arm.constrain(std::make_unique<btMultiBodyJointMotor>(&arm.tree, 1, 0, 5));
  double turned = 0;
  for (int i = 0; i < 120; ++i) {
    of.world.stepSimulation(scalar(dt), 0, scalar(dt));
    ASSERT_LE(gapOf(hinge), rounding(1e-5, held)) << i;
    turned = std::max(turned, std::abs(double(hinge.getHingeAngle())));
  }
  EXPECT_GT(turned, 0.3);
  EXPECT_LT(double(door.getAngularVelocity().length()), 10);
}

TEST(ExactMultiBodySolver, AChainHangsOnAnArm) {
  MultiBodyWorld<pintle::ExactMultiBodyJointSolver> of;
  Bodies bodies(of.world);
  btRigidBody* last = nullptr;
  std::vector<btRigidBody*> links;
  for (int i = 0; i < 5; ++i) {
    btRigidBody& link = bodies.add(1, vec(0.05, 0.05, 0.25), vec(2, 0, -0.25 - 0.5 * i));
    if (last != nullptr)
      bodies.join(
          std::make_unique<pintle::BallJoint>(*last, link, vec(0, 0, -0.25), vec(0, 0, 0.25)));
    last = &link;
    links.push_back(&link);
  }
  Arm arm(of.world, vec(0, 0, 0));
  arm.constrain(std::make_unique<btMultiBodyPoint2Point>(&arm.tree, 1, links[0], vec(0.5, 0, 0),
                                                         vec(0, 0, 0.25)));
  arm.constrain(std::make_unique<btMultiBodyJointMotor>(&arm.tree, 0, 1, 10));
  arm.constrain(std::make_unique<btMultiBodyJointMotor>(&arm.tree, 1, 0, 10));
  for (int i = 0; i < 300; ++i) {
    of.world.stepSimulation(scalar(dt), 0, scalar(dt));
    ASSERT_LE(bodies.largestGap(), rounding(1e-4, held)) << i;
    const btVector3 tip = arm.tree.localPosToWorld(1, vec(0.5, 0, 0)),
                    top = links[0]->getCenterOfMassTransform() * vec(0, 0, 0.25);
    ASSERT_LE(double((tip - top).length()), 0.05) << i;
  }
}

/// The states of an arm that meets its limit, of one that pushes a box, and of a free box on the ground.
template <class Solver>
std::vector<btScalar> playArms(bool with_chain) {
  MultiBodyWorld<Solver> of;
  of.world.getSolverInfo().m_minimumSolverBatchSize = 1;
  Bodies bodies(of.world);
  bodies.add(0, vec(20, 20, 1), vec(0, 0, -1.5), true);
  bodies.add(1, vec(0.3, 0.3, 0.3), vec(1.5, 1, -0.2), true);
  bodies.add(1, vec(0.3, 0.3, 0.3), vec(8, 8, 0), true);
  Arm arm(of.world, vec(0, 0, 0)), other(of.world, vec(-5, 0, 0));
  arm.constrain(std::make_unique<btMultiBodyJointMotor>(&arm.tree, 0, 2, 5));
  other.tree.setJointVel(1, 3);
  other.constrain(
      std::make_unique<btMultiBodyJointLimitConstraint>(&other.tree, 1, scalar(-1), scalar(1)));
  std::unique_ptr<Bodies> beside;
  if (with_chain) {
    beside = std::make_unique<Bodies>(of.world);
    beside->addChain(3, vec(0, 20, 5));
  }
  std::vector<btScalar> all;
  for (int i = 0; i < 120; ++i) {
    of.world.stepSimulation(scalar(dt), 0, scalar(dt));
    for (const auto& state : {arm.state(), other.state(), bodies.state()})
      all.insert(all.end(), state.begin(), state.end());
  }
  return all;
}

TEST(ExactMultiBodySolver, MultibodiesMoveAsOnBulletsSolver) {
  const std::vector<btScalar> stock = playArms<btMultiBodyConstraintSolver>(false);
  EXPECT_TRUE(stock == playArms<pintle::ExactMultiBodyJointSolver>(false));
  EXPECT_TRUE(stock == playArms<pintle::ExactMultiBodyJointSolver>(true)) << "beside a chain";
}

}  // namespace
}  // namespace exact_worlds
