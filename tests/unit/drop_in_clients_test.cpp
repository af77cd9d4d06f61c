// What programs do with Bullet's joints beside making and reading them: subclasses, setParam of anything, the solver's
// internals by name, readings at other poses, and settings written into structs. The same code, on both libraries.
#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <BulletDynamics/ConstraintSolver/btUniversalConstraint.h>
#include <gtest/gtest.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/distance_joint.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/universal_joint.h>

#include <type_traits>
#include <vector>

#include "solver_of_tests.h"
#include "support.h"

namespace drop_in_clients_test {

using scenes::World;
using support::infinite;
using support::is_double;
using support::nan_value;
using support::Random;
using support::refusal;
using support::scalar;
using support::SolverRows;
using support::vec;

constexpr double dt = 1.0 / 60;
constexpr double rounding = is_double ? 1e-12 : 2e-5;

template <class J>
constexpr bool is_ball =
    std::is_base_of_v<pintle::BallJoint, J> || std::is_base_of_v<btPoint2PointConstraint, J>;
template <class J>
constexpr bool is_universal =
    std::is_base_of_v<pintle::UniversalJoint, J> || std::is_base_of_v<btUniversalConstraint, J>;
template <class J>
constexpr bool is_slider =
    std::is_base_of_v<pintle::SliderJoint, J> || std::is_base_of_v<btSliderConstraint, J>;
template <class J>
constexpr bool is_fixed =
    std::is_base_of_v<pintle::FixedJoint, J> || std::is_base_of_v<btFixedConstraint, J>;

// A joint of two bodies that meets where they are.
template <class J>
std::unique_ptr<J> make(btRigidBody& a, btRigidBody& b, const btTransform& frame_a) {
  const btTransform world = a.getCenterOfMassTransform() * frame_a;
  const btTransform frame_b = b.getCenterOfMassTransform().inverse() * world;
  if constexpr (is_ball<J>)
    return std::make_unique<J>(a, b, frame_a.getOrigin(), frame_b.getOrigin());
  else if constexpr (is_universal<J>)
    return std::make_unique<J>(a, b, world.getOrigin(), world.getBasis().getColumn(2),
                               world.getBasis().getColumn(1));
  else if constexpr (is_slider<J>)
    return std::make_unique<J>(a, b, frame_a, frame_b, true);
  else
    return std::make_unique<J>(a, b, frame_a, frame_b);
}

template <class Joint, class Counterpart>
struct Case {
  using ours = Joint;
  using stock = Counterpart;
  /// All of stock's methods are stock's own (derived_hinge_test.cpp).
  static constexpr bool derives = std::is_base_of_v<Counterpart, Joint>;
};
using Cases = testing::Types<Case<pintle::QuaternionHinge, btHingeConstraint>,
                             Case<pintle::BallJoint, btPoint2PointConstraint>,
                             Case<pintle::SliderJoint, btSliderConstraint>,
                             Case<pintle::ConeTwistJoint, btConeTwistConstraint>,
                             Case<pintle::UniversalJoint, btUniversalConstraint>,
                             Case<pintle::FixedJoint, btFixedConstraint>>;

template <class Case>
class DropInClient : public testing::Test {
 protected:
  DropInClient() : random(31) {
    a = support::body(1, vec(1, 1, 1), random.pose(2));
    b = support::body(2, vec(2, 2, 2), random.pose(2));
    frame = random.pose(1);
  }

