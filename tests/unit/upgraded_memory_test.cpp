// Memory of upgraded joints: of none but the object that was solved in the last step, in its world, and without allocations. Numbers
// that are not finite leave the last good ones there.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "support.h"
#include "upgraded_worlds.h"

namespace contract_test {
extern thread_local long allocations;  // by operator new
}

namespace upgraded_memory_test {
namespace {

using namespace upgraded_worlds;

class UpgradedMemory : public testing::TestWithParam<Worlds> {};

// --- joints that come and go ---------------------------------------------------------------------

const Use limited = {&hinge, "limit", [](btTypedConstraint& joint, int i) {
                       if (i != 0) return;
                       auto& of = static_cast<btHingeConstraint&>(joint);
                       of.setLimit(scalar(-0.2), scalar(0.3));
                     }};

/// A link that a hinge holds, and then another joint, made where the first one was.
class Successor {
 public:
  Successor(World& world, bool ours) : m_world(world.world()), m_ours(ours), m_bodies(m_world) {
    m_post = &m_bodies.add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
    m_link = &m_bodies.add(1, vec(0.2, 0.06, 0.04), vec(0.3, 0, 0));
    m_other = &m_bodies.add(2, vec(0.2, 0.06, 0.04), vec(-0.3, 0, 0));
  }
  ~Successor() { remove(); }

  void addHinge(double turn) { add<btHingeConstraint, pintle::QuaternionHinge>(*m_link, turn); }
  void addHingeToOther() { add<btHingeConstraint, pintle::QuaternionHinge>(*m_other, 0); }
  void addAccumulated() {
    add<btHingeAccumulatedAngleConstraint, pintle::QuaternionHinge>(*m_link, 0);
  }
  void remove() {
    if (m_joint == nullptr) return;
    m_world.removeConstraint(m_joint);
    m_joint->~btTypedConstraint();
    m_joint = nullptr;
  }
  std::vector<btScalar> run(int count) {
    std::vector<btScalar> all;
    for (int i = 0; i < count; ++i) {
      m_world.stepSimulation(scalar(dt), 0, scalar(dt));
      for (const btRigidBody* of : {m_link, m_other})
        for (const btVector3& v :
             {of->getCenterOfMassPosition(), of->getLinearVelocity(), of->getAngularVelocity()})
          all.insert(all.end(), {v.x(), v.y(), v.z()});
    }
    return all;
  }

 private:
  template <class Stock, class Ours>
  void add(btRigidBody& body, double turn) {
    if (m_ours)
      place<Ours>(body, turn);
    else
      place<Stock>(body, turn);
  }
  template <class Joint>
  void place(btRigidBody& body, double turn) {
    static_assert(sizeof(Joint) <= sizeof m_memory);
    const btTransform frame(btQuaternion(vec(0.6, 0, 0.8), scalar(turn)), vec(0, 0, 0));
    auto* const made = new (m_memory)
        Joint(*m_post, body, frame, body.getCenterOfMassTransform().inverse() * frame);
    // Bullet's method: Pintle's keeps the numbers that Bullet's object rounds.
    static_cast<btHingeConstraint*>(made)->setLimit(scalar(-0.3), scalar(0.2));
    m_joint = made;
    m_world.addConstraint(made, true);
  }

