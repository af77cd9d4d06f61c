// One source of call patterns, compiled with btPoint2PointConstraint and with BallJoint in its
// place: the same calls give the same answers, and bodies move alike.
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <gtest/gtest.h>
#include <pintle/joints/ball_joint.h>

#include <vector>

#include "solver_of_tests.h"
#include "support.h"

namespace drop_in_ball_test {

using support::Random;
using support::scalar;
using support::vec;
using Stock = btPoint2PointConstraint;
using Ours = pintle::BallJoint;

void expectNear(const btVector3& a, const btVector3& b, double tolerance) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "xyz"[i];
}

// --- settings ------------------------------------------------------------------------------------

struct Answers {
  std::vector<std::pair<const char*, double>> values;

  void add(const char* what, double value) { values.push_back({what, value}); }
  void add(const char* what, const btVector3& v) {
    for (int i = 0; i < 3; ++i) add(what, double(v[i]));
  }
};

// Every setter and getter of btPoint2PointConstraint and of its base class.
template <class Ball>
Answers setAndAsk(bool to_world) {
  Random random(1);
  const auto a = support::body(1, vec(1, 2, 3), random.pose(3));
  const auto b = support::body(1, vec(1, 2, 3), random.pose(3));
  const btVector3 pivot_a = random.vector(1), pivot_b = random.vector(1);
  const std::unique_ptr<Ball> owner = to_world ? std::make_unique<Ball>(*a, pivot_a)
                                               : std::make_unique<Ball>(*a, *b, pivot_a, pivot_b);
  Ball& ball = *owner;
  const Ball& constant = ball;
  btTypedConstraint& base = ball;
  Answers out;
  const auto now = [&] {
    out.add("pivot a", constant.getPivotInA());
    out.add("pivot b", constant.getPivotInB());
    out.add("flags", constant.getFlags());
    out.add("tau", ball.m_setting.m_tau);
    out.add("damping", ball.m_setting.m_damping);
    out.add("clamp", ball.m_setting.m_impulseClamp);
    out.add("enabled", base.isEnabled());
    out.add("needs feedback", base.needsFeedback());
    out.add("iterations", base.getOverrideNumSolverIterations());
    out.add("breaking", double(base.getBreakingImpulseThreshold()) / 1e18);
    out.add("user type", base.getUserConstraintType());
    out.add("user id", base.getUserConstraintId());
    out.add("debug size", base.getDbgDrawSize());
    out.add("feedback", base.getJointFeedback() != nullptr);
    out.add("body a", &constant.getRigidBodyA() == a.get());
    out.add("body b", &constant.getRigidBodyB() == b.get());
    out.add("fixed body", &ball.getRigidBodyB() == &btTypedConstraint::getFixedBody());
  };
  now();
  ball.setPivotA(vec(1, 2, 3));
  ball.setPivotB(vec(4, 5, 6));
  now();
  ball.m_setting.m_tau = scalar(0.4);
  ball.m_setting.m_damping = scalar(0.7);
  ball.m_setting.m_impulseClamp = 12;
  now();
  // Unset, stock's are not initialised.
  ball.setParam(BT_CONSTRAINT_ERP, scalar(0.3));
  now();
  out.add("ERP", ball.getParam(BT_CONSTRAINT_ERP));
  out.add("STOP_ERP", base.getParam(BT_CONSTRAINT_STOP_ERP, -1));
  base.setParam(BT_CONSTRAINT_CFM, scalar(0.01), -1);
  now();
  out.add("CFM", base.getParam(BT_CONSTRAINT_CFM));
  out.add("STOP_CFM", ball.getParam(BT_CONSTRAINT_STOP_CFM));
  ball.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.6));
  ball.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.02));
  now();
  out.add("ERP", ball.getParam(BT_CONSTRAINT_ERP));
  out.add("CFM", ball.getParam(BT_CONSTRAINT_CFM));
  btJointFeedback feedback;
  support::setBaseSettings(base, feedback);
  now();
  return out;
}