  Random random;
  std::unique_ptr<btRigidBody> a, b;
  btTransform frame;
};
TYPED_TEST_SUITE(DropInClient, Cases);

// --- setParam ------------------------------------------------------------------------------------

constexpr int numbers[] = {
    -1, 0, BT_CONSTRAINT_ERP, BT_CONSTRAINT_STOP_ERP, BT_CONSTRAINT_CFM, BT_CONSTRAINT_STOP_CFM,
    5,  99};
constexpr int axes[] = {-7, -2, -1, 0, 1, 2, 3, 4, 5, 6, 7, 100};

template <class J>
int flagsOf(const J& joint) {
  if constexpr (is_fixed<J>)
    return 0;  // Bullet's has no such method
  else
    return joint.getFlags();
}

TYPED_TEST(DropInClient, ParametersAndAxesAreTakenOrIgnoredAsStockDoes) {
  using Ours = typename TypeParam::ours;
  using Stock = typename TypeParam::stock;
  for (const int number : numbers) {
    for (const int axis : axes) {
      SCOPED_TRACE(testing::Message() << "parameter " << number << ", axis " << axis);
      const auto stock = make<Stock>(*this->a, *this->b, this->frame);
      const auto ours = make<Ours>(*this->a, *this->b, this->frame);
      if (is_ball<Stock>)  // which has no value of its own at first
        for (btTypedConstraint* joint : {static_cast<btTypedConstraint*>(stock.get()),
                                         static_cast<btTypedConstraint*>(ours.get())}) {
          joint->setParam(BT_CONSTRAINT_ERP, scalar(0.5));
          joint->setParam(BT_CONSTRAINT_CFM, scalar(0.125));
        }
      const auto expectSame = [&] {
        EXPECT_EQ(flagsOf(*stock), flagsOf(*ours));
        for (const int other : numbers)
          EXPECT_EQ(stock->getParam(other, axis), ours->getParam(other, axis)) << other;
      };
      // Bullet reads what was not set as it was made: nothing to compare where it uses the world's.
      if (is_fixed<Stock> || is_ball<Stock>) expectSame();
      stock->setParam(number, scalar(0.25), axis);
      ours->setParam(number, scalar(0.25), axis);
      EXPECT_EQ(flagsOf(*stock), flagsOf(*ours));
      EXPECT_EQ(stock->getParam(number, axis), ours->getParam(number, axis));
    }
  }
}

TYPED_TEST(DropInClient, WhatIsIgnoredChangesNoRow) {
  using Ours = typename TypeParam::ours;
  const auto joint = make<Ours>(*this->a, *this->b, this->frame);
  const auto twin = make<Ours>(*this->a, *this->b, this->frame);
  this->b->setCenterOfMassTransform(
      this->b->getCenterOfMassTransform() *
      btTransform(btQuaternion(vec(0, 0, 1), scalar(0.1)), vec(0.1, 0.2, 0.3)));
  const auto rows = SolverRows::ofStep(*twin);
  for (const int axis : axes)
    for (const int number : {-1, 0, 5, 99}) joint->setParam(number, scalar(0.5), axis);
  for (const int axis : {6, 7, 100}) {
    if (std::is_same_v<Ours, pintle::ConeTwistJoint>) break;  // those are all its limits'
    for (const int number : numbers) joint->setParam(number, scalar(0.5), axis);
  }
  EXPECT_EQ(SolverRows::ofStep(*joint), rows);
  if (std::is_same_v<Ours, pintle::UniversalJoint> || std::is_same_v<Ours, pintle::FixedJoint>) {
    for (const int number : numbers) joint->setParam(number, scalar(0.5));
    for (const int axis : axes) joint->setParam(BT_CONSTRAINT_ERP, scalar(0.5), axis);
    EXPECT_EQ(SolverRows::ofStep(*joint), rows);
    // As against this.
    joint->setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.5), 0);
    EXPECT_NE(SolverRows::ofStep(*joint), rows);
  }
}

TYPED_TEST(DropInClient, NanAndInfinityAreRefusedWhateverTheyAreOf) {
  if (TypeParam::derives) GTEST_SKIP() << "Bullet's own methods refuse nothing";
  using Ours = typename TypeParam::ours;
  const auto joint = make<Ours>(*this->a, *this->b, this->frame);
  const auto twin = make<Ours>(*this->a, *this->b, this->frame);
  const auto rows = SolverRows::ofStep(*twin);
  for (const btScalar value : {nan_value, infinite, -infinite}) {
    for (const int number : numbers) {
      for (const int axis : axes) {
        SCOPED_TRACE(testing::Message() << number << " = " << value << ", axis " << axis);
        const std::string said = refusal([&] { joint->setParam(number, value, axis); });
        EXPECT_NE(said.find(joint->name()), std::string::npos) << said;
        EXPECT_NE(said.find(number == BT_CONSTRAINT_ERP        ? ": ERP = "
                            : number == BT_CONSTRAINT_STOP_ERP ? ": STOP_ERP = "
                            : number == BT_CONSTRAINT_CFM      ? ": CFM = "
                            : number == BT_CONSTRAINT_STOP_CFM ? ": STOP_CFM = "
                                                               : "parameter = "),
                  std::string::npos)
            << said;
        EXPECT_NE(said.find(std::isnan(value) ? "nan" : "inf"), std::string::npos) << said;
        EXPECT_EQ(flagsOf(*joint), flagsOf(*twin));
        EXPECT_EQ(joint->getParam(number, axis), twin->getParam(number, axis));
      }
    }
  }
  EXPECT_EQ(SolverRows::ofStep(*joint), rows);
}

TEST(DropInClients, AJointWithoutACounterpartIgnoresWhatItHasNoUseFor) {
  const auto a = support::body(1, vec(1, 1, 1), btTransform::getIdentity());
  const auto b = support::body(1, vec(1, 1, 1), btTransform::getIdentity());
  pintle::DistanceJoint rod(*a, *b, vec(0, 0, 0), vec(1, 0, 0), 1);
  const auto rows = SolverRows::ofStep(rod);
  rod.setParam(99, 1);
  rod.setParam(BT_CONSTRAINT_CFM, 1, 6);
  rod.setParam(BT_CONSTRAINT_CFM, 1, -2);
  EXPECT_EQ(rod.getParam(99), 0);
  EXPECT_EQ(rod.getParam(BT_CONSTRAINT_CFM, 6), 0);
  EXPECT_EQ(SolverRows::ofStep(rod), rows);
  EXPECT_NE(refusal([&] { rod.setParam(99, nan_value); }).find("DistanceJoint"), std::string::npos);
}

