// Joints among contacts: bridges with crates and heavy loads, blocks and walls that fall and break, islands that lie apart.
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/solver/exact_joint_solver.h>
#include <pintle/solver/uses_exact_solver.h>

#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "books.h"
#include "cables.h"
#include "exact_support.h"
#include "physics_support.h"
#include "support.h"

namespace exact_contacts_test {
namespace {

using physics::rounding;
using support::Books;
using support::largestGapOf;
using support::scalar;
using support::vec;
using namespace exact_support;

/// 10 planks of 10 kg and 11 hinges in an arch, and a crate of 50 kg dropped on it.
template <class Hinge>
void expectCalmBridges() {
  Books books(60);
  books.add(0, vec(200, 200, 1), at(vec(0, 0, -1)), true);
  btRigidBody& post = books.add(0, vec(0.1, 0.1, 0.1), at(vec(0, 0, -50)));
  std::vector<btRigidBody*> crates;
  constexpr int bridges = 5;
  for (int n = 0; n < bridges; ++n) {
    const btVector3 begin = vec(14 * n, 0, 5);
    btVector3 end = begin;
    btRigidBody* last = &post;
    const auto join = [&](btRigidBody& a, btRigidBody& b) {
      const btTransform frame(btMatrix3x3(1, 0, 0, 0, 0, -1, 0, 1, 0), end);  // about y
      auto hinge = std::make_unique<Hinge>(a, b, a.getCenterOfMassTransform().inverse() * frame,
                                           b.getCenterOfMassTransform().inverse() * frame);
      hinge->setLimit(1, -1);
      books.join(std::move(hinge));
    };
    for (int i = 0; i < 10; ++i) {
      const double slope = (i + 0.5) / 10 - 0.5;
      const btVector3 along = vec(std::cos(slope), 0, std::sin(slope));
      btRigidBody& plank =
          books.add(10, vec(0.5, 0.5, 0.05),
                    at(end + along / 2, btQuaternion(btVector3(0, 1, 0), scalar(-slope))), true);
      join(*last, plank);
      last = &plank;
      end += along;
    }
    join(*last, post);
    crates.push_back(&books.add(50, vec(0.3, 0.3, 0.3),
                                at((begin + end) / 2 + vec(0.2 * (n - 3), 0, 0.5)), true));
  }
  books.begin();
  double gap = 0;
  for (int i = 0; i < 360; ++i) {
    books.step();
    gap = std::max(gap, largestGapOf<Hinge>(books));
  }
  EXPECT_LE(gap, rounding(1e-4, 1e-6)) << "contacts push planks out of crates, too";
  EXPECT_LE(books.gains, 10 * bridges);
  for (const btRigidBody* crate : crates)
    EXPECT_GT(crate->getCenterOfMassPosition().z(), 2) << "it is still on the bridge";
  EXPECT_LE(books.kinetic(), 20 * bridges);
}

/// Means of the second half of the time, of a load that is dropped on a bridge of 40 planks of 10 kg.
struct LoadedBridge {
  double kinetic = 0;  ///< J
  double lowest = 0;   ///< of the load, in sags of the empty bridge below its ends
};
LoadedBridge loadBridge(double load_kg, double drop, int steps) {
  Books books(60);
  btRigidBody& bank = books.add(0, vec(0.1, 0.1, 0.1), at(vec(0, 0, 0)));
  constexpr int planks = 40;
  constexpr double length = 0.25, half = planks * length / 2, sag = half / 10;
  const auto node = [&](int i) {
    const double s = i * length / half - 1;
    return vec(half * s, 0, sag * (s * s - 1));
  };
  btRigidBody* last = &bank;
  const auto join = [&](btRigidBody& to, const btVector3& pivot) {
    const btTransform frame(btMatrix3x3(1, 0, 0, 0, 0, -1, 0, 1, 0), pivot);  // about y
    books.join(std::make_unique<pintle::QuaternionHinge>(
        *last, to, last->getCenterOfMassTransform().inverse() * frame,
        to.getCenterOfMassTransform().inverse() * frame));
    last = &to;
  };
  for (int i = 0; i < planks; ++i) {
    const btVector3 a = node(i), along = node(i + 1) - a;
    const btQuaternion turn(vec(0, 1, 0), -btAtan2(along.z(), along.x()));
    join(books.add(10, btVector3(along.length() / 2, 1, scalar(0.04)), at(a + along / 2, turn),
                   true),
         a);
  }
  join(bank, node(planks));
  constexpr double half_height = 0.5;
  btRigidBody& load =
      books.add(load_kg, vec(1, 0.8, half_height), at(vec(0, 0, half_height + drop - sag)), true);
  books.begin();
  LoadedBridge bridge;
  for (int i = 0; i < steps; ++i) {
    books.step();
    if (i < steps / 2) continue;
    const double z = double(load.getCenterOfMassPosition().z()) - half_height;
    bridge.kinetic += books.kinetic() / (steps / 2);
    bridge.lowest += z / sag / (steps / 2);
  }
  return bridge;
}

// A load of 100 planks' mass lies on a bridge of 40. Contacts push it off the planks, and not the planks from under it.
TEST(ExactEnergy, AHeavyLoadLiesOnABridgeOfLightPlanks) {
  const LoadedBridge bridge = loadBridge(1000, 0.1, 1200);
  EXPECT_GT(bridge.lowest, -1.5);
  EXPECT_LT(bridge.kinetic, 60) << "what it falls in six millimetres";
}

// What lies on planks is a load that their hinges bear, as they bear one that hangs on them.
TEST(ExactEnergy, ABridgeBearsTwoHundredTimesItsPlanks) {
  for (const double drop : {0.06, 0.08, 0.1, 0.12})
    EXPECT_GT(loadBridge(2000, drop, 600).lowest, -1.5) << "from " << drop << " m";
}

// Stock's joints on stock's solver gain 600 J a bridge.
TEST(ExactEnergy, BridgesWithCratesGainNothing) { expectCalmBridges<pintle::QuaternionHinge>(); }
TEST(ExactEnergy, BridgesOfStockHingesGainNothing) { expectCalmBridges<btHingeConstraint>(); }

/// Boxes of 1 m side by side, stock's fixed joints between neighbours, that break at `threshold`, N s.
void addBlock(Books& books, const std::array<int, 3>& n, const btVector3& corner, double mass,
              double threshold) {
  std::vector<btRigidBody*> boxes;
  const auto index = [&](int i, int j, int k) { return size_t((i * n[1] + j) * n[2] + k); };
  for (int i = 0; i < n[0]; ++i)
    for (int j = 0; j < n[1]; ++j)
      for (int k = 0; k < n[2]; ++k)
        boxes.push_back(&books.add(mass, vec(0.5, 0.5, 0.5),
                                   at(corner + vec(i + 0.5, j + 0.5, k + 0.5)), true));
  const auto join = [&](btRigidBody& a, btRigidBody& b, const btVector3& half) {
    auto joint = std::make_unique<btFixedConstraint>(a, b, at(half), at(-half));
    joint->setBreakingImpulseThreshold(scalar(threshold));
    books.join(std::move(joint));
  };
  for (int i = 0; i < n[0]; ++i)
    for (int j = 0; j < n[1]; ++j)
      for (int k = 0; k < n[2]; ++k) {
        btRigidBody& box = *boxes[index(i, j, k)];
        if (i + 1 < n[0]) join(box, *boxes[index(i + 1, j, k)], vec(0.5, 0, 0));
        if (j + 1 < n[1]) join(box, *boxes[index(i, j + 1, k)], vec(0, 0.5, 0));
        if (k + 1 < n[2]) join(box, *boxes[index(i, j, k + 1)], vec(0, 0, 0.5));
      }
}

TEST(ExactEnergy, ABlockOfFixedBoxesThatFallsGainsNothing) {
  Books books(60);
  books.add(0, vec(50, 50, 1), at(vec(0, 0, -1)), true);
  addBlock(books, {2, 2, 2}, vec(0, 0, 4), 10, double(SIMD_INFINITY));
  books.begin();
  for (int i = 0; i < 300; ++i) books.step();
  EXPECT_LE(books.gain, 0.01 * books.peak);
  EXPECT_LE(books.kinetic(), 0.01 * books.peak);
}

TEST(ExactEnergy, AWallThatBreaksGainsNothing) {
  Books books(60);
  books.add(0, vec(50, 50, 1), at(vec(0, 0, -1)), true);
  addBlock(books, {1, 4, 4}, vec(0, -2, 0), 2, 5);
  btRigidBody& ball = books.add(20, vec(0.5, 0.5, 0.5), at(vec(-4, 0, 2)), true);
  ball.setLinearVelocity(vec(15, 0, 0));
  books.begin();
  for (int i = 0; i < 180; ++i) books.step();
  EXPECT_LE(books.gain, 0.01 * books.peak);
  int broken = 0;
  for (const auto& joint : books.joints) broken += !joint->isEnabled();
  EXPECT_GT(broken, 5);
}

// Bullet hands over many islands at once. Each is done when it is solved, and not when all are.
TEST(ExactEnergy, WhatFallsElsewhereCostsNoPasses) {
  struct Fall {
    double x;
    int links;
    double last_mass;
  };
  const auto passes = [](const std::vector<Fall>& falls) {
    Books books(60);
    books.world.getSolverInfo().m_minimumSolverBatchSize = 1000;
    books.add(0, vec(500, 50, 1), at(vec(0, 0, -1)), true);
    for (const Fall& fall : falls) {
      btRigidBody* last = nullptr;
      for (int i = 0; i < fall.links; ++i) {
        btRigidBody& link = books.add(i + 1 < fall.links ? 1 : fall.last_mass, vec(0.3, 0.1, 0.1),
                                      at(vec(fall.x + 0.7 * i, 0, 0.3 + 0.2 * i)), true);
        if (last != nullptr)
          books.join(std::make_unique<pintle::BallJoint>(*last, link, vec(0.35, 0, 0.1),
                                                         vec(-0.35, 0, -0.1)));
        last = &link;
      }
    }
    double sum = 0;
    for (int step = 0; step < 120; ++step) {
      books.step();
      sum += pintle::lastStep(books.world).newton_steps;
    }
    return sum;
  };
  std::vector<Fall> all;
  double chains = 0;
  for (int i = 1; i <= 4; ++i) {
    all.push_back({20. * i, 2, 1});
    chains += passes({all.back()});
  }
  all.push_back({100, 8, 200});
  const double heap = passes({all.back()});
  EXPECT_GT(heap, 1.3 * chains / 4) << "it is harder";
  EXPECT_LT(passes(all), 1.1 * (chains + heap));  // else each takes as many as the heap
}

// A net falls on the ground, flat. Each of its bodies has four contacts there. To follow all of these through the net takes several times
// the memory of the joints.
TEST(ExactContacts, ManyContactsOnANetTakeNoMoreMemoryThanJoints) {
  constexpr int size = 15, always_followed = 1000;
  const auto memoryOfNet = [](bool falls_on_ground,
                              int longest_path = pintle::SolverOptions().longest_path) {
    Books books(60);
    pintle::SolverOptions options = books.solver.options();
    options.longest_path = longest_path;
    books.solver.setOptions(options);
    if (falls_on_ground) books.add(0, vec(50, 50, 1), at(vec(0, 0, -1)), true);
    std::vector<btRigidBody*> bodies;
    for (int i = 0; i < size * size; ++i) {
      btRigidBody& body =
          books.add(1, vec(0.4, 0.4, 0.1), at(vec(i % size, int(i / size), 0.2)), true);
      if (i % size > 0)
        books.join(std::make_unique<pintle::BallJoint>(*bodies.back(), body, vec(0.5, 0, 0),
                                                       vec(-0.5, 0, 0)));
      if (i >= size)
        books.join(std::make_unique<pintle::BallJoint>(*bodies[size_t(i - size)], body,
                                                       vec(0, 0.5, 0), vec(0, -0.5, 0)));
      bodies.push_back(&body);
    }
    for (int step = 0; step < 60; ++step) books.step();
    EXPECT_LE(largestGapOf<pintle::BallJoint>(books), rounding(1e-5, 1e-7));
    if (falls_on_ground) {
      EXPECT_LE(books.kinetic(), rounding(1e-4, 1e-7)) << "it rests";
    }
    return double(books.solver.getMemory());
  };
  const double of_joints = memoryOfNet(false);
  EXPECT_LT(memoryOfNet(true), 2 * of_joints);
  EXPECT_GT(memoryOfNet(true, always_followed), 3 * of_joints);
}

}  // namespace
}  // namespace exact_contacts_test
