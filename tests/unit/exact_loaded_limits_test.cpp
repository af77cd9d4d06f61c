// Limits bear loads of a thousand times and more of what they hold, on the exact solver: wedges that their own motors push against
// them, and stock hinges, sliders and cones that rest on theirs.
#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <gtest/gtest.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/distance_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/wedge_joint.h>
#include <pintle/solver/solver_options.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>
#include <vector>

#include "books.h"
#include "physics_support.h"
#include "support.h"

namespace exact_loaded_limits_test {
namespace {

using physics::rounding;
using support::Books;
using support::scalar;
using support::vec;

constexpr double gravity = 9.81;

/// A level arm of 1 m and 1 kg on what `join` makes of it and a post, and a load that hangs from its end by a ball.
struct Arm {
  Arm(double hz, double load) : books(hz), of_a_step(load * std::pow(gravity / hz, 2) / 2) {
    hung = &books.add(load, vec(0.2, 0.2, 0.2), vec(1, 0, -0.5));
    books.join(std::make_unique<pintle::BallJoint>(body, *hung, vec(0.5, 0, 0), vec(0, 0, 0.5)));
  }
  btVector3 along() const { return body.getCenterOfMassTransform().getBasis().getColumn(0); }

  /// A hundredth of the largest kinetic energy, or of what the load gets when it falls for a step.
  void expectNoGain() const { EXPECT_LE(books.gain, 0.01 * std::max(books.peak, of_a_step)); }