// --- subclasses ----------------------------------------------------------------------------------

// As a client's: each call is counted and handed on.
template <class J>
class Counting : public J {
 public:
  using J::J;
  void buildJacobian() override {
    ++builds;
    J::buildJacobian();
  }
  void getInfo1(btTypedConstraint::btConstraintInfo1* info) override {
    ++infos_1;
    J::getInfo1(info);
  }
  void getInfo2(btTypedConstraint::btConstraintInfo2* info) override {
    ++infos_2;
    J::getInfo2(info);
  }
  void solveConstraintObsolete(btSolverBody& a, btSolverBody& b, btScalar time_step) override {
    ++solves;
    J::solveConstraintObsolete(a, b, time_step);
  }
  int builds = 0, infos_1 = 0, infos_2 = 0, solves = 0;
};

// And one that goes by the names of Bullet's internals.
template <class J>
class NonVirtual : public J {
 public:
  using J::J;
  void getInfo1(btTypedConstraint::btConstraintInfo1* info) override {
    if constexpr (is_fixed<J>)
      J::getInfo1(info);
    else
      J::getInfo1NonVirtual(info);
  }
  void getInfo2(btTypedConstraint::btConstraintInfo2* info) override {
    at(info, this->m_rbA.getCenterOfMassTransform(), this->m_rbB.getCenterOfMassTransform());
  }
  void at(btTypedConstraint::btConstraintInfo2* info, const btTransform& a, const btTransform& b) {
    const btRigidBody &body_a = this->m_rbA, &body_b = this->m_rbB;
    const btVector3 &v_a = body_a.getLinearVelocity(), &v_b = body_b.getLinearVelocity();
    const btVector3 &w_a = body_a.getAngularVelocity(), &w_b = body_b.getAngularVelocity();
    if constexpr (is_fixed<J>)
      J::getInfo2(info);  // Bullet's has none
    else if constexpr (is_ball<J>)
      J::getInfo2NonVirtual(info, a, b);
    else if constexpr (is_universal<J>)
      J::getInfo2NonVirtual(info, a, b, v_a, v_b, w_a, w_b);
    else if constexpr (is_slider<J>)
      J::getInfo2NonVirtual(info, a, b, v_a, v_b, body_a.getInvMass(), body_b.getInvMass());
    else if constexpr (std::is_base_of_v<pintle::ConeTwistJoint, J> ||
                       std::is_base_of_v<btConeTwistConstraint, J>)
      J::getInfo2NonVirtual(info, a, b, body_a.getInvInertiaTensorWorld(),
                            body_b.getInvInertiaTensorWorld());
    else
      J::getInfo2NonVirtual(info, a, b, w_a, w_b);
    if constexpr (!is_fixed<J> && !is_slider<J>) J::updateRHS(1);
  }
};

// Where a swinging body ends after a second.
template <class J, class Look>
btTransform swing(const Look& look) {
  World world;
  btRigidBody& base = world.add_box(0, vec(1, 1, 1), btTransform::getIdentity());
  btRigidBody& body = world.add_box(1, vec(0.1, 0.2, 0.3),
                                    btTransform(btQuaternion::getIdentity(), vec(0.5, 0.6, 0.7)));
  J& joint = world.take_joint(make<J>(base, body, btTransform::getIdentity()));
  body.setAngularVelocity(vec(1, 2, 3));
  for (int i = 0; i < 60; ++i) world.step(dt);
  look(joint);
  return body.getCenterOfMassTransform();
}

TYPED_TEST(DropInClient, ASubclassThatCallsItsBaseIsTheSameJoint) {
  const auto check = [](auto* type) {
    using J = std::remove_pointer_t<decltype(type)>;
    const btTransform plain = swing<J>([](J&) {});
    EXPECT_EQ(plain, swing<Counting<J>>([](Counting<J>& joint) {
                EXPECT_EQ(joint.builds, 60);
                EXPECT_EQ(joint.infos_1, 60);
                EXPECT_GE(joint.infos_2,
                          59);  // some of Bullet's have no row while they hold exactly
                // The exact solver asks no joint to solve itself.
                if (!onExactSolver()) {
                  EXPECT_GE(joint.solves, 60);
                }
              }));
    // Bullet's may announce a row more by that name.
    if constexpr (std::is_same_v<J, typename TypeParam::ours> && !TypeParam::derives)
      EXPECT_EQ(plain, swing<NonVirtual<J>>([](auto&) {}));
    else
      swing<NonVirtual<J>>([](auto&) {});
  };
  check(static_cast<typename TypeParam::ours*>(nullptr));
  check(static_cast<typename TypeParam::stock*>(nullptr));
  // By these names a class that derives from Bullet's has Bullet's rows. (On ExactJointSolver they close at a bounded speed. The
  // slider's are made of what its getInfo1NonVirtual leaves as the memory was.)
  if (TypeParam::derives && !onExactSolver() && !is_slider<typename TypeParam::ours>) {
    EXPECT_EQ(swing<NonVirtual<typename TypeParam::ours>>([](auto&) {}),
              swing<NonVirtual<typename TypeParam::stock>>([](auto&) {}));
  }
}

