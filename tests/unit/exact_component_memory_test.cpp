// Memory of a component from step to step: by its joints and bodies, row by row, and its ledger.
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/solver/cache/component_memory.h>

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

#include "island_problem.h"
#include "support.h"

namespace exact_component_memory_test {

using island_problem::IslandProblem;
using pintle::ComponentMemory;
using support::scalar;
using support::vec;

/// Doors that hang one from the other.
struct Doors : IslandProblem {
  explicit Doors(int count) {
    btRigidBody* last = &add(0, vec(0, 0, 0));
    for (int i = 0; i < count; ++i) addDoor(*last, i), last = doors.back();
    build(0.2);
  }
  void addDoor(btRigidBody& on, int i) {
    doors.push_back(&add(1, vec(i + 1, 0, 0)));
    const btVector3 hook = vec(i + 0.5, 0, 0) - on.getCenterOfMassPosition(), axis = vec(0, 0, 1);
    hinges.push_back(
        &join<pintle::QuaternionHinge>(on, *doors.back(), hook, vec(-0.5, 0, 0), axis, axis));
  }
  const pintle::Component& component() const { return components.front(); }
  void remember() { pintle::remember(island, component(), memory); }

  /// A step whose impulses are 1, 2, 3, ..., row by row.
  void play() {
    remember();
    memory->ledger.begin(island, component(), 0.01);
    memory->begin(island, component());
    pintle::Workspace& work = memory->work;
    std::iota(work.lambda.begin(), work.lambda.end(), 1.);
    work.way = work.v;
    work.u.assign(island.rows.size(), 0.);
    work.pieces.clear();
    for (const pintle::IslandRow& row : island.rows) work.pieces.push_back(row.law.meet(0, row.K));
    memory->solution = pintle::Solution::in_velocity;
    memory->solves = 0;  // so impulses are not bounded
    memory->keepImpulses(island, component(), false, 1e-13);
    memory->ledger.book(0.5, 0.01, 1);
    memory->keep(island, component());
  }

  std::unique_ptr<ComponentMemory> memory;
  std::vector<btRigidBody*> doors;
  std::vector<pintle::QuaternionHinge*> hinges;
};

TEST(ComponentMemory, IsThatOfTheSameJointsAndBodies) {
  Doors of(2);
  of.remember();
  const ComponentMemory* const before = of.memory.get();
  of.build(0.2);
  of.remember();
  EXPECT_EQ(of.memory.get(), before);
}

TEST(ComponentMemory, OfOtherBodiesIsNewButForItsLedger) {
  Doors of(2);
  of.play();
  const double given = of.memory->ledger.given;
  ASSERT_EQ(given, 0.5);
  of.addDoor(*of.doors.back(), 2);
  of.build(0.2);
  of.remember();
  EXPECT_EQ(of.memory->constraints.size(), 3u);
  EXPECT_EQ(of.memory->ledger.given, given);
  of.memory->begin(of.island, of.component());
  for (const double impulse : of.memory->work.lambda) EXPECT_EQ(impulse, 0);
}

TEST(ComponentMemory, BeginsWithTheImpulsesOfTheLastStep) {
  Doors of(3);
  of.play();
  of.build(0.2);
  of.remember();
  of.memory->begin(of.island, of.component());
  double expected = 0;
  for (const double impulse : of.memory->work.lambda) EXPECT_EQ(impulse, ++expected);
}

// A limit that comes adds a row, and the rows of later joints are others of the component's.
TEST(ComponentMemory, FindsTheRowsOfAJointThatHasMore) {
  Doors of(3);
  of.play();
  const int before = of.island.joints[1].rows;
  of.hinges[1]->setLimit(0, 1);
  of.build(0.2);
  of.remember();
  ASSERT_EQ(of.island.joints[1].rows, before + 1);
  of.memory->begin(of.island, of.component());
  double expected = 0;
  for (const pintle::IslandJoint& joint : of.island.joints)
    for (int i = 0; i < joint.rows; ++i) {
      const bool is_new = i >= before;
      EXPECT_EQ(of.memory->work.lambda[size_t(joint.row_of_component + i)],
                is_new ? 0 : ++expected);
    }
}

TEST(ComponentMemory, ForgetsAllWhenReset) {
  Doors of(2);
  of.play();
  of.memory->reset();
  of.build(0.2);
  of.remember();
  EXPECT_EQ(of.memory->ledger.given, 0);
  of.memory->begin(of.island, of.component());
  for (const double impulse : of.memory->work.lambda) EXPECT_EQ(impulse, 0);
}

}  // namespace exact_component_memory_test
