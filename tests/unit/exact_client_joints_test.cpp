// Clients' classes that are derived from joints of Pintle's, and add rows of their own or change those of their bases.
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/universal_joint.h>
#include <pintle/solver/exact_joint_solver.h>

#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>
#include <scenes/world.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <type_traits>
#include <vector>

#include "books.h"
#include "exact_support.h"
#include "physics_support.h"
#include "support.h"

namespace exact_client_joints_test {
namespace {

using physics::rounding;
using support::Books;
using support::RowData;
using support::scalar;
using support::vec;
using namespace exact_support;

constexpr double dt = 1. / 60;

std::unique_ptr<btConstraintSolver> bullets() {
  return std::make_unique<btSequentialImpulseConstraintSolver>();
}

/// One row of those that are asked for, by its number.
struct RowOf {
  RowOf(btTypedConstraint::btConstraintInfo2& info, int i)
      : J1(info.m_J1angularAxis + i * info.rowskip),
        J2(info.m_J2angularAxis + i * info.rowskip),
        error(info.m_constraintError[i * info.rowskip]),
        cfm(info.cfm[i * info.rowskip]),
        lower(info.m_lowerLimit[i * info.rowskip]),
        upper(info.m_upperLimit[i * info.rowskip]) {}
  btScalar *J1, *J2;
  btScalar &error, &cfm, &lower, &upper;
};

/// Adds a row about body a's z axis, of at most `bound`, N m s in a step. With `erp` it closes the angle about it, of x against x.
template <class Base>
class WithRow : public Base {
 public:
  using Base::Base;
  void getInfo1(btTypedConstraint::btConstraintInfo1* info) override {
    Base::getInfo1(info);
    m_row = info->m_numConstraintRows;
    if (adds) ++info->m_numConstraintRows;
  }
  void getInfo2(btTypedConstraint::btConstraintInfo2* info) override {
    Base::getInfo2(info);
    if (!adds) return;
    RowOf row(*info, m_row);
    const btMatrix3x3 &a = this->m_rbA.getCenterOfMassTransform().getBasis(),
                      &b = this->m_rbB.getCenterOfMassTransform().getBasis();
    const btVector3 axis = a.getColumn(2);
    for (int k = 0; k < 3; ++k) {
      row.J1[k] = axis[k];
      row.J2[k] = -axis[k];
    }
    const btScalar angle = axis.dot(a.getColumn(0).cross(b.getColumn(0)));
    row.error = erp * info->fps * angle;
    row.lower = -bound;
    row.upper = bound;
  }
  bool adds = true;
  btScalar bound = 0, erp = 0;

 private:
  int m_row = 0;
};

/// Gives the rows of its base as `change` leaves them, and may leave out some.
template <class Base>
class WithChanges : public Base {
 public:
  using Base::Base;
  void getInfo1(btTypedConstraint::btConstraintInfo1* info) override {
    Base::getInfo1(info);
    m_count = info->m_numConstraintRows;
    info->m_numConstraintRows = m_count - (left_out >= 0 ? 1 : 0);
  }
  void getInfo2(btTypedConstraint::btConstraintInfo2* info) override {
    RowData rows[16] = {};
    btTypedConstraint::btConstraintInfo2 of_base = *info;
    btScalar* const first = rows[0].fields;
    of_base.m_J1linearAxis = first;
    of_base.m_J1angularAxis = first + 3;
    of_base.m_J2linearAxis = first + 6;
    of_base.m_J2angularAxis = first + 9;
    of_base.rowskip = RowData::size;
    of_base.m_constraintError = first + 12;
    of_base.cfm = first + 13;
    *of_base.cfm = *info->cfm;
    of_base.m_lowerLimit = first + 14;
    of_base.m_upperLimit = first + 15;
    for (RowData& row : rows) {
      row.fields[14] = -SIMD_INFINITY;
      row.fields[15] = SIMD_INFINITY;
    }
    Base::getInfo2(&of_base);
    info->m_damping = of_base.m_damping;
    for (int i = 0; i < m_count; ++i) change(i, rows[i].fields);
    for (int i = 0, next = 0; i < m_count; ++i) {
      if (i == left_out) continue;
      const int at = next++ * info->rowskip;
      const btScalar* const from = rows[i].fields;
      std::copy_n(from, 3, info->m_J1linearAxis + at);
      std::copy_n(from + 3, 3, info->m_J1angularAxis + at);
      std::copy_n(from + 6, 3, info->m_J2linearAxis + at);
      std::copy_n(from + 9, 3, info->m_J2angularAxis + at);
      info->m_constraintError[at] = from[12];
      info->cfm[at] = from[13];
      info->m_lowerLimit[at] = from[14];
      info->m_upperLimit[at] = from[15];
    }
  }
  int left_out = -1;  ///< the number of a row; -1: none is
  std::function<void(int, btScalar*)> change = [](int, btScalar*) {};