template <class J>
SolverRows rowsAt(NonVirtual<J>& joint, const btTransform& a, const btTransform& b) {
  struct At : btTypedConstraint {  // asks the joint there
    At(NonVirtual<J>& of, const btTransform& pose_a, const btTransform& pose_b)
        : btTypedConstraint(MAX_CONSTRAINT_TYPE, of.getRigidBodyA(), of.getRigidBodyB()),
          joint(of),
          a(pose_a),
          b(pose_b) {}
    void getInfo1(btConstraintInfo1* info) override { joint.getInfo1(info); }
    void getInfo2(btConstraintInfo2* info) override { joint.at(info, a, b); }
    void setParam(int, btScalar, int) override {}
    btScalar getParam(int, int) const override { return 0; }
    NonVirtual<J>& joint;
    const btTransform &a, &b;
  } at(joint, a, b);
  joint.buildJacobian();
  SolverRows rows;
  rows.ask(at);
  return rows;
}

// Bodies whose inertia is the same all round, so that its rows do not depend on where they stand otherwise.
TYPED_TEST(DropInClient, RowsAtOtherPosesAreThoseOfBodiesThere) {
  using J = typename TypeParam::ours;
  if constexpr (is_fixed<J> || TypeParam::derives) {
    GTEST_SKIP() << "Bullet's has no getInfo2NonVirtual, or it is Bullet's own";
  } else {
    for (const bool block : {false, true}) {
      const btTransform was_a = this->a->getCenterOfMassTransform(),
                        was_b = this->b->getCenterOfMassTransform();
      const btTransform to_a =
          was_a * btTransform(btQuaternion(vec(0, 1, 0), scalar(0.1)), vec(0.1, 0.2, 0.3));
      const btTransform to_b =
          was_b * btTransform(btQuaternion(vec(1, 0, 0), scalar(-0.2)), vec(0.3, 0.1, 0.2));
      const auto joint = make<NonVirtual<J>>(*this->a, *this->b, this->frame);
      joint->setBlockRows(block);
      const SolverRows got = rowsAt(*joint, to_a, to_b), here = rowsAt(*joint, was_a, was_b);
      EXPECT_EQ(here, SolverRows::ofStep(*joint));
      const auto moved = make<J>(*this->a, *this->b, this->frame);
      moved->setBlockRows(block);
      this->a->setCenterOfMassTransform(to_a);
      this->b->setCenterOfMassTransform(to_b);
      const SolverRows expected = SolverRows::ofStep(*moved);
      this->a->setCenterOfMassTransform(was_a);
      this->b->setCenterOfMassTransform(was_b);
      ASSERT_EQ(got.announced(), expected.announced());
      EXPECT_NE(got, here);
      for (int i = 0; i < got.announced(); ++i)
        for (int k = 0; k < 13; ++k)
          EXPECT_NEAR(got[i].fields[k], expected[i].fields[k], 100 * rounding) << i << ' ' << k;
    }
  }
}

TEST(DropInClients, ALimitThatActsElsewhereOnlyIsNotWrittenBeyondTheRowsAnnounced) {
  const auto a = support::body(0, vec(1, 1, 1), btTransform::getIdentity());
  const auto b = support::body(1, vec(1, 1, 1), btTransform::getIdentity());
  NonVirtual<pintle::UniversalJoint> universal(*a, *b, vec(0, 0, 0), vec(0, 0, 1), vec(0, 1, 0));
  universal.setLimit(5, scalar(-0.5), scalar(0.5));
  const btTransform beyond(btQuaternion(vec(0, 0, 1), 1));
  const SolverRows rows = rowsAt(universal, a->getCenterOfMassTransform(), beyond);
  const int here = rows.announced();
  EXPECT_EQ(rows.touched(), here);
  // It would have a row there.
  b->setCenterOfMassTransform(beyond);
  EXPECT_EQ(SolverRows::ofStep(universal).announced(), here + 1);
}

// --- readings at other poses ---------------------------------------------------------------------

void add(std::vector<double>& to, const btVector3& v) {
  for (int i = 0; i < 3; ++i) to.push_back(double(v[i]));
}
void add(std::vector<double>& to, const btTransform& t) {
  add(to, t.getOrigin());
  for (int i = 0; i < 3; ++i) add(to, t.getBasis()[i]);
}

