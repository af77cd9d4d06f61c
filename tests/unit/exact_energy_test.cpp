// Joints that cannot create energy: random chains of every joint, heavy loads on light chains, what swings and whirls.
#include <pintle/body_pair.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/constant_velocity_joint.h>
#include <pintle/joints/distance_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/universal_joint.h>
#include <pintle/joints/wedge_joint.h>
#include <pintle/rows/row.h>
#include <pintle/solver/exact_joint_solver.h>

#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "books.h"
#include "exact_support.h"
#include "joint_kinds.h"
#include "physics_support.h"
#include "support.h"

namespace exact_energy_test {
namespace {

using physics::rounding;
using support::Books;
using support::Random;
using support::scalar;
using support::vec;
using namespace exact_support;

/// m or rad: the most that an equality of the joint is open, or a limit is passed.
double largestError(const pintle::Joint& joint) {
  pintle::RowMemory<pintle::max_joint_rows, pintle::max_joint_rows> memory;
  pintle::Rows rows(memory);
  const btTypedConstraint& constraint = joint.constraint();
  joint.addRows(pintle::BodyPair(constraint.getRigidBodyA(), constraint.getRigidBodyB()), rows);
  double largest = 0;
  for (int i = 0; i < rows.equalities(); ++i)
    largest = std::max(largest, std::abs(double(rows[i].position)));
  for (int i = rows.equalities(); i < rows.size(); ++i) {
    const pintle::Axis& axis = *rows.axis(rows[i].axis).axis;
    if (!rows[i].limit || !axis.limited() || axis.hasLimitSpring()) continue;
    largest = std::max(
        {largest, double(axis.low - rows[i].position), double(rows[i].position - axis.high)});
  }
  return largest;
}

// Joints of which rows repeat or contradict each other, lose their grip, or jump: they need not hold, only gain nothing.
bool worksAgainstItself(const kinds::Kind& kind) {
  for (const char* const name : {"CrossProduct", "SingleRowLock"})
    if (kind.name.rfind(name, 0) == 0) return true;
  return kind.name == "ConstantVelocityJointDocument";
}

/// Joints at their settings as constructed, and those that limits make of them.
struct ChainOf {
  std::string name;
  kinds::Kind kind;
  std::function<void(pintle::Joint&)> limit = [](pintle::Joint&) {};
};
std::ostream& operator<<(std::ostream& out, const ChainOf& of) { return out << of.name; }

std::vector<ChainOf> chains() {
  std::vector<ChainOf> list;
  for (const kinds::Kind& kind : kinds::all()) list.push_back({kind.name, kind});
  // The limits of one kind, set on a joint that is inside them.
  const auto add = [&](const char* name, const char* of, auto limit) {
    for (const kinds::Kind& kind : kinds::all())
      if (kind.name == of) list.push_back({name, kind, limit});
  };
  // Of the distance at which it is set.
  const auto addRod = [&](const char* name, double low, double high) {
    add(name, "DistanceJoint", [=](pintle::Joint& joint) {
      auto& rod = dynamic_cast<pintle::DistanceJoint&>(joint);
      const double now = double(rod.getDistance());
      rod.setLimit(scalar(low * now), std::isinf(high) ? support::infinite : scalar(high * now));
    });
  };
  addRod("Rope", 0, 1.1);
  addRod("Strut", 0.9, HUGE_VAL);
  addRod("LimitedRod", 0.9, 1.1);
  add("LimitedHinge", "QuaternionHinge", [](pintle::Joint& joint) {
    dynamic_cast<pintle::QuaternionHinge&>(joint).setLimit(scalar(-0.2), scalar(0.3));
  });
  add("LimitedWedge", "WedgeJoint", [](pintle::Joint& joint) {
    dynamic_cast<pintle::WedgeJoint&>(joint).setLimit(scalar(-0.2), scalar(0.3));
  });
  add("LimitedCone", "ConeTwistJoint", [](pintle::Joint& joint) {
    dynamic_cast<pintle::ConeTwistJoint&>(joint).setLimit(scalar(0.5), scalar(0.4), scalar(0.3));
  });
  add("LimitedUniversal", "UniversalJoint", [](pintle::Joint& joint) {
    for (const int axis : {4, 5})
      dynamic_cast<pintle::UniversalJoint&>(joint).setLimit(axis, scalar(-0.2), scalar(0.3));
  });
  add("LimitedConstantVelocity", "ConstantVelocityJoint", [](pintle::Joint& joint) {
    dynamic_cast<pintle::ConstantVelocityJoint&>(joint).setBendLimit(scalar(0.3));
  });
  add("LimitedSlider", "SliderJoint", [](pintle::Joint& joint) {
    auto& slider = dynamic_cast<pintle::SliderJoint&>(joint);
    slider.setLowerLinLimit(scalar(-0.2));
    slider.setUpperLinLimit(scalar(0.3));
  });
  return list;
}

bool isRod(const kinds::Kind& kind) { return kind.name.rfind("Distance", 0) == 0; }

/// m or rad: of a hundred runs, the mean of the worst.
double mostError(const ChainOf& of) {
  return worksAgainstItself(of.kind) ? 0.01 : rounding(2e-5, 1e-6);
}

/// m or rad: twice the tolerance of poses. What a wedge's angle is of may be short. In single precision sliders get far, where positions
/// are rounded.
double mostConverged(const ChainOf& of) {
  return rounding(1e-4, of.name == "LimitedWedge" ? 1e-8 : 2e-9);
}

class EnergyOfChain : public testing::TestWithParam<ChainOf> {};

TEST_P(EnergyOfChain, HoldsAndGainsNothing) {
  constexpr int runs = 100;
  const kinds::Kind& kind = GetParam().kind;
  double errors = 0;     // the mean
  double converged = 0;  // the worst at the end of a step that has converged
  std::string far;
  for (int run = 0; run < runs; ++run) {
    Random random(unsigned(run) + 1);
    Books books(120);
    btRigidBody* last = &books.add(0, vec(0.1, 0.1, 0.1), at(vec(0, 0, 0)));
    const int links = 1 + run % 4;
    for (int i = 0; i < links; ++i) {
      const btTransform frame_a = at(i > 0 ? random.vector(0.3) : vec(0, 0, 0)),
                        frame_b = at(random.vector(0.3), random.pose(1).getRotation());
      const btTransform pose = last->getCenterOfMassTransform() * frame_a * frame_b.inverse();
      const double mass = std::pow(10, random.uniform(-1, 1));
      const btVector3 half =
          vec(random.uniform(0.05, 0.25), random.uniform(0.05, 0.25), random.uniform(0.05, 0.25));
      btRigidBody& body = books.add(mass, half, pose);
      body.setLinearVelocity(random.vector(1));
      body.setAngularVelocity(random.vector(3));
      // Rods of tests have their far end at (2, 1, 1) in the frame (joint_kinds.cpp): here nearer.
      btTransform end_b = frame_b;
      if (isRod(kind)) end_b.setOrigin(end_b.getOrigin() - vec(2, 1, 1) + random.vector(0.3));
      auto joint = kind.make(*last, body, frame_a, end_b, 0);
      GetParam().limit(support::joint(*joint));
      books.join(std::move(joint));
      last = &body;
    }
    books.begin();
    double worst = 0;
    for (int i = 0; i < 3 * 120; ++i) {
      books.step();
      double now = 0;
      for (const auto& joint : books.joints)
        now = std::max(now, largestError(support::joint(*joint)));
      worst = std::max(worst, now);
      if (books.solver.lastStep().not_converged == 0) converged = std::max(converged, now);
    }
    ASSERT_TRUE(support::is_finite(*last)) << GetParam() << ", run " << run;
    EXPECT_LE(books.gain, 0.03 * books.peak) << GetParam() << ", run " << run;
    if (worst > 1e-4) far += " " + std::to_string(run) + ": " + std::to_string(worst);
    errors += worst / runs;
  }
  EXPECT_LE(errors, mostError(GetParam())) << "runs" << far;
  if (!worksAgainstItself(kind)) {
    EXPECT_LE(converged, mostConverged(GetParam()));
  }
}

INSTANTIATE_TEST_SUITE_P(All, EnergyOfChain, testing::ValuesIn(chains()),
                         [](const testing::TestParamInfo<ChainOf>& of) { return of.param.name; });

/// The largest gap, m, in 5 s of a chain of 10 links of 0.5 m and 1 kg that falls from the horizontal; the last one is of `load` kg.
double swingChain(Books& books, double load, int steps = 300) {
  btRigidBody* last = &books.add(0, vec(0.1, 0.1, 0.1), at(vec(0, 0, 0)));
  for (int i = 0; i < 10; ++i) {
    btRigidBody& link =
        books.add(i == 9 ? load : 1, vec(0.25, 0.05, 0.05), at(vec(0.5 * i + 0.25, 0, 0)));
    auto ball = std::make_unique<pintle::BallJoint>(
        *last, link, i > 0 ? vec(0.25, 0, 0) : vec(0, 0, 0), vec(-0.25, 0, 0));
    books.join(std::move(ball));
    last = &link;
  }
  books.begin();
  double gap = 0;
  for (int i = 0; i < steps; ++i) {
    books.step();
    gap = std::max(gap, books.largestGap());
  }
  EXPECT_LE(books.gain, rounding(0.02, 0.01) * books.peak) << load;
  return gap;
}

TEST(ExactEnergy, HoldsAMillionTimesItsMass) {
  for (const double ratio : {1., 1e2, 1e3, 1e6}) {
    Books books(60);
    EXPECT_LE(swingChain(books, ratio), rounding(1e-3, 1e-8)) << ratio;
    EXPECT_GT(books.peak, 20 * ratio) << "it has fallen";
  }
}

// Along the chain, joints take nearly all of it in the same step. Of that they give nothing back; not in the first step either.
TEST(ExactEnergy, ABlowThatJointsTakeIsNoCredit) {
  for (size_t link = 2; link < 10; ++link)
    for (const auto& [blow, before] : {std::pair{100., 60}, {300., 60}, {1000., 60}, {300., 0}}) {
      Books books(60);
      swingChain(books, 1, before);
      btRigidBody &struck = *books.bodies[link], &next = *books.bodies[link + 1];
      const btVector3 along = next.getCenterOfMassPosition() - struck.getCenterOfMassPosition();
      struck.applyCentralImpulse(scalar(blow) * along.normalized());
      books.step();
      books.gain = 0;
      books.begin();
      for (int i = 0; i < 240; ++i) books.step();
      EXPECT_LE(books.gain, rounding(0.02, 0.01) * books.peak)
          << blow << " on " << link << " after " << before;
    }
}

// From 170 degrees the period is 2.43 times that of small swings, and depends on the energy most of all: what steps resolve is as
// exact as they are.
TEST(ExactEnergy, AWidePendulumKeepsItsPeriod) {
  Books books(60);
  const btQuaternion turn(vec(0, 1, 0), scalar(physics::radians(170)));
  btRigidBody& rod =
      books.add(1, vec(0.05, 0.05, 0.5), btTransform(turn, quatRotate(turn, vec(0, 0, -0.5))));
  rod.setDamping(0, 0);
  books.join(std::make_unique<pintle::QuaternionHinge>(rod, vec(0, 0, 0.5), vec(0, 1, 0)));
  books.begin();
  int swings = -1;
  double first = 0, last = 0, before = 0;
  for (int i = 0; i < 3600; ++i) {
    books.step();
    const double x = double(rod.getCenterOfMassPosition().x());
    if (before < 0 && x >= 0) {
      last = (i + before / (before - x)) / 60;
      if (++swings == 0) first = last;
    }
    before = x;
  }
  // 4 sqrt(I / (m g l)) K(sin 85 deg), K the complete elliptic integral of the first kind: 3.83174.
  const double inertia = (0.1 * 0.1 + 1) / 12 + 0.25;
  EXPECT_NEAR((last - first) / swings, 4 * std::sqrt(inertia / (9.81 * 0.5)) * 3.83174, 0.02);
}

/// A wheel on a servo without damping, turned away by 1 rad: its largest angle in the tenth second.
double angleLeft(double frequency) {
  Books books(60);
  btRigidBody& post = books.add(0, vec(0.1, 0.1, 0.1), at(vec(0, 0, 0)));
  btRigidBody& wheel = books.add(1, vec(0.5, 0.5, 0.1), at(vec(0, 0, 0)));
  auto made = std::make_unique<pintle::QuaternionHinge>(wheel, post, vec(0, 0, 0), vec(0, 0, 0),
                                                        vec(0, 0, 1), vec(0, 0, 1));
  pintle::QuaternionHinge& hinge = *made;
  books.join(std::move(made));
  hinge.setMotorServo(1, scalar(frequency), 0, support::infinite);
  double left = 0;
  for (int i = 0; i < 600; ++i) {
    books.step();
    const double away = std::abs(double(hinge.getHingeAngle()) - 1);
    EXPECT_LE(away, 1.3) << i;
    if (i >= 540) left = std::max(left, away);
  }
  return left;
}

// What a step resolves swings on as it should; an implicit step would leave 4e-5 of it. What it does not comes to rest.
TEST(ExactEnergy, SpringsKeepTheirEnergyWhereStepsResolveThem) {
  EXPECT_NEAR(angleLeft(2), 1, 0.02);
  EXPECT_LT(angleLeft(200), 1e-6);
}

// A double pendulum falls from level and whirls, by up to 0.27 rad a step, along chords of its arcs. What these give and take is
// balanced: after a quarter of an hour it has what it fell with.
TEST(ExactEnergy, WhatWhirlsKeepsItsEnergy) {
  Books books(60);
  btRigidBody& upper = books.add(1, vec(0.5, 0.1, 0.1), at(vec(0.5, 0, 0)));
  btRigidBody& lower = books.add(1, vec(0.5, 0.1, 0.1), at(vec(1.5, 0, 0)));
  books.join(std::make_unique<pintle::BallJoint>(upper, vec(-0.5, 0, 0)));
  books.join(std::make_unique<pintle::BallJoint>(upper, lower, vec(0.5, 0, 0), vec(-0.5, 0, 0)));
  const auto energy = [&] { return books.energy(); };
  const double start = energy(), exchange = 4 * 9.81;  // from upright to hanging, J
  double turn = 0;
  for (int i = 0; i < 15 * 60 * 60; ++i) {
    books.step();
    ASSERT_NEAR(energy(), start, rounding(0.05, 1e-3) * exchange) << i;
    turn = std::max(turn, double(lower.getAngularVelocity().length()) / 60);
  }
  EXPECT_GT(turn, 0.2);
}

}  // namespace
}  // namespace exact_energy_test
