// Actions of joints between Bullet's passes over their rows (bullet_passes.cpp): impulses of the last step start the
// next where joints bear on each other, and disturb nothing where they do not.
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <gtest/gtest.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <scenes/chain.h>

#include <array>

#include "support.h"

namespace passes_test {

using pintle::BallJoint;
using support::scalar;
using support::vec;

std::unique_ptr<btConstraintSolver> make_bullets() {
  return std::make_unique<btSequentialImpulseConstraintSolver>();
}

// A rod of boxes that hangs from the world on ball joints, with a load at its end.
template <class Ball = BallJoint>
class Rod {
 public:
  static constexpr int links = 6;

  explicit Rod(double load = 10, int iterations = 10, double threshold = 0)
      : world_(scenes::standard_gravity, iterations, make_bullets) {
#if BT_BULLET_VERSION >= 287
    world_.bullet().getSolverInfo().m_leastSquaresResidualThreshold = scalar(threshold);
#else
    (void)threshold;  // Bullet has none
#endif
    for (int i = 0; i < links; ++i) {
      bodies_.push_back(&world_.add_box(i + 1 < links ? 1 : load, vec(0.1, 0.1, 0.5),
                                        scenes::pose_at(vec(0, 0, -0.5 - i))));
      if (i == 0)
        world_.add_joint<Ball>(*bodies_[0], vec(0, 0, 0.5));
      else
        world_.add_joint<Ball>(*bodies_[size_t(i) - 1], *bodies_[size_t(i)], vec(0, 0, -0.5),
                               vec(0, 0, 0.5));
    }
  }
  btDynamicsWorld& world() { return world_.bullet(); }
  void step(double dt) { world_.step(dt); }
  // By how much it is longer than its links, m.
  double stretch() const { return -scenes::position(*bodies_.back()).z() - (links - 0.5); }
  // Between a link and the one above it, m.
  double gap(int i) const {
    const auto at = [&](int link, double z) {
      return bodies_[size_t(link)]->getWorldTransform()(vec(0, 0, z));
    };
    return double((at(i, 0.5) - at(i - 1, -0.5)).length());
  }
  double speed() const { return double(bodies_.back()->getLinearVelocity().length()); }
  btRigidBody& body(int i) { return *bodies_[size_t(i)]; }