TEST(DropInBall, SettersAndGettersGiveStocksAnswers) {
  for (const bool to_world : {false, true}) {
    const Answers stock = setAndAsk<Stock>(to_world), ours = setAndAsk<Ours>(to_world);
    ASSERT_EQ(stock.values.size(), ours.values.size());
    for (size_t i = 0; i < stock.values.size(); ++i)
      EXPECT_EQ(stock.values[i].second, ours.values[i].second) << stock.values[i].first;
  }
}

// --- motion --------------------------------------------------------------------------------------

enum class Side { both, static_a, static_b, kinematic_a, kinematic_b, world };
constexpr Side sides[] = {Side::both,        Side::static_a,    Side::static_b,
                          Side::kinematic_a, Side::kinematic_b, Side::world};

// Two boxes corner to corner, or one on a support.
template <class Ball>
class Rig {
 public:
  explicit Rig(Side side, double gravity = 0, int iterations = 100) : m_world(gravity, iterations) {
    const btVector3 box = vec(0.5, 0.2, 0.1), pivot = vec(0.5, 0.2, 0.1);
    const bool held_a = side == Side::static_a || side == Side::kinematic_a;
    const bool held_b = side == Side::static_b || side == Side::kinematic_b;
    m_a = &m_world.add_box(held_a ? 0 : 2, box, scenes::pose_at(vec(0, 0, 0)));
    if (side == Side::world) {
      m_ball = &m_world.add_joint<Ball>(*m_a, pivot);
    } else {
      m_b = &m_world.add_box(held_b ? 0 : 1, box, scenes::pose_at(pivot + pivot));
      m_ball = &m_world.add_joint<Ball>(*m_a, *m_b, pivot, -pivot);
    }
    for (btRigidBody* body :
         {side == Side::kinematic_a ? m_a : nullptr, side == Side::kinematic_b ? m_b : nullptr})
      if (body)
        body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    m_free = held_b || side == Side::world ? m_a : m_b;
  }

  Ball& ball() { return *m_ball; }
  btRigidBody& a() { return *m_a; }
  btRigidBody& b() { return *m_b; }
  btRigidBody& free() { return *m_free; }
  void step(int steps = 1) {
    for (int i = 0; i < steps; ++i) m_world.step(1.0 / 60);
  }
  double gap() const {
    const btVector3 in_a = m_a->getCenterOfMassTransform()(m_ball->getPivotInA());
    const btTransform pose_b = m_b ? m_b->getCenterOfMassTransform() : btTransform::getIdentity();
    return double((pose_b(m_ball->getPivotInB()) - in_a).length());
  }

 private:
  scenes::World m_world;
  btRigidBody *m_a = nullptr, *m_b = nullptr, *m_free = nullptr;
  Ball* m_ball = nullptr;
};

// Runs a pattern on every side, stock and ours. It gives a list of vectors to compare.
template <class Pattern>
void expectSameOnEverySide(Pattern pattern, double tolerance) {
  for (const Side side : sides) {
    SCOPED_TRACE(testing::Message() << "side " << int(side));
    Rig<Stock> stock(side);
    Rig<Ours> ours(side);
    const std::vector<btVector3> expected = pattern(stock), got = pattern(ours);
    ASSERT_EQ(expected.size(), got.size());
    for (size_t i = 0; i < got.size(); ++i) {
      SCOPED_TRACE(testing::Message() << "value " << i);
      expectNear(expected[i], got[i], tolerance);
    }
  }
}

TEST(DropInBall, SwingsAsStocks) {
  // 20 steps of a swing: a few centimetres per metre of what a joint without stock's drift does
  // differently.
  expectSameOnEverySide(
      [](auto& rig) {
        std::vector<btVector3> positions;
        for (int i = 0; i < 20; ++i) {
          rig.free().applyCentralForce(vec(0, 0, -9.81));
          rig.step();
          positions.push_back(rig.free().getCenterOfMassPosition());
        }
        EXPECT_LT(rig.gap(), 0.01);
        EXPECT_GT((positions.back() - positions.front()).length(), 0.05);
        return positions;
      },
      0.01);
}