// What a client looks at, having said where.
template <class J>
std::vector<double> look(J& joint, const btTransform& a, const btTransform& b) {
  std::vector<double> out;
  if constexpr (is_slider<J> || is_universal<J> || is_fixed<J>) {
    joint.calculateTransforms(a, b);
    add(out, joint.getCalculatedTransformA());
    add(out, joint.getCalculatedTransformB());
  }
  if constexpr (is_slider<J>) {
    joint.testLinLimits();
    joint.testAngLimits();
    for (const btScalar x :
         {joint.getLinearPos(), joint.getAngularPos(), joint.getLinDepth(), joint.getAngDepth(),
          btScalar(joint.getSolveLinLimit()), btScalar(joint.getSolveAngLimit())})
      out.push_back(double(x));
  } else if constexpr (is_universal<J> || is_fixed<J>) {
    for (int i = 0; i < 3; ++i) {
      // The errors that are left of Bullet's Euler angles are not a spider's.
      if (!is_universal<J> || i > 0) out.push_back(double(joint.getAngle(i)));
      out.push_back(double(joint.getRelativePivotPosition(i)));
      add(out, joint.getAxis(i));
    }
  } else if constexpr (std::is_same_v<J, pintle::ConeTwistJoint> ||
                       std::is_same_v<J, btConeTwistConstraint>) {
    joint.calcAngleInfo2(a, b, joint.getRigidBodyA().getInvInertiaTensorWorld(),
                         joint.getRigidBodyB().getInvInertiaTensorWorld());
    out = {double(joint.getTwistAngle()), double(joint.getSolveSwingLimit()),
           double(joint.getSolveTwistLimit()), double(joint.isPastSwingLimit())};
  }
  return out;
}

TYPED_TEST(DropInClient, ReadingsAtOtherPosesAreStocksAndNotLasting) {
  using Ours = typename TypeParam::ours;
  if (BT_BULLET_VERSION < 287 && std::is_same_v<Ours, pintle::ConeTwistJoint>)
    GTEST_SKIP() << "Bullet reads otherwise there";
  const auto ours = make<Ours>(*this->a, *this->b, this->frame);
  const auto stock = make<typename TypeParam::stock>(*this->a, *this->b, this->frame);
  const auto limit = [](auto& joint) {
    using J = std::decay_t<decltype(joint)>;
    if constexpr (is_slider<J>) {
      joint.setLowerLinLimit(scalar(-0.1));
      joint.setUpperLinLimit(scalar(0.1));
      joint.setLowerAngLimit(scalar(-0.05));
      joint.setUpperAngLimit(scalar(0.05));
    } else if constexpr (std::is_same_v<J, pintle::ConeTwistJoint> ||
                         std::is_same_v<J, btConeTwistConstraint>) {
      joint.setLimit(scalar(0.15), scalar(0.15), scalar(0.15));
    }
  };
  limit(*ours);
  limit(*stock);
  const btTransform joint_a = this->a->getCenterOfMassTransform() * this->frame;
  // As the joint lets it, along and about its axes: b by `angle` about x, and along it.
  const auto of_b = [&](double angle, double along) {
    const btTransform by = is_universal<Ours>
                               ? btTransform(btQuaternion(vec(0, 0, 1), scalar(-angle)) *
                                             btQuaternion(vec(0, 1, 0), scalar(angle / 2)))
                               : btTransform(btQuaternion(vec(1, 0, 0), scalar(angle)),
                                             vec(is_slider<Ours> ? along : 0, 0, 0));
    return joint_a * by * joint_a.inverse() * this->b->getCenterOfMassTransform();
  };
  const btTransform here_a = this->a->getCenterOfMassTransform(),
                    here_b = this->b->getCenterOfMassTransform();
  const auto expectStocks = [&](const btTransform& pose_b) {
    const auto expected = look(*stock, here_a, pose_b), got = look(*ours, here_a, pose_b);
    ASSERT_EQ(expected.size(), got.size());
    for (size_t i = 0; i < got.size(); ++i) EXPECT_NEAR(expected[i], got[i], 20 * rounding) << i;
  };
  if constexpr (is_ball<Ours> || std::is_same_v<Ours, pintle::QuaternionHinge>) {
    GTEST_SKIP() << "Bullet's has none";
  } else {
    for (const double angle : {0.04, 0.2, -0.3}) {
      for (const double along : {0.05, 0.25, -0.4}) {
        SCOPED_TRACE(testing::Message() << angle << ", " << along);
        expectStocks(of_b(angle, along));
      }
    }
    const auto now = look(*ours, here_a, here_b);
    const auto there = look(*ours, here_a, of_b(0.2, 0.25));
    EXPECT_NE(now, there);
    // Until the next step: the same questions, but for where.
    const auto asked = [&] {
      if constexpr (std::is_same_v<Ours, pintle::ConeTwistJoint>)
        return double(ours->getTwistAngle());
      else if constexpr (is_slider<Ours>)
        return double(ours->getLinearPos());
      else
        return double(ours->getAngle(is_universal<Ours> ? 2 : 0));
    };
    EXPECT_GT(std::abs(asked()), 0.1);
    SolverRows::ofStep(*ours);
    EXPECT_NEAR(asked(), 0, 100 * rounding);
    // Or new frames.
    look(*ours, here_a, of_b(0.2, 0.25));
    EXPECT_GT(std::abs(asked()), 0.1);
    const btTransform frame_a = ours->getFrameOffsetA(), frame_b = ours->getFrameOffsetB();
    ours->setFrames(frame_a, frame_b);
    EXPECT_NEAR(asked(), 0, 100 * rounding);
  }
}