 private:
  scenes::World world_;
  std::vector<btRigidBody*> bodies_;
};

// How far the rod stretches after it has come to rest, m: `dt` by turns.
template <class Ball>
double stretchAtRest(double load, int iterations, std::initializer_list<double> dt) {
  Rod<Ball> rod(load, iterations);
  double most = 0;
  for (int i = 0; i < 480; ++i) {
    rod.step(dt.begin()[size_t(i) % dt.size()]);
    if (i >= 240) most = std::max(most, std::abs(rod.stretch()));
  }
  return most;
}

TEST(Passes, WhatALoadTakesIsFoundOverTheSteps) {
  for (const double load : {1., 10., 50.})
    for (const int iterations : {10, 30})
      EXPECT_LT(1.5 * stretchAtRest<BallJoint>(load, iterations, {1. / 60}),
                stretchAtRest<btPoint2PointConstraint>(load, iterations, {1. / 60}))
          << load << ' ' << iterations;
}

TEST(Passes, StepsOfAnyLengthFollowEachOther) {
  for (const double load : {1., 10., 50.})
    for (const int iterations : {10, 30})
      EXPECT_LT(stretchAtRest<BallJoint>(load, iterations, {1. / 60, 1. / 240}),
                stretchAtRest<btPoint2PointConstraint>(load, iterations, {1. / 60, 1. / 240}))
          << load << ' ' << iterations;
}

// Bullet ends a step whose first pass changed less than its threshold: what then started would stay.
TEST(Passes, AStepThatEndsAfterItsFirstPassIsNotKicked) {
  Rod<> rod(20, 10, 1e-6);
  rod.world().getSolverInfo().m_erp = 0;  // or what the rod has stretched would be taken away
  for (int i = 0; i < 240; ++i) rod.step(1. / 60);
  for (int i = 0; i < Rod<>::links; ++i) {
    rod.body(i).setLinearVelocity(vec(0, 0, 0));
    rod.body(i).setAngularVelocity(vec(0, 0, 0));
    rod.body(i).setGravity(vec(0, 0, 0));
  }
  rod.step(1. / 60);
  EXPECT_LT(rod.speed(), 1e-4);
}

// A joint that nothing disturbs is solved by the first pass, as it is by the only one: as long as no body turns
// so far in a step that it is to be looked where that leads.
TEST(Passes, AJointAloneIsWhatItWasInOnePass) {
  const auto end = [](int iterations) {
    scenes::World world(scenes::standard_gravity, iterations, make_bullets);
    btRigidBody& body = world.add_box(1, vec(0.5, 0.1, 0.2), scenes::pose_at(vec(0.5, 0, 0)));
    world.add_joint<BallJoint>(body, vec(-0.5, 0, 0));
    for (int i = 0; i < 480; ++i) world.step(1. / 240);
    return scenes::position(body);
  };
  const Eigen::Vector3d once = end(1), twice = end(2), often = end(20);
  EXPECT_LT((twice - often).norm(), sizeof(btScalar) == sizeof(double) ? 1e-12 : 1e-4);
  // One pass does not show whether others disturb it: of the bend of its first steps it foresees less.
  EXPECT_LT((once - often).norm(), sizeof(btScalar) == sizeof(double) ? 1e-6 : 1e-4);
}

// What bears on nothing any more is not pulled by what it bore.
TEST(Passes, AJointThatWasDisabledBeginsFromNothing) {
  Rod<> rod;
  for (int i = 0; i < 120; ++i) rod.step(1. / 60);
  btTypedConstraint& joint = *rod.body(Rod<>::links - 1).getConstraintRef(0);
  joint.setEnabled(false);
  btRigidBody& load = rod.body(Rod<>::links - 1);
  load.setGravity(vec(0, 0, 0));
  load.setLinearVelocity(vec(0, 0, 0));
  for (int i = 0; i < Rod<>::links; ++i) rod.body(i).setGravity(vec(0, 0, 0));
  for (int i = 0; i < 10; ++i) rod.step(1. / 60);
  joint.setEnabled(true);
  const double before = double(load.getLinearVelocity().length());
  // The part of the gap that ERP takes away, and no more.
  const double closing = 0.2 * 60 * rod.gap(Rod<>::links - 1);
  rod.step(1. / 60);
  EXPECT_LT(double(load.getLinearVelocity().length()), before + closing + 0.01);
}

// Two boxes of 1 m, one behind the other.
std::array<btRigidBody*, 2> addBoxes(scenes::World& world) {
  const auto add = [&](double x) {
    return &world.add_box(1, vec(0.5, 0.1, 0.1), scenes::pose_at(vec(x, 0, 0)));
  };
  return {add(0.5), add(1.5)};
}

// They fall about the world's x axis, and whirl. The largest gap after the first second, m.
template <class Ball>
double gapOfWhirl(int iterations) {
  scenes::World world(scenes::standard_gravity, iterations, make_bullets);
  const auto bodies = addBoxes(world);
  const auto& first = world.add_joint<Ball>(*bodies[0], vec(-0.5, 0, 0));
  const auto& second =
      world.add_joint<Ball>(*bodies[0], *bodies[1], vec(0.5, 0, 0), vec(-0.5, 0, 0));
  double most = 0;
  for (int i = 0; i < 600; ++i) {
    world.step(1. / 60);
    if (i < 60) continue;
    for (const auto* joint : {&first, &second}) {
      const btVector3 a = joint->getRigidBodyA().getCenterOfMassTransform()(joint->getPivotInA()),
                      b = joint->getRigidBodyB().getCenterOfMassTransform()(joint->getPivotInB());
      most = std::max(most, double((b - a).length()));
    }
  }
  return most;
}

// They turn by up to 0.3 rad in a step.
TEST(Passes, WhatWhirlsEndsTheStepTogether) {
  for (const int iterations : {10, 50}) {
    const double ours = gapOfWhirl<BallJoint>(iterations);
    EXPECT_LT(3 * ours, gapOfWhirl<btPoint2PointConstraint>(iterations)) << iterations;
  }
}

// The same on hinges that stop at half a radian each: how far beyond they lie at rest, rad.
template <class Hinge>
double beyondLimits() {
  scenes::World world(scenes::standard_gravity, 10, make_bullets);
  const auto bodies = addBoxes(world);
  const btVector3 y = vec(0, 1, 0);
  Hinge* hinges[] = {
      &world.add_joint<Hinge>(*bodies[0], vec(-0.5, 0, 0), y),
      &world.add_joint<Hinge>(*bodies[0], *bodies[1], vec(0.5, 0, 0), vec(-0.5, 0, 0), y, y)};
  for (Hinge* hinge : hinges) hinge->setLimit(scalar(-0.5), scalar(0.5));
  for (int i = 0; i < 600; ++i) world.step(1. / 60);
  double most = 0;
  for (Hinge* hinge : hinges) most = std::max(most, std::abs(double(hinge->getHingeAngle())) - 0.5);
  return most;
}

TEST(Passes, WhatLiesOnALimitIsBorne) {
  const double ours = beyondLimits<pintle::QuaternionHinge>();
  EXPECT_LT(ours, beyondLimits<btHingeConstraint>());
}

TEST(Passes, AHeavyChainIsHeldBetterThanByStocks) {
  scenes::ChainSettings settings;
  settings.ratio = 100;
  settings.make_solver = make_bullets;
  for (const int iterations : {20, 50, 100}) {
    settings.iterations = iterations;
    const double stock = scenes::chain<btHingeConstraint>(settings).mean_gap,
                 ours = scenes::chain<pintle::QuaternionHinge>(settings).mean_gap;
    EXPECT_LT(1.5 * ours, stock) << iterations;
  }
}

}  // namespace passes_test