  alignas(16) char m_memory[8192];
  btDiscreteDynamicsWorld& m_world;
  const bool m_ours;
  support::Bodies m_bodies;
  btRigidBody *m_post, *m_link, *m_other;
  btTypedConstraint* m_joint = nullptr;
};

TEST_P(UpgradedMemory, RememberNothingOfAnotherAtTheSameAddress) {
  const std::function<void(Successor&)> all[] = {
      [](Successor& of) { of.addHinge(0); },  // in all the same, but new
      [](Successor& of) { of.addHinge(0.7); },
      [](Successor& of) { of.addHingeToOther(); },
      [](Successor& of) { of.addAccumulated(); },
  };
  for (const auto& add_next : all)
    for (const int steps_between : {0, 1, 20}) {
      SCOPED_TRACE(testing::Message() << &add_next - all << ", " << steps_between);
      const MadeWorld upgraded = GetParam().upgraded(), ours = GetParam().ours();
      std::vector<btScalar> numbers[2];
      for (const bool is_ours : {false, true}) {
        Successor pair(is_ours ? *ours : *upgraded, is_ours);
        pair.addHinge(0);
        pair.run(40);
        pair.remove();
        pair.run(steps_between);
        add_next(pair);
        numbers[is_ours] = pair.run(steps);
      }
      expectSame(numbers[0], numbers[1]);
    }
}

TEST_P(UpgradedMemory, StartAnewWhenTheyComeBack) {
  if (GetParam().name == std::string("NNCG")) return;  // ends in NaN, with Bullet's joints, too
  const MadeWorld upgraded = GetParam().upgraded(), ours = GetParam().ours();
  Chain stock(upgraded->world(), hinge, false), by_ours(ours->world(), hinge, true);
  expectSame(stock.run(limited), by_ours.run(limited));
  // A joint of Pintle's keeps its memory as long as it lives: a new one is the same.
  stock.takeOut(1);
  by_ours.takeOut(1);
  stock.run(limited, 1);
  by_ours.run(limited, 1);
  stock.putBack(1);
  by_ours.makeAnew(1);
  expectSame(stock.run(limited), by_ours.run(limited));
}

TEST_P(UpgradedMemory, AreOfTheWorldThatASolverIsIn) {
  const MadeWorld first = GetParam().upgraded(), second = GetParam().upgraded(),
                  alone = GetParam().upgraded();
  if (dynamic_cast<btMultiBodyDynamicsWorld*>(&first->world()) != nullptr)
    return;  // it has its own
  second->world().setConstraintSolver(first->solver.get());
  Chain a(first->world(), hinge, false), b(second->world(), ball, false),
      twin(alone->world(), hinge, false);
  std::vector<btScalar> shared;
  for (int i = 0; i < steps; ++i) {
    if (i == 0)
      for (const auto& joint : a.joints) limited.act(*joint, 0);
    a.step();
    a.read(shared);
    for (int k = 0; k < i % 3; ++k) b.step();
  }
  expectSame(shared, twin.run(limited));
}

TEST_P(UpgradedMemory, AllocateNothingOnceASolverHasSeenThem) {
  for (const Class* of : {&hinge, &ball, &slider, &cone}) {
    SCOPED_TRACE(of->name);
    const MadeWorld world = GetParam().upgraded();
    Chain chain(world->world(), *of, false);
    for (int i = 0; i < 120; ++i) chain.step();
    const long before = contract_test::allocations;
    for (int i = 0; i < 60; ++i) chain.step();
    EXPECT_EQ(contract_test::allocations - before, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(, UpgradedMemory, testing::ValuesIn(all_worlds),
                         [](const auto& of) { return std::string(of.param.name); });

// A stock hinge of this class counts its turns for as long as it lives.
TEST_P(UpgradedMemory, AccumulatedAnglesAreCountedOn) {
  const MadeWorld world = GetParam().upgraded();
  support::Bodies bodies(world->world());
  world->world().setGravity(vec(0, 0, 0));
  btRigidBody& wheel = bodies.add(1, vec(0.2, 0.2, 0.1), vec(0, 0, 0));
  auto made =
      std::make_unique<btHingeAccumulatedAngleConstraint>(wheel, vec(0, 0, 0), vec(0, 0, 1), true);
  btHingeAccumulatedAngleConstraint& hinge = *made;
  bodies.join(std::move(made));
  const auto turn = [&](int count) {
    const double before = double(hinge.getAccumulatedHingeAngle());
    for (int i = 0; i < count; ++i) world->world().stepSimulation(scalar(dt), 0, scalar(dt));
    return double(hinge.getAccumulatedHingeAngle()) - before;
  };
  wheel.setAngularVelocity(vec(0, 0, 10));
  wheel.setDamping(0, 0);
  const double of_two_seconds = turn(120);
  EXPECT_NEAR(std::abs(of_two_seconds), 20, 1e-3);
  // Taken out, and put back.
  world->world().removeConstraint(&hinge);
  turn(3);
  world->world().addConstraint(&hinge, true);
  EXPECT_NEAR(turn(120), of_two_seconds, 1e-3);
  hinge.setAccumulatedHingeAngle(hinge.getAccumulatedHingeAngle() + 3 * SIMD_2_PI);
  const double start = double(hinge.getAccumulatedHingeAngle());
  EXPECT_NEAR(turn(120), of_two_seconds, 1e-3);
  EXPECT_NEAR(double(hinge.getAccumulatedHingeAngle()), start + of_two_seconds, 1e-3);
}

// --- numbers that are not used -------------------------------------------------------------------

struct Bad {
  const Class* of;
  const char* field;
  std::function<void(btTypedConstraint&, btScalar)> write;
};

const Bad all_bad[] = {
    {&hinge, "limit",
     [](btTypedConstraint& c, btScalar x) { static_cast<btHingeConstraint&>(c).setLimit(-1, x); }},
    {&hinge, "motor target velocity",
     [](btTypedConstraint& c, btScalar x) {
       static_cast<btHingeConstraint&>(c).enableAngularMotor(true, x, 1);
     }},
    {&hinge, "joint frames",
     [](btTypedConstraint& c, btScalar x) {
       static_cast<btHingeConstraint&>(c).getAFrame().setOrigin({x, 0, 0});
     }},
    {&ball, "pivotA",
     [](btTypedConstraint& c, btScalar x) {
       static_cast<btPoint2PointConstraint&>(c).setPivotA({x, 0, 0});
     }},
    {&slider, "linear limit",
     [](btTypedConstraint& c, btScalar x) {
       static_cast<btSliderConstraint&>(c).setLowerLinLimit(x);
     }},
    {&cone, "twist span",
     [](btTypedConstraint& c, btScalar x) {
       static_cast<btConeTwistConstraint&>(c).setLimit(3, x);
     }},
};

template <class Solver>
void expectNamed(const Bad& bad, const std::function<void(const Solver&, int ignored)>& check) {
  SCOPED_TRACE(testing::Message() << bad.of->name << ": " << bad.field);
  PlainWorld<Solver> of;
  Chain chain(of.world(), *bad.of, false);
  for (int i = 0; i < 10; ++i) {
    if (i == 5) bad.write(*chain.joints[1], support::nan_value);
    chain.step();
    for (const auto& body : chain.bodies) ASSERT_TRUE(support::is_finite(*body));
    check(of.its(), i < 5 ? 0 : 1);
  }
  EXPECT_NE(of.its().whyIgnored(*chain.joints[1]).find(bad.field), std::string::npos)
      << of.its().whyIgnored(*chain.joints[1]);
  EXPECT_EQ(of.its().whyIgnored(*chain.joints[0]), "");
}

TEST(UpgradedNumbers, ThatAreNotFiniteAreNamed) {
  for (const Bad& bad : all_bad) {
    expectNamed<pintle::SequentialJointSolver>(bad, [](const auto&, int) {});
    expectNamed<pintle::ExactJointSolver>(bad, [](const auto& solver, int ignored) {
      EXPECT_EQ(solver.lastStep().ignored_settings, ignored);
    });
  }
}

TEST(UpgradedNumbers, AreNamedBeforeTheFirstStepAndOfPintlesJoints) {
  const pintle::SequentialJointSolver solver;
  btRigidBody a(1, nullptr, nullptr), b(1, nullptr, nullptr);
  btPoint2PointConstraint stock(a, b, vec(0, 0, 0), vec(0, 0, support::nan_value));
  EXPECT_NE(solver.whyIgnored(stock).find("pivotB"), std::string::npos);
  const pintle::BallJoint ours(a, b, vec(0, 0, 0), vec(0, 0, support::nan_value));
  EXPECT_EQ(solver.whyIgnored(ours), solver.whyIgnored(stock));
}
}  // namespace
}  // namespace upgraded_memory_test