TEST(DropInClients, CalcAngleInfoAndCalculateTransformsGoBackToWhereTheBodiesAre) {
  const auto a = support::body(1, vec(1, 1, 1), btTransform::getIdentity());
  const auto b = support::body(1, vec(1, 1, 1), btTransform::getIdentity());
  const btTransform frame = btTransform::getIdentity();
  const btTransform turned(btQuaternion(vec(1, 0, 0), scalar(0.25)));
  const btMatrix3x3& I = a->getInvInertiaTensorWorld();
  pintle::ConeTwistJoint cone(*a, *b, frame, frame);
  cone.calcAngleInfo2(turned, frame, I, I);
  EXPECT_NEAR(cone.getTwistAngle(), 0.25, 10 * rounding);
  cone.calcAngleInfo();
  EXPECT_EQ(cone.getTwistAngle(), 0);
  pintle::FixedJoint fixed(*a, *b, frame, frame);
  fixed.calculateTransforms(frame, turned);
  EXPECT_NEAR(std::abs(fixed.getAngle(0)), 0.25, 10 * rounding);
  fixed.calculateTransforms();
  EXPECT_EQ(fixed.getAngle(0), 0);
  pintle::UniversalJoint universal(*a, *b, frame, frame);
  universal.calculateTransforms(btTransform(btQuaternion(vec(0, 0, 1), scalar(0.25))), frame);
  EXPECT_NEAR(universal.getAngle1(), 0.25, 10 * rounding);
  universal.calculateTransforms();
  EXPECT_EQ(universal.getAngle1(), 0);
}

// --- limits of axes that are held ----------------------------------------------------------------

template <class J>
void expectHeld() {
  const auto a = support::body(1, vec(1, 1, 1), btTransform::getIdentity());
  const auto b = support::body(1, vec(1, 1, 1), btTransform::getIdentity());
  J joint(*a, *b, btTransform::getIdentity(), btTransform::getIdentity());
  const btVector3 zero(0, 0, 0);
  joint.setLinearLowerLimit(zero);
  joint.setLinearUpperLimit(zero);
  for (int axis = 0; axis < 4; ++axis) joint.setLimit(axis, 0, 0);
  for (const btScalar bad : {scalar(0.5), nan_value}) {
    for (int i = 0; i < 3; ++i) {
      btVector3 limit = zero;
      limit[i] = bad;
      const std::string low = refusal([&] { joint.setLinearLowerLimit(limit); });
      EXPECT_NE(low.find(joint.name() + std::string(": linear lower limit = ")), std::string::npos)
          << low;
      const std::string high = refusal([&] { joint.setLinearUpperLimit(limit); });
      EXPECT_NE(high.find("linear upper limit = "), std::string::npos) << high;
      EXPECT_NE(refusal([&] { joint.setLimit(i, bad, 0); }).find("lower limit"), std::string::npos);
      EXPECT_NE(refusal([&] { joint.setLimit(i, 0, bad); }).find("upper limit"), std::string::npos);
    }
  }
  btVector3 low(1, 1, 1), high(1, 1, 1);
  joint.getLinearLowerLimit(low);
  joint.getLinearUpperLimit(high);
  EXPECT_EQ(low, zero);
  EXPECT_EQ(high, zero);
}

TEST(DropInClients, LimitsOfHeldAxesAreZeroAndNothingElse) {
  expectHeld<pintle::UniversalJoint>();
  expectHeld<pintle::FixedJoint>();
  const auto a = support::body(1, vec(1, 1, 1), btTransform::getIdentity());
  pintle::FixedJoint fixed(*a, btTransform::getIdentity());
  fixed.setAngularLowerLimit(vec(0, 0, 0));
  fixed.setAngularUpperLimit(vec(0, 0, 0));
  EXPECT_NE(refusal([&] { fixed.setAngularLowerLimit(vec(0, 0, -1)); }).find("angular lower"),
            std::string::npos);
  EXPECT_NE(refusal([&] { fixed.setAngularUpperLimit(vec(0, 1, 0)); }).find("angular upper"),
            std::string::npos);
  EXPECT_NE(refusal([&] { fixed.setLimit(6, 0, 0); }).find("axis = 6"), std::string::npos);
}