TEST(DropInBall, FeedbackIsStocks) {
  PINTLE_SKIP_ON_EXACT_SOLVER("impulses are those that hold the joint at the end of the step");
  // A fresh joint at rest under a load: both solve the same equations. Some N; 100 iterations.
  expectSameOnEverySide(
      [](auto& rig) {
        btJointFeedback feedback;
        rig.ball().setJointFeedback(&feedback);
        rig.ball().enableFeedback(true);
        rig.free().applyCentralForce(vec(3, -5, 7));
        rig.free().applyTorque(vec(1, 0.5, -0.25));
        rig.step();
        rig.ball().setJointFeedback(nullptr);
        EXPECT_GT(feedback.m_appliedForceBodyA.length(), 1);
        EXPECT_NE(rig.ball().getAppliedImpulse(), 0);
        return std::vector<btVector3>{feedback.m_appliedForceBodyA, feedback.m_appliedTorqueBodyA,
                                      feedback.m_appliedForceBodyB, feedback.m_appliedTorqueBodyB};
      },
      1e-3);
}

TEST(DropInBall, ImpulseClampBoundsTheForceAsStocks) {
  for (const double clamp : {0.05, 0.5}) {
    // The same bounds in the same world axes, of a fresh joint: the residual of 100 iterations. (On the exact solver the rows that
    // are not at a bound hold at the end of the step.)
    expectSameOnEverySide(
        [clamp](auto& rig) {
          btJointFeedback feedback;
          rig.ball().setJointFeedback(&feedback);
          rig.ball().m_setting.m_impulseClamp = scalar(clamp);
          const auto load = [&] {
            rig.free().applyCentralForce(vec(300, -5, 40));
            rig.step();
            for (int j = 0; j < 3; ++j)
              EXPECT_LE(std::abs(feedback.m_appliedForceBodyA[j]), 60 * clamp * (1 + 1e-5));
            EXPECT_NEAR(std::abs(feedback.m_appliedForceBodyA.x()), 60 * clamp, 1e-3);
          };
          load();
          const std::vector<btVector3> first = {feedback.m_appliedForceBodyA,
                                                feedback.m_appliedTorqueBodyA,
                                                rig.free().getLinearVelocity()};
          // The bound stands while the joint is torn apart.
          load();
          load();
          rig.ball().setJointFeedback(nullptr);
          return first;
        },
        onExactSolver() ? 0.2 : 2e-3);
  }
}

TEST(DropInBall, DampingTakesAwayAsMuchVelocityAsStocks) {
  for (const double damping : {0.0, 0.3, 0.8, 1.0}) {
    if (damping == 1 && onExactSolver()) continue;  // then it holds at the end of the step
    expectSameOnEverySide(
        [damping](auto& rig) {
          rig.ball().m_setting.m_damping = scalar(damping);
          rig.free().setLinearVelocity(vec(1, 2, 3));
          rig.step();
          return std::vector<btVector3>{rig.free().getLinearVelocity(),
                                        rig.free().getAngularVelocity()};
        },
        // Some m/s: the residual of 100 iterations. (The exact solver takes it along the way of the step, and at its end.)
        onExactSolver() ? 0.12 : 1e-3);
  }
}

TEST(DropInBall, ErpTakesAwayThePartOfTheErrorThatStocksDoes) {
  PINTLE_SKIP_ON_EXACT_SOLVER("what is open closes by poses, which velocities tell nothing of");
  for (const double erp : {0.0, 0.3, 0.8}) {
    expectSameOnEverySide(
        [erp](auto& rig) {
          rig.ball().setParam(BT_CONSTRAINT_ERP, scalar(erp));
          support::closeByErpAlone(rig.ball());
          rig.free().translate(vec(0.01, -0.02, 0.03));
          const double before = rig.gap();
          rig.step();
          EXPECT_NEAR(rig.gap() / before, 1 - erp, 0.1);
          return std::vector<btVector3>{rig.free().getCenterOfMassPosition()};
        },
        // Violated, ours holds both bodies at one point and stock each at its own: levers of 0.5
        // that differ by the error of 0.04, and so does what is taken away of it.
        2e-3);
  }
}