 private:
  int m_count = 0;
};

btScalar& cfmOf(btScalar* row) { return row[13]; }
btScalar& lowerOf(btScalar* row) { return row[14]; }

/// A box about z at a distance of 1 m, on a static post, without gravity.
struct Arm {
  explicit Arm(const scenes::SolverFactory& solver)
      : world(0, 10, solver),
        post(world.add_box(0, vec(0.2, 0.2, 0.2), at(0, 0, 0))),
        box(world.add_box(1, vec(0.2, 0.2, 0.2), at(1, 0, 0))) {}
  template <class J>
  J& hinge() {
    return world.take_joint(std::make_unique<J>(post, box, at(0, 0, 0), at(-1, 0, 0), true));
  }
  void start(double w) {
    box.setAngularVelocity(vec(0, 0, w));
    box.setLinearVelocity(vec(0, w, 0));
  }
  void step() {
    world.step(dt);
    gap = std::max(gap, double((box.getWorldTransform() * vec(-1, 0, 0)).length()));
  }
  double speed() const { return double(box.getAngularVelocity().z()); }
  /// kg m^2, about the hinge.
  double inertia() const { return 1 + 1 / double(box.getInvInertiaDiagLocal().z()); }

  scenes::World world;
  btRigidBody &post, &box;
  double gap = 0;
};

// Friction takes its bound from the arm in each step, until it stands.
TEST(ClientJoints, RowsThatTheyAddBrakeAsTheirBoundSays) {
  for (const bool is_exact : {false, true})
    for (const double w : {1., 3.})
      for (const double bound : {0., 0.005, 0.02}) {
        SCOPED_TRACE(testing::Message()
                     << (is_exact ? "exact, " : "Bullet's, ") << w << " rad/s, " << bound);
        double stock_gap = 0;
        if (!is_exact) {
          Arm stock(bullets);
          stock.hinge<WithRow<btHingeConstraint>>().bound = scalar(bound);
          stock.start(w);
          for (int i = 0; i < 120; ++i) stock.step();
          stock_gap = stock.gap;
        }
        Arm arm(is_exact ? exact : bullets);
        auto& joint = arm.hinge<WithRow<pintle::QuaternionHinge>>();
        joint.bound = scalar(bound);
        btJointFeedback feedback;
        joint.enableFeedback(true);
        joint.setJointFeedback(&feedback);
        arm.start(w);
        for (int i = 1; i <= 120; ++i) {
          arm.step();
          const double expected = std::max(0., w - i * bound / arm.inertia());
          // Bullet's passes find so slow a stop step by step; after a second it stands.
          if (!is_exact && i % 60 != 0) continue;
          ASSERT_NEAR(arm.speed(), expected, 0.002 * std::max(expected, 0.01 * w)) << i;
          if (expected == 0) continue;
          // As Bullet has it, the impulse of the last row. Feedback has all of them.
          ASSERT_NEAR(std::abs(double(joint.getAppliedImpulse())), bound, 1e-6) << i;
          const double turns = double(feedback.m_appliedTorqueBodyA.z());
          ASSERT_NEAR(std::abs(turns), bound / dt, rounding(1e-4, 1e-6) + (is_exact ? 0 : 0.1))
              << i;
        }
        EXPECT_LE(arm.gap, is_exact ? rounding(2e-6, 1e-9) : stock_gap);
      }
}

/// What is compared of a joint and its body.
struct Ends {
  btTransform pose;
  btVector3 v, w;
  std::vector<double> impulses;
};

void expectSame(const Ends& a, const Ends& b, double tolerance) {
  EXPECT_LE(double((a.pose.getOrigin() - b.pose.getOrigin()).length()), tolerance);
  EXPECT_LE(double((a.v - b.v).length()), tolerance);
  EXPECT_LE(double((a.w - b.w).length()), tolerance);
  ASSERT_EQ(a.impulses.size(), b.impulses.size());
  for (size_t i = 0; i < a.impulses.size(); ++i)
    EXPECT_NEAR(a.impulses[i], b.impulses[i], tolerance) << i;
}

/// Two bodies swing on a joint under gravity, one of them on a ball. `set` sets the joint.
template <class Base, class Set, class Read>
Ends swing(bool adds, const Set& set, const Read& read) {
  Books books(60);
  btRigidBody& upper = books.add(1, vec(0.25, 0.1, 0.05), vec(0.25, 0, 0));
  btRigidBody& lower = books.add(2, vec(0.25, 0.05, 0.1), vec(0.75, 0, 0));
  books.join(std::make_unique<pintle::BallJoint>(upper, vec(-0.25, 0, 0)));
  std::unique_ptr<WithRow<Base>> made;
  if constexpr (std::is_same_v<Base, pintle::BallJoint>)
    made = std::make_unique<WithRow<Base>>(upper, lower, vec(0.25, 0, 0), vec(-0.25, 0, 0));
  else if constexpr (std::is_same_v<Base, pintle::UniversalJoint>)
    made =
        std::make_unique<WithRow<Base>>(upper, lower, vec(0.5, 0, 0), vec(0, 0, 1), vec(0, 1, 0));
  else if constexpr (std::is_same_v<Base, pintle::FixedJoint>)
    made = std::make_unique<WithRow<Base>>(upper, lower, at(0.25, 0, 0), at(-0.25, 0, 0));
  else
    made = std::make_unique<WithRow<Base>>(upper, lower, at(0.25, 0, 0), at(-0.25, 0, 0), true);
  WithRow<Base>& joint = *made;
  joint.adds = adds;
  set(joint);
  books.join(std::move(made));
  lower.setAngularVelocity(vec(1, 2, 3));
  books.begin();
  for (int i = 0; i < 60; ++i) books.step();
  return {lower.getCenterOfMassTransform(), lower.getLinearVelocity(), lower.getAngularVelocity(),
          read(joint)};
}

template <class Base, class Set, class Read>
void expectTheBase(const Set& set, const Read& read, double tolerance = rounding(1e-3, 1e-7)) {
  expectSame(swing<Base>(false, set, read), swing<Base>(true, set, read), tolerance);
}

const auto reads_nothing = [](auto&) { return std::vector<double>(); };

// A row that may do nothing changes nothing: limits, motors, springs and their readings are those of the base.
TEST(ClientJoints, RowsThatTheyAddLeaveTheirBasesAsTheyAre) {
  const auto nothing = [](auto&) {};
  {
    SCOPED_TRACE("ball");
    expectTheBase<pintle::BallJoint>(nothing, reads_nothing);
  }
  {
    SCOPED_TRACE("fixed");
    expectTheBase<pintle::FixedJoint>(nothing, reads_nothing);
  }
  {
    SCOPED_TRACE("universal with limits");
    expectTheBase<pintle::UniversalJoint>(
        [](auto& joint) {
          joint.setLowerLimit(scalar(-0.5), scalar(-0.5));
          joint.setUpperLimit(scalar(0.5), scalar(0.5));
        },
        reads_nothing);
  }
  {
    SCOPED_TRACE("slider");
    expectTheBase<pintle::SliderJoint>(
        [](auto& joint) {
          joint.setLowerLinLimit(scalar(-0.1));
          joint.setUpperLinLimit(scalar(0.2));
        },
        reads_nothing);
  }
  using Hinge = pintle::QuaternionHinge;
  const auto readMotor = [](Hinge& joint) {
    return std::vector<double>{double(joint.getMotorImpulse()), double(joint.getHingeAngle())};
  };
  {
    SCOPED_TRACE("hinge with a motor and a limit");
    expectTheBase<Hinge>(
        [](auto& joint) {
          joint.setLimit(scalar(-0.4), scalar(0.4));
          joint.enableAngularMotor(true, 5, scalar(0.02));
        },
        readMotor);
  }
  {
    SCOPED_TRACE("hinge with a spring as its limit");
    expectTheBase<Hinge>(
        [](auto& joint) {
          joint.setLimit(scalar(-0.2), scalar(0.2));
          joint.setLimitSpring(2, scalar(0.1));
        },
        readMotor);
  }
  {
    SCOPED_TRACE("hinge that rebounds");
    expectTheBase<Hinge>(
        [](auto& joint) { joint.setLimit(scalar(-0.2), scalar(0.2), scalar(0.9), scalar(0.3), 1); },
        readMotor, 0.01);
  }
}

// An added row may be an equality: a hinge that is locked about its axis is a weld.
TEST(ClientJoints, RowsThatTheyAddHoldWhatTheirBasesDoNot) {
  Books books(60);
  btRigidBody& arm = books.add(1, vec(0.5, 0.1, 0.1), vec(0.5, 0, 0));
  btRigidBody& post = books.add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
  const btTransform across(btQuaternion(vec(1, 0, 0), scalar(physics::radians(90))));
  arm.setWorldTransform(btTransform(across.getBasis(), vec(0.5, 0, 0)));
  auto made = std::make_unique<WithRow<pintle::QuaternionHinge>>(
      arm, post, at(-0.5, 0, 0), btTransform(across.getBasis(), vec(0, 0, 0)), true);
  made->bound = SIMD_INFINITY;
  made->erp = scalar(0.2);
  WithRow<pintle::QuaternionHinge>& joint = *made;
  books.join(std::move(made));
  books.begin();
  for (int i = 0; i < 240; ++i) {
    books.step();
    ASSERT_NEAR(double(arm.getCenterOfMassPosition().z()), 0, rounding(1e-5, 1e-8)) << i;
    ASSERT_EQ(books.solver.lastStep().not_converged, 0) << i;
  }
  // It bears the weight on its lever. (Bullet's sign: of body a against b.)
  EXPECT_NEAR(std::abs(double(joint.getAppliedImpulse())), 0.5 * support::gravity * dt,
              rounding(1e-4, 1e-6));
}

// It may come and go, beside limits that do: what is known of the base's rows stays.
TEST(ClientJoints, RowsThatTheyAddMayComeAndGo) {
  Books books(60);
  btRigidBody& arm = books.add(1, vec(0.5, 0.1, 0.1), vec(0.5, 0, 0));
  btRigidBody& post = books.add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
  const btTransform across(btQuaternion(vec(1, 0, 0), scalar(physics::radians(90))));
  auto made = std::make_unique<WithRow<pintle::QuaternionHinge>>(
      arm, post, btTransform(across.getBasis(), vec(-0.5, 0, 0)),
      btTransform(across.getBasis(), vec(0, 0, 0)), true);
  made->setLimit(scalar(-0.5), scalar(0.5));
  WithRow<pintle::QuaternionHinge>& joint = *made;
  books.join(std::move(made));
  books.begin();
  double gap = 0, angle = 0;
  for (int i = 0; i < 240; ++i) {
    joint.adds = i % 3 != 0;
    books.step();
    gap = std::max(gap, double((arm.getCenterOfMassTransform() * vec(-0.5, 0, 0)).length()));
    angle = std::max(angle, std::abs(double(joint.getHingeAngle())));
    ASSERT_EQ(books.solver.lastStep().not_converged, 0) << i;
  }
  EXPECT_LE(gap, rounding(2e-6, 2e-9));  // of three rows, each to 1e-9
  EXPECT_NEAR(angle, 0.5, rounding(1e-4, 1e-8)) << "it lies on its limit";
  EXPECT_LE(books.gain, 0.01 * books.peak);
}

// A threshold is compared with the impulse of an added row, too.
TEST(ClientJoints, RowsThatTheyAddBreakThem) {
  for (const double bound : {0.005, 0.02}) {
    Arm arm(exact);
    auto& joint = arm.hinge<WithRow<pintle::QuaternionHinge>>();
    joint.bound = scalar(bound);
    joint.setBreakingImpulseThreshold(scalar(0.01));
    arm.box.setAngularVelocity(vec(0, 0, 0.1));
    arm.box.setLinearVelocity(vec(0, 0.1, 0));
    arm.step();
    EXPECT_EQ(joint.isEnabled(), bound < 0.01);
    EXPECT_NEAR(arm.speed(), bound < 0.01 ? 0.1 - bound / arm.inertia() : 0.1, 1e-5);
  }
}

/// A chain of two links that starts from the horizontal and falls on joints of which `set` changes the rows.
template <class Base, class Set>
void expectNoGain(const Set& set, double max_gap) {
  for (const double hz : {60., 240.}) {
    SCOPED_TRACE(testing::Message() << hz << " Hz");
    Books books(hz);
    btRigidBody* last = &books.add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
    const btTransform across(btQuaternion(vec(1, 0, 0), scalar(physics::radians(90))));
    for (int i = 0; i < 2; ++i) {
      btRigidBody& link = books.add(1, vec(0.25, 0.05, 0.05), vec(0.5 * i + 0.25, 0, 0));
      const btTransform frame(across.getBasis(), vec(0.5 * i, 0, 0)),
          in_a = last->getCenterOfMassTransform().inverse() * frame,
          in_b = link.getCenterOfMassTransform().inverse() * frame;
      std::unique_ptr<WithChanges<Base>> made;
      if constexpr (std::is_same_v<Base, pintle::BallJoint>)
        made = std::make_unique<WithChanges<Base>>(*last, link, in_a.getOrigin(), in_b.getOrigin());
      else if constexpr (std::is_same_v<Base, pintle::FixedJoint>)
        made = std::make_unique<WithChanges<Base>>(*last, link, in_a, in_b);
      else
        made = std::make_unique<WithChanges<Base>>(*last, link, in_a, in_b, true);
      set(*made);
      books.join(std::move(made));
      last = &link;
    }
    books.begin();
    double gap = 0;
    for (int i = 0; i < 4 * int(hz); ++i) {
      books.step();
      gap = std::max(
          gap, double((books.bodies[1]->getCenterOfMassTransform() * vec(-0.25, 0, 0)).length()));
    }
    EXPECT_LE(books.gain, 0.01 * books.peak);
    EXPECT_GT(books.peak, 3) << "it has fallen";
    EXPECT_LE(gap, max_gap);
  }
}

// Rows of Pintle's for Bullet's solver predict how their motion is curved, which one that finds the end of the step would count again.
TEST(ClientJoints, RowsThatTheyChangeGiveNoEnergy) {
  // A hinge has its two angles first.
  const auto softenAngle = [](auto& joint) {
    joint.change = [](int i, btScalar* row) {
      if (i == 0) cfmOf(row) = scalar(0.01);
    };
  };
  const auto softenAll = [](auto& joint) {
    joint.change = [](int, btScalar* row) { cfmOf(row) = scalar(0.01); };
  };
  const auto soften = [](auto& joint) {
    joint.change = [](int i, btScalar* row) {
      if (i == 2) cfmOf(row) = scalar(0.01);
    };
  };
  const auto boundOne = [](auto& joint) {
    joint.change = [](int i, btScalar* row) {
      if (i == 2) lowerOf(row) = 0;
    };
  };
  const auto boundAll = [](auto& joint) {
    joint.change = [](int, btScalar* row) {
      row[14] = -50;
      row[15] = 50;
    };
  };
  const auto leaveOutTheFirst = [](auto& joint) { joint.left_out = 0; };
  using Hinge = pintle::QuaternionHinge;
  const double held = rounding(1e-5, 1e-8), soft = 0.5;
  {
    SCOPED_TRACE("hinge, soft in an angle");
    expectNoGain<Hinge>(softenAngle, held);
  }
  {
    SCOPED_TRACE("hinge, soft");
    expectNoGain<Hinge>(softenAll, soft);
  }
  {
    SCOPED_TRACE("hinge, soft in a direction");
    expectNoGain<Hinge>(soften, soft);
  }
  {
    SCOPED_TRACE("hinge without an angle");
    expectNoGain<Hinge>(leaveOutTheFirst, held);
  }
  {
    SCOPED_TRACE("hinge with bounds");
    expectNoGain<Hinge>(boundAll, soft);
  }
  {
    SCOPED_TRACE("hinge with a stop");
    expectNoGain<Hinge>(boundOne, 100);
  }
  {
    SCOPED_TRACE("ball, soft");
    expectNoGain<pintle::BallJoint>(softenAll, soft);
  }
  {
    SCOPED_TRACE("ball, soft in a direction");
    expectNoGain<pintle::BallJoint>(soften, soft);
  }
  {
    SCOPED_TRACE("ball with bounds");
    expectNoGain<pintle::BallJoint>(boundAll, soft);
  }
  {
    SCOPED_TRACE("ball with a stop");
    expectNoGain<pintle::BallJoint>(boundOne, 100);
  }
  {
    SCOPED_TRACE("ball without a direction");
    expectNoGain<pintle::BallJoint>(leaveOutTheFirst, 100);
  }
}

// What starts open closes by moving poses, at no more than the joint's speed.
TEST(ClientJoints, RowsThatTheyChangeCloseWithoutAVelocity) {
  Arm arm(exact);
  auto& joint = arm.hinge<WithChanges<pintle::QuaternionHinge>>();
  joint.change = [](int i, btScalar* row) {
    if (i == 0) cfmOf(row) = scalar(1e-9);
  };
  joint.setMaxCorrectionSpeed(2);
  arm.box.setWorldTransform(btTransform(btQuaternion(vec(1, 0, 0), 1), vec(1, 0, 0)));
  double last = 1;
  for (int i = 0; i < 120; ++i) {
    arm.step();
    ASSERT_LE(double(arm.box.getAngularVelocity().length()), 1e-3) << i;
    const double angle = double(arm.box.getWorldTransform().getRotation().getAngleShortestPath());
    ASSERT_LE(last - angle, 2 * dt + 1e-3) << i;
    last = angle;
  }
  EXPECT_LE(last, 0.01);
}

}  // namespace
}  // namespace exact_client_joints_test