// --- limits and motors of the universal joint ----------------------------------------------------

struct Shaft {
  World world{0};
  btRigidBody& base = world.add_box(0, vec(0.1, 0.1, 0.1), btTransform::getIdentity());
  btRigidBody& body = world.add_box(1, vec(0.1, 0.1, 0.1), btTransform::getIdentity());

  template <class J>
  J& joint() {
    return world.add_joint<J>(body, base, vec(0, 0, 0), vec(0, 0, 1), vec(0, 1, 0));
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) world.step(dt);
  }
};

TEST(LimitMotor, DrivesAndStopsAsStocksDoes) {
  if (BT_BULLET_VERSION < 289) GTEST_SKIP() << "there a bound of a motor is an impulse in a step";
  const auto drive = [](auto* type, int index, double velocity) {
    using J = std::remove_pointer_t<decltype(type)>;
    Shaft shaft;
    J& joint = shaft.joint<J>();
    btRotationalLimitMotor* const motor = joint.getRotationalLimitMotor(index);
    EXPECT_EQ(motor->m_maxMotorForce, 6);
    EXPECT_FALSE(motor->m_enableMotor);
    motor->m_enableMotor = true;
    motor->m_targetVelocity = scalar(velocity);
    motor->m_maxMotorForce = scalar(0.05);
    std::vector<double> angles;
    for (int i = 0; i < 20; ++i) {
      shaft.run(1);
      joint.calculateTransforms();
      angles.push_back(double(joint.getAngle(index)));
    }
    // Onto its limit, by fields that are written while it runs.
    motor->m_maxMotorForce = 10;
    motor->m_loLimit = scalar(-0.75);
    motor->m_hiLimit = scalar(0.75);
    shaft.run(120);
    joint.calculateTransforms();
    EXPECT_NEAR(joint.getAngle(index), std::copysign(0.75, velocity), 0.01);
    angles.push_back(double(joint.getAngle(index)));
    EXPECT_NEAR(motor->m_currentPosition, joint.getAngle(index), 0.01);
    return angles;
  };
  for (const int index : {1, 2}) {
    for (const double velocity : {1., -1.}) {
      SCOPED_TRACE(testing::Message() << index << ", " << velocity);
      const auto stock = drive(static_cast<btUniversalConstraint*>(nullptr), index, velocity);
      const auto ours = drive(static_cast<pintle::UniversalJoint*>(nullptr), index, velocity);
      for (size_t i = 0; i < 20; ++i) EXPECT_NEAR(stock[i], ours[i], 1e-4) << i;
    }
  }
}

TEST(LimitMotor, FieldsAndSettersAreOne) {
  Shaft shaft;
  auto& joint = shaft.joint<pintle::UniversalJoint>();
  joint.enableMotor(5, true, 3, 4);
  joint.setLimit(5, -7, 8);
  joint.setLimitBounce(5, scalar(0.25));
  btRotationalLimitMotor* const motor = joint.getRotationalLimitMotor(2);
  EXPECT_TRUE(motor->m_enableMotor);
  EXPECT_EQ(motor->m_targetVelocity, 3);
  EXPECT_EQ(motor->m_maxMotorForce, 4);
  EXPECT_EQ(motor->m_loLimit, -7);
  EXPECT_EQ(motor->m_hiLimit, 8);
  EXPECT_EQ(motor->m_bounce, scalar(0.25));
  // Setters show in the fields,
  joint.setLimit(5, -1, 2);
  joint.enableMotor(5, false);
  EXPECT_EQ(motor->m_loLimit, -1);
  EXPECT_EQ(motor->m_hiLimit, 2);
  EXPECT_FALSE(motor->m_enableMotor);
  // and fields in the getters,
  motor->m_loLimit = scalar(-0.5);
  EXPECT_EQ(joint.getLowerLimit(5), scalar(-0.5));
  btVector3 low;
  joint.getAngularLowerLimit(low);
  EXPECT_EQ(low, vec(0, -(scenes::pi / 2 - 0.01), -0.5));
  motor->m_hiLimit = -1;
  EXPECT_FALSE(joint.isLimited(5));
  // of which the last one called counts, and leaves the others.
  motor->m_targetVelocity = 5;
  joint.setLimit(5, -2, 2);
  EXPECT_EQ(motor->m_loLimit, -2);
  EXPECT_EQ(motor->m_targetVelocity, 5);
  joint.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.1), 0);
  EXPECT_EQ(motor->m_targetVelocity, 5);
  EXPECT_EQ(motor, joint.getRotationalLimitMotor(2));
  EXPECT_EQ(joint.getRotationalLimitMotor(1)->m_maxMotorForce, 6);
  EXPECT_NE(refusal([&] { joint.getRotationalLimitMotor(3); }).find("index = 3"),
            std::string::npos);
  EXPECT_NE(refusal([&] { joint.getRotationalLimitMotor(-1); }).find("index = -1"),
            std::string::npos);
}