TEST(DropInBall, CfmSoftensAsStocks) {
  // From a fresh joint of one free body at the pivot: each row is on its own, and 1 / (1 + cfm) of
  // the velocity is taken away.
  for (const double cfm : {0.0, 0.05, 0.5}) {
    const auto run = [cfm](auto&& world) {
      using Ball = typename std::decay_t<decltype(world)>::Joint;
      btRigidBody& body = world.add_box(1, vec(0.5, 0.2, 0.1), scenes::pose_at(vec(0, 0, 0)));
      Ball& ball = world.template add_joint<Ball>(body, vec(0, 0, 0));
      ball.setParam(BT_CONSTRAINT_CFM, scalar(cfm));
      body.setLinearVelocity(vec(1, 2, 3));
      world.step(1.0 / 60);
      return body.getLinearVelocity();
    };
    struct StockWorld : scenes::World {
      using Joint = Stock;
      StockWorld() : scenes::World(0, 100) {}
    };
    struct OurWorld : scenes::World {
      using Joint = Ours;
      OurWorld() : scenes::World(0, 100) {}
    };
    const btVector3 stock = run(StockWorld()), ours = run(OurWorld());
    expectNear(stock, vec(1, 2, 3) * scalar(1 - 1 / (1 + cfm)), 1e-4);
    expectNear(stock, ours, 1e-4);
  }
}

TEST(DropInBall, ADisabledJointLetsGoAndHoldsAgainAsStocks) {
  expectSameOnEverySide(
      [](auto& rig) {
        rig.ball().setEnabled(false);
        rig.free().setLinearVelocity(vec(0, 0, 0.5));
        rig.step(30);
        EXPECT_NEAR(rig.gap(), 0.25, 1e-3);
        const btVector3 away = rig.free().getCenterOfMassPosition();
        rig.ball().setEnabled(true);
        rig.step(60);
        EXPECT_LT(rig.gap(), 0.01);
        return std::vector<btVector3>{away};
      },
      1e-4);
}

template <class Ball>
int stepOfBreaking(Side side, const btVector3& force, const btVector3& torque) {
  Rig<Ball> rig(side);
  rig.ball().setBreakingImpulseThreshold(scalar(0.25));  // N s: 15 N at 60 Hz
  return support::stepOfBreaking(rig, rig.ball(), force, torque);
}

TEST(DropInBall, BreaksInTheStepInWhichStocksDoes) {
  for (const Side side : {Side::both, Side::static_a, Side::static_b, Side::world}) {
    for (int axis = 0; axis < 3; ++axis) {
      btVector3 u(0, 0, 0);
      u[axis] = 1;
      for (const bool twist : {false, true}) {
        SCOPED_TRACE(testing::Message() << "side " << int(side) << ", "
                                        << (twist ? "torque " : "force ") << "xyz"[axis]);
        const btVector3 force = twist ? btVector3(0, 0, 0) : u, torque = u - force;
        const int stock = stepOfBreaking<Stock>(side, force, torque);
        const int ours = stepOfBreaking<Ours>(side, force, torque);
        EXPECT_NEAR(ours, stock, 1);
      }
    }
  }
}

// A hanging body: the load stays along one axis, and below the threshold it hangs for good.
TEST(DropInBall, DoesNotBreakBelowItsThreshold) {
  const auto breaks = [](auto&& rig, double share) {
    rig.ball().setPivotA(vec(0, 0, 0.1));
    rig.ball().setPivotB(rig.a().getCenterOfMassTransform()(vec(0, 0, 0.1)));
    // 2 kg.
    rig.ball().setBreakingImpulseThreshold(scalar(share * 2 * 9.81 / 60));
    rig.step(120);
    return !rig.ball().isEnabled();
  };
  EXPECT_TRUE(breaks(Rig<Stock>(Side::world, 9.81), 0.99));
  EXPECT_TRUE(breaks(Rig<Ours>(Side::world, 9.81), 0.99));
  EXPECT_FALSE(breaks(Rig<Stock>(Side::world, 9.81), 1.01));
  EXPECT_FALSE(breaks(Rig<Ours>(Side::world, 9.81), 1.01));
}

}  // namespace drop_in_ball_test