  Books books;
  double of_a_step;  ///< J
  btRigidBody& post = books.add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
  btRigidBody& body = books.add(1, vec(0.5, 0.05, 0.05), vec(0.5, 0, 0));
  btRigidBody* hung;
};

// --- wedges --------------------------------------------------------------------------------------

enum class Drive { none, motor, servo, friction };

struct DrivenWedge {
  Drive drive;
  double part;  ///< of what holds the load
  int way;      ///< +1: down, into the limit, -1: up
};
std::ostream& operator<<(std::ostream& out, const DrivenWedge& of) {
  return out << int(of.drive) << ", " << of.part << " of the load, " << of.way;
}

// The row of the plane that it rests on also has what drives it, and both stops of the angle; that of the other plane has one. The arm
// leans towards the wedge's axis, which has both rows act in a narrow wedge. What pushes it into the limit does no work, and what
// pulls it out is too weak.
TEST(DrivenWedges, RestOnTheirLimits) {
  std::vector<DrivenWedge> cases = {{Drive::none, 0, 1}};
  for (const Drive drive : {Drive::motor, Drive::servo, Drive::friction})
    for (const DrivenWedge& of : {DrivenWedge{drive, 0.6, 1}, DrivenWedge{drive, 0.6, -1},
                                  DrivenWedge{drive, 1.5, 1}, DrivenWedge{drive, 10, 1}})
      cases.push_back(of);
  for (const DrivenWedge& of : cases)
    for (const double width : {0.01, 1., 3., 6.})
      for (const double load : {20., 1e3})
        for (const double hz : {60., 240.})
          for (const double lean : {0., 0.5}) {
            SCOPED_TRACE(testing::Message() << of << ", " << width << " rad, " << load << " kg, "
                                            << hz << " Hz, " << lean << " rad/s");
            Arm arm(hz, load);
            auto made = std::make_unique<pintle::WedgeJoint>(arm.post, arm.body, vec(0, 0, 0),
                                                             vec(-0.5, 0, 0), vec(1, 0, 0),
                                                             vec(1, 0, 0), vec(0, 1, 0));
            pintle::WedgeJoint& joint = *made;
            joint.setLimit(scalar(-width), 0);
            const double torque = of.part * gravity * (load + 0.5);
            switch (of.drive) {
              case Drive::none: break;
              case Drive::motor:
                joint.enableAngularMotor(true, scalar(2 * of.way), scalar(torque / hz));
                break;
              case Drive::servo: joint.setMotorServo(scalar(of.way), 2, 1, scalar(torque)); break;
              case Drive::friction: joint.setFriction(scalar(torque)); break;
            }
            arm.books.join(std::move(made));
            arm.body.setAngularVelocity(vec(0, 0, lean));
            arm.body.setLinearVelocity(vec(0, lean / 2, 0));
            arm.hung->setLinearVelocity(vec(0, lean, 0));
            arm.books.begin();
            const double most = rounding(2e-5, 1e-6);
            for (int i = 0; i < 2 * int(hz); ++i) {
              arm.books.step();
              // As a turn to the plane, whose angle is ever larger as the arm leans.
              const btVector3 c_b = arm.along();
              ASSERT_LE(-double(c_b.z()), most) << i;
              ASSERT_TRUE(double(joint.getAngle()) > -1e-3) << i << ": it stays on it";
            }
            arm.expectNoGain();
          }
}

// --- stock joints --------------------------------------------------------------------------------

/// What a load does to a stock joint's limit, from which it starts, or before which it falls.
struct Passed {
  double most = 0;     ///< m or rad: beyond the limit
  double at_rest = 0;  ///< the same, after 4 s
  double a_step = 0;   ///< m or rad: by which it goes on in a step, at the most
};

/// `beyond`: of the limit, m or rad.
template <class Beyond>
Passed rest(Arm& arm, double hz, Beyond beyond) {
  Passed passed;
  arm.books.begin();
  double last = beyond();
  for (int i = 0; i < 5 * int(hz); ++i) {
    arm.books.step();
    const double now = beyond();
    passed.most = std::max(passed.most, now);
    passed.a_step = std::max(passed.a_step, now - last);
    if (i >= 4 * int(hz)) passed.at_rest = std::max(passed.at_rest, now);
    last = now;
  }
  arm.expectNoGain();
  return passed;
}

// Their rows are there from when the limit is passed: by one step of what they have fallen, whatever the load. Then a part of what is
// more than the tolerance is closed in each step, of hinges and sliders the least one: 0.2 of Bullet's ERP by 0.3 of the limit's.
void expectHeld(const Passed& passed,
                double at_rest = 3 * pintle::SolverOptions().loose_pose_tolerance / (0.2 * 0.3)) {
  EXPECT_LE(passed.most, 1.01 * passed.a_step);
  EXPECT_LE(passed.at_rest, at_rest);
}

class StockLimits : public testing::TestWithParam<double> {
 protected:
  template <class Test>
  void forAll(Test test) {
    for (const double load : {20., 1e3, 1e5})
      for (const double hz : {60., 240.}) {
        SCOPED_TRACE(testing::Message() << load << " kg, " << hz << " Hz");
        test(load, hz);
      }
  }
  /// m or rad: of the limit, from where it starts.
  double far() const { return GetParam(); }
};

TEST_P(StockLimits, OfHingesBear) {
  forAll([this](double load, double hz) {
    Arm arm(hz, load);
    const btVector3 y = vec(0, 1, 0);
    auto made = std::make_unique<btHingeConstraint>(arm.post, arm.body, vec(0, 0, 0),
                                                    vec(-0.5, 0, 0), y, y);
    btHingeConstraint& hinge = *made;
    arm.books.join(std::move(made));
    const double start = double(hinge.getHingeAngle());
    const btTransform down(btQuaternion(y, scalar(0.1)));
    const double way =
        double(hinge.getHingeAngle(btTransform::getIdentity(), down)) > start ? 1 : -1;
    const double stop = start + way * far(), other = start - way;
    hinge.setLimit(scalar(std::min(stop, other)), scalar(std::max(stop, other)));
    expectHeld(rest(arm, hz, [&] { return way * (double(hinge.getHingeAngle()) - stop); }));
  });
}

TEST_P(StockLimits, OfSlidersBear) {
  forAll([this](double load, double hz) {
    Arm arm(hz, load);
    const btTransform rail(btQuaternion(vec(0, 1, 0), SIMD_HALF_PI), vec(0.5, 0, 0)),
        in_body(rail.getRotation());
    auto made = std::make_unique<btSliderConstraint>(arm.post, arm.body, rail, in_body, true);
    made->setLowerLinLimit(-1);
    made->setUpperLinLimit(scalar(far()));
    made->setLowerAngLimit(0);
    made->setUpperAngLimit(0);
    arm.books.join(std::move(made));
    expectHeld(
        rest(arm, hz, [&] { return -double(arm.body.getCenterOfMassPosition().z()) - far(); }));
  });
}

TEST_P(StockLimits, OfConesBear) {
  forAll([this](double load, double hz) {
    Arm arm(hz, load);
    auto made = std::make_unique<btConeTwistConstraint>(
        arm.post, arm.body, btTransform(btQuaternion::getIdentity(), vec(0, 0, 0)),
        btTransform(btQuaternion::getIdentity(), vec(-0.5, 0, 0)));
    const double cone = 0.1 + far();
    made->setLimit(scalar(cone), scalar(cone), scalar(0.2));
    arm.books.join(std::move(made));
    const Passed passed = rest(arm, hz, [&] {
      const btVector3 x = arm.along();
      return std::atan2(std::hypot(double(x.y()), double(x.z())), double(x.x())) - cone;
    });
    // In single precision the arm slides along the rim.
    expectHeld(passed, rounding(5e-4, 2e-6));
  });
}

INSTANTIATE_TEST_SUITE_P(AtOnceAndFarther, StockLimits, testing::Values(0., 0.3));

// --- shelves -------------------------------------------------------------------------------------

/// Boxes of 8 kg on a shelf of 4 kg that a hinge's limit holds level. Returns how far the one that has fallen farthest is below its place after 10 s, m.
double fallOfStack(int boxes, double hz, bool is_ours) {
  constexpr double half = 0.2, top = 0.05;
  Books books(hz);
  btRigidBody& wall = books.add(0, vec(0.1, 1, 1), vec(-0.7, 0, -2));
  btRigidBody& shelf = books.add(4, vec(0.5, 0.5, top), vec(0, 0, 0), true);
  const auto placeOf = [](int i) { return vec(0.1, 0, top + half + 2 * half * i); };
  std::vector<btRigidBody*> stack;
  for (int i = 0; i < boxes; ++i)
    stack.push_back(&books.add(8, vec(half, half, half), placeOf(i), true));
  const btVector3 on_wall = vec(0.2, 0, 2), on_shelf = vec(-0.5, 0, 0), axis = vec(0, 1, 0);
  const auto hang = [&](auto hinge) {
    hinge->setLimit(0, scalar(1.5));
    books.join(std::move(hinge));
  };
  if (is_ours)
    hang(std::make_unique<pintle::QuaternionHinge>(wall, shelf, on_wall, on_shelf, axis, axis));
  else
    hang(std::make_unique<btHingeConstraint>(wall, shelf, on_wall, on_shelf, axis, axis));
  for (int i = 0; i < 10 * hz; ++i) books.step();
  double most = 0;
  for (int i = 0; i < boxes; ++i)
    most = std::max(most,
                    double(placeOf(i).z() - stack[size_t(i)]->getWorldTransform().getOrigin().z()));
  return most;
}

// With a row of the passes for the limit, of 10 iterations, six boxes fall after 2 s.
TEST(LoadedShelves, StandUnderAStack) {
  for (const bool is_ours : {true, false})
    for (const double hz : {60., 240.})
      for (const int boxes : {3, 6})
        EXPECT_LT(fallOfStack(boxes, hz, is_ours), 0.05)
            << boxes << " boxes, " << hz << " Hz, "
            << (is_ours ? "QuaternionHinge" : "btHingeConstraint");
}

// --- limits that repeat each other ---------------------------------------------------------------

/// m/s: the fastest that a box on a plate moves after 1.5 s, which hangs from four ropes: three would do.
double restOnFourRopes(double hz, int iterations) {
  Books books(hz);
  books.world.getSolverInfo().m_numIterations = iterations;
  btRigidBody &top = books.add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 3)),
              &plate = books.add(5, vec(0.6, 0.6, 0.05), vec(0, 0, 0), true),
              &box = books.add(4, vec(0.15, 0.15, 0.15), vec(0, 0, 0.2), true);
  for (int i = 0; i < 4; ++i) {
    const btVector3 corner = vec(i & 1 ? 0.55 : -0.55, i & 2 ? 0.55 : -0.55, 0);
    auto rope = std::make_unique<pintle::DistanceJoint>(top, plate, corner,
                                                        corner + vec(0, 0, 0.05), scalar(2.95));
    rope->setLimit(0, scalar(2.95));
    books.join(std::move(rope));
  }
  double most = 0;
  for (int i = 0; i < 5 * hz; ++i) {
    books.step();
    if (i > 1.5 * hz) most = std::max(most, double(box.getLinearVelocity().length()));
  }
  return most;
}

// The fourth rope begins a step without an impulse, and the others hold it: if one that says nothing were found for it in the passes, good
// ones would be let go, and the box would fall for a step, at g dt.
TEST(RedundantLimits, LeaveALoadAtRest) {
  for (const double hz : {120., 240., 480.})
    for (const int iterations : {1, 4, 10})
      EXPECT_LT(restOnFourRopes(hz, iterations), gravity / hz / 10)
          << hz << " Hz, " << iterations << " iterations";
}

}  // namespace
}  // namespace exact_loaded_limits_test