TEST(LimitMotor, ParametersCountOnceTheyWereSetAsInBullet) {
  const auto a = support::body(0, vec(1, 1, 1), btTransform::getIdentity());
  const auto b = support::body(1, vec(1, 1, 1), btTransform::getIdentity());
  const auto rows = [&](auto change) {
    pintle::UniversalJoint joint(*b, *a, btTransform::getIdentity(), btTransform::getIdentity());
    joint.setLimit(5, scalar(0.5), 1);
    change(joint, *joint.getRotationalLimitMotor(2));
    return SolverRows::ofStep(joint);
  };
  using J = pintle::UniversalJoint;
  using M = btRotationalLimitMotor;
  const auto plain = rows([](J&, M&) {});
  EXPECT_EQ(plain, rows([](J&, M& motor) { motor.m_stopERP = scalar(0.7); }));
  const auto set =
      rows([](J& joint, M&) { joint.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.7), 5); });
  EXPECT_NE(plain, set);
  EXPECT_EQ(set, rows([](J& joint, M& motor) {
              joint.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.3), 5);
              EXPECT_EQ(motor.m_stopERP, scalar(0.3));
              motor.m_stopERP = scalar(0.7);
            }));
}

TEST(LimitMotor, WhatIsNoSettingGoesBackToWhatItWas) {
  for (const btScalar bad : {nan_value, infinite, -infinite}) {
    SCOPED_TRACE(bad);
    Shaft shaft, twin;
    auto& joint = shaft.joint<pintle::UniversalJoint>();
    auto& other = twin.joint<pintle::UniversalJoint>();
    for (auto* each : {&joint, &other}) each->enableMotor(5, true, 1, 1);
    btRotationalLimitMotor& motor = *joint.getRotationalLimitMotor(2);
    motor.m_targetVelocity = motor.m_bounce = bad;
    if (!(bad > 0)) motor.m_maxMotorForce = bad;
    motor.m_loLimit = motor.m_hiLimit = bad;
    shaft.run(30);
    twin.run(30);
    EXPECT_EQ(shaft.body.getCenterOfMassTransform(), twin.body.getCenterOfMassTransform());
    EXPECT_EQ(motor.m_targetVelocity, 1);
    EXPECT_EQ(motor.m_maxMotorForce, 1);
    EXPECT_EQ(motor.m_bounce, 0);
    EXPECT_EQ(motor.m_loLimit, joint.getLowerLimit(5));
    EXPECT_NEAR(motor.m_loLimit, -(scenes::pi - 0.01), 1e-5);
  }
}

TEST(LimitMotor, OfTheHeldAxisStaysHeld) {
  Shaft shaft;
  auto& joint = shaft.joint<pintle::UniversalJoint>();
  btRotationalLimitMotor& motor = *joint.getRotationalLimitMotor(0);
  motor.m_loLimit = -1;
  motor.m_hiLimit = 1;
  motor.m_enableMotor = true;
  motor.m_targetVelocity = 3;
  shaft.run(30);
  EXPECT_NEAR(joint.getAngle(0), 0, 1e-5);
  EXPECT_EQ(motor.m_loLimit, 0);
  EXPECT_EQ(motor.m_hiLimit, 0);
  EXPECT_FALSE(motor.m_enableMotor);
}

TEST(LimitMotor, TestAngularLimitMotorLooksNow) {
  Shaft shaft;
  const auto check = [&](auto& joint) {
    btRotationalLimitMotor& motor = *joint.getRotationalLimitMotor(2);
    joint.setLimit(5, scalar(-0.5), scalar(0.5));
    joint.calculateTransforms(btTransform(btQuaternion(vec(0, 0, 1), scalar(0.75))),
                              btTransform::getIdentity());
    EXPECT_TRUE(joint.testAngularLimitMotor(2));
    EXPECT_EQ(motor.m_currentLimit, 2);
    EXPECT_NEAR(motor.m_currentPosition, 0.75, 10 * rounding);
    EXPECT_NEAR(motor.m_currentLimitError, 0.25, 10 * rounding);
    joint.calculateTransforms();
    EXPECT_FALSE(joint.testAngularLimitMotor(2));
    EXPECT_EQ(motor.m_currentLimit, 0);
    motor.m_enableMotor = true;
    EXPECT_TRUE(joint.testAngularLimitMotor(2));
  };
  check(shaft.joint<btUniversalConstraint>());
  check(shaft.joint<pintle::UniversalJoint>());
}

}  // namespace drop_in_clients_test
