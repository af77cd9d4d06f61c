// A joint whose bodies do not move between Bullet's passes over its rows is left out of them, and nothing else changes.
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btNNCGConstraintSolver.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <gtest/gtest.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <scenes/world.h>

#include <memory>
#include <vector>

#include "support.h"

namespace rest_test {

using support::scalar;
using support::vec;

constexpr double dt = 1. / 60;

class CountingSolver : public btSequentialImpulseConstraintSolver {
 public:
  static int passes;

 protected:
  btScalar solveSingleIteration(int iteration, btCollisionObject** bodies, int body_count,
                                btPersistentManifold** manifolds, int manifold_count,
                                btTypedConstraint** joints, int joint_count,
                                const btContactSolverInfo& info, btIDebugDraw* drawer) override {
    ++passes;
    return btSequentialImpulseConstraintSolver::solveSingleIteration(
        iteration, bodies, body_count, manifolds, manifold_count, joints, joint_count, info,
        drawer);
  }
};
int CountingSolver::passes = 0;

// Bullet's passes over doors on one hinge each, in the mean over a fifth of a second: what turns by more than
// 0.05 rad a step looks ahead of each pass. They hang on the middle of an edge and
// fall from level, so that every row bears a load.
template <class Hinge>
double passes() {
  scenes::World world(scenes::standard_gravity, 10,
                      [] { return std::make_unique<CountingSolver>(); });
  for (int i = 0; i < 10; ++i) {
    btRigidBody& door =
        world.add_box(20, vec(0.45, 0.3, 0.02), scenes::pose_at(vec(2 * i + 0.45, 0, 0)));
    world.add_joint<Hinge>(door, vec(-0.45, 0.1, 0), vec(0, 1, 0));
  }
  CountingSolver::passes = 0;
  for (int i = 0; i < 12; ++i) world.step(dt);
  return CountingSolver::passes / 12.;
}

TEST(Rest, AJointThatNothingDisturbsIsSolvedByFourPassesOfTen) {
  if (BT_BULLET_VERSION < 287) GTEST_SKIP() << "Bullet makes all of its passes there";
  EXPECT_GT(passes<btHingeConstraint>(), 8);
  EXPECT_LE(passes<pintle::QuaternionHinge>(), 4);
}

// A chain that hangs at rest, or lies in space, whose last link is struck: Bullet takes the joints from the other end, so
// that each pass moves one more of them, and the first one is at rest for long. Returns where the links are after a second. A
// threshold that is never reached keeps a joint in all passes.
std::vector<btVector3> strike(bool rests, double gravity, const scenes::SolverFactory& solver) {
  scenes::World world(gravity, 10, solver);
  std::vector<btRigidBody*> links;
  for (int i = 0; i < 8; ++i) {
    links.push_back(&world.add_box(1, vec(0.1, 0.1, 0.5), scenes::pose_at(vec(0, 0, -i - 0.5))));
    auto& ball = i == 0
                     ? world.add_joint<pintle::BallJoint>(*links[0], vec(0, 0, 0.5))
                     : world.add_joint<pintle::BallJoint>(*links[size_t(i) - 1], *links[size_t(i)],
                                                          vec(0, 0, -0.5), vec(0, 0, 0.5));
    if (!rests) ball.setBreakingImpulseThreshold(scalar(1e6));
  }
  for (int i = 0; i < 10; ++i) world.step(dt);
  links.back()->applyImpulse(vec(0.5, 1, 0), vec(0, 0, -0.5));
  for (int i = 0; i < 60; ++i) world.step(dt);
  std::vector<btVector3> at;
  for (const btRigidBody* link : links) at.push_back(link->getCenterOfMassPosition());
  return at;
}

void expectNoDifference(double gravity, const scenes::SolverFactory& solver) {
  const std::vector<btVector3> at = strike(true, gravity, solver),
                               expected = strike(false, gravity, solver);
  for (size_t i = 0; i < at.size(); ++i)
    EXPECT_LT(double(at[i].distance(expected[i])), 2e-3) << "link " << i;
}

TEST(Rest, WhatIsStruckWakes) {
  for (const double gravity : {0., scenes::standard_gravity}) expectNoDifference(gravity, {});
}

// It adds to each row what it did in the pass before.
TEST(Rest, WhatIsStruckWakesWithConjugateGradients) {
  for (const double gravity : {0., scenes::standard_gravity})
    expectNoDifference(gravity, [] { return std::make_unique<btNNCGConstraintSolver>(); });
}

// As a contact does: moves a body after the rows of certain passes, and has no rows itself.
class Kicker : public btTypedConstraint {
 public:
  Kicker(btRigidBody& body, std::vector<int> at, const btVector3& by)
      : btTypedConstraint(POINT2POINT_CONSTRAINT_TYPE, body), m_at(std::move(at)), m_by(by) {}
  void buildJacobian() override { m_pass = 0; }
  void getInfo1(btConstraintInfo1* info) override { info->m_numConstraintRows = info->nub = 0; }
  void getInfo2(btConstraintInfo2*) override {}
  void solveConstraintObsolete(btSolverBody& a, btSolverBody&, btScalar) override {
    ++m_pass;
    for (const int at : m_at)
      if (at == m_pass) a.internalGetDeltaLinearVelocity() += m_by;
  }
  void setParam(int, btScalar, int) override {}
  btScalar getParam(int, int) const override { return 0; }

 private:
  std::vector<int> m_at;
  btVector3 m_by;
  int m_pass = 0;
};

// m/s, of a box that hangs at rest and is pushed down after these passes of a step. A chain of stock's
// joints keeps Bullet busy.
double speedAfter(const std::vector<int>& passes, bool busy) {
  scenes::World world(scenes::standard_gravity, 10);
  btRigidBody& box = world.add_box(1, vec(0.1, 0.1, 0.5), scenes::pose_at(vec(0, 0, -0.5)));
  world.add_joint<pintle::BallJoint>(box, vec(0, 0, 0.5));
  if (busy) {
    btRigidBody* last = nullptr;
    for (int i = 0; i < 4; ++i) {
      btRigidBody& link =
          world.add_box(1 + 5 * i, vec(0.5, 0.1, 0.1), scenes::pose_at(vec(5.5 + i, 0, 0)));
      if (last == nullptr)
        world.add_joint<btPoint2PointConstraint>(link, vec(-0.5, 0, 0));
      else
        world.add_joint<btPoint2PointConstraint>(*last, link, vec(0.5, 0, 0), vec(-0.5, 0, 0));
      last = &link;
    }
  }
  world.step(dt);
  world.add_joint<Kicker>(box, passes, vec(0, 0, -0.01));
  world.step(dt);
  return double(box.getLinearVelocity().length());
}

TEST(Rest, AJointThatUndoesAPushDoesNotRest) {
  EXPECT_LT(speedAfter({1, 2}, false), 1e-5);
  EXPECT_LT(speedAfter({1, 2, 3}, false), 1e-5);
}

TEST(Rest, APushBeforeTheLastPassIsAnswered) {
  for (const int pass : {3, 4, 6, 9}) EXPECT_LT(speedAfter({pass}, true), 1e-5) << pass;
}

}  // namespace rest_test
