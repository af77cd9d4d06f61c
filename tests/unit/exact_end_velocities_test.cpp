// Velocities belong to the poses with which they end: joints hold there, and energy is what it was.
#include <pintle/body_pair.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/joint.h>
#include <pintle/rows/row.h>
#include <pintle/solver/model/island.h>

#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "books.h"
#include "joint_kinds.h"
#include "physics_support.h"
#include "support.h"

namespace exact_end_velocities_test {
namespace {

using physics::rounding;
using pintle::Vector6d;
using support::Books;
using support::Random;
using support::scalar;
using support::vec;

Vector6d velocityOf(const btRigidBody& body) {
  Vector6d v;
  v << pintle::inDouble(body.getLinearVelocity()), pintle::inDouble(body.getAngularVelocity());
  return v;
}

/// m/s or rad/s: the fastest of the joint's equalities.
double fastest(const pintle::Joint& joint) {
  const btRigidBody &a = joint.constraint().getRigidBodyA(),
                    &b = joint.constraint().getRigidBodyB();
  pintle::RowMemory<pintle::max_joint_rows, pintle::max_joint_rows> memory;
  pintle::Rows rows(memory);
  joint.addRows(pintle::BodyPair(a, b), rows);
  double most = 0;
  for (int i = 0; i < rows.equalities(); ++i)
    most = std::max(most,
                    std::abs(pintle::jacobianOf(rows[i], 1).along(velocityOf(a), velocityOf(b))));
  return most;
}

class EndVelocities : public testing::TestWithParam<kinds::Kind> {};

std::vector<kinds::Kind> jointsThatHold() {
  std::vector<kinds::Kind> list;
  for (const kinds::Kind& kind : kinds::all())
    // Rows that repeat or contradict each other need not.
    if (kind.name.rfind("CrossProduct", 0) != 0 && kind.name.rfind("SingleRowLock", 0) != 0)
      list.push_back(kind);
  return list;
}

// Chains of three links that whirl, at 60 Hz: in nearly all steps. The others are no chord's, or turn a body by more than a quarter: so do
// links on rods, which nothing keeps from spinning.
TEST_P(EndVelocities, HoldWhereTheStepEnds) {
  const bool spins = GetParam().name.rfind("Distance", 0) == 0;
  int steps = 0, held = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    Books books(60);
    btRigidBody* last = &books.add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
    for (int i = 0; i < 3; ++i) {
      btRigidBody& link = books.add(1, vec(0.25, 0.05, 0.1), vec(0.5 * i + 0.25, 0, 0));
      const btTransform frame(random.pose(1).getRotation(), vec(0.5 * i, 0, 0));
      books.join(GetParam().make(*last, link, last->getCenterOfMassTransform().inverse() * frame,
                                 link.getCenterOfMassTransform().inverse() * frame, 0));
      link.setAngularVelocity(random.vector(1));
      last = &link;
    }
    for (int i = 0; i < 120; ++i) {
      books.step();
      double most = 0;
      for (const auto& joint : books.joints)
        most = std::max(most, fastest(dynamic_cast<const pintle::Joint&>(*joint)));
      ++steps;
      held += most <= rounding(1e-3, 1e-6);
    }
  }
  EXPECT_GE(held, (spins ? 0.6 : 0.98) * steps);
}

INSTANTIATE_TEST_SUITE_P(OfJoint, EndVelocities, testing::ValuesIn(jointsThatHold()),
                         [](const auto& of) { return of.param.name; });

/// A chain of rods of 1 m and 1 kg falls from the horizontal for 5 s.
struct Fall {
  double error =
      0;  ///< J, over the largest kinetic energy: by how much its energy differs from that of its start
  double factors = 0;  ///< the mean of a step
};
Fall fallOf(int links, double hz) {
  Books books(hz);
  btRigidBody* last = nullptr;
  for (int i = 0; i < links; ++i) {
    btRigidBody& link = books.add(1, vec(0.5, 0.05, 0.05), vec(i + 0.5, 0, 0));
    link.setDamping(0, 0);
    if (last == nullptr)
      books.join(std::make_unique<pintle::BallJoint>(link, vec(-0.5, 0, 0)));
    else
      books.join(std::make_unique<pintle::BallJoint>(*last, link, vec(0.5, 0, 0), vec(-0.5, 0, 0)));
    last = &link;
  }
  books.begin();
  const double start = books.energy();
  const int steps = 5 * int(hz);
  Fall fall;
  for (int i = 0; i < steps; ++i) {
    books.step();
    fall.error = std::max(fall.error, std::abs(books.energy() - start));
    fall.factors += double(books.solver.lastStep().factorisations) / steps;
  }
  fall.error /= books.peak;
  return fall;
}

// A step begins with the factor with which the last one ended. (Rounded to floats, its rows are others.)
TEST(FactorsOfRods, AreOneAStep) {
  if (!support::is_double) GTEST_SKIP() << "floats round the rows";
  for (const int links : {1, 2, 4}) EXPECT_LT(fallOf(links, 60).factors, 1.1) << links;
}

// (By velocities of the way a pendulum errs by 2.7e-3 at 60 Hz, a chain of four by 2.7e-4.)
TEST(EnergyOfRods, IsWhatItWas) {
  for (const double hz : {60., 240.}) {
    SCOPED_TRACE(hz);
    // Where a pendulum turns back, its step is off by more than the energy of p_1: that is made up for in the next ones.
    EXPECT_LT(fallOf(1, hz).error, rounding(1e-5, hz == 60 ? 3e-7 : 1e-10));
    for (const int links : {2, 4}) EXPECT_LT(fallOf(links, hz).error, rounding(1e-5, 1e-12));
  }
}

}  // namespace
}  // namespace exact_end_velocities_test
