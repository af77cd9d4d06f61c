// Bodies at rest: the joint's feedback balances their weight, as a force and as a torque, and is
// the same as that of Bullet's own joint in the same scene.
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <pintle/joints/ball_joint.h>

#include <memory>
#include <vector>

#include "physics_support.h"

namespace physics_statics_test {

using Eigen::Vector3d;
using physics::vector;

constexpr double dt = 1.0 / 60;
constexpr double g = scenes::standard_gravity;
constexpr double mass = 5;           // kg
constexpr double weight = mass * g;  // N
// Relative. In a resting state a solver repeats its rounding; what is left is that it corrects the
// drift of the pose, of which erp = 0.2 goes back a step.
const double tolerance = physics::rounding(2e-4, 1e-9);
// A limit of stock takes 6 % of its error back a step: after 120 steps 0.94^120 = 6e-4 of what it
// fell by in the first one is left to correct. (Much later rounding makes it let go, and fall
// again.)
const double limit_tolerance = physics::rounding(2e-4, 1e-5);

// What a joint does to its two bodies: N, and N m about each centre of mass.
struct Feedback {
  Vector3d force_a, torque_a, force_b, torque_b;
};

class Statics {
 public:
  Statics() : world_(g, 50) {}

  scenes::World& world() { return world_; }

  void watch(btTypedConstraint& joint) {
    joint.enableFeedback(true);
    feedback_.push_back(std::make_unique<btJointFeedback>());
    joint.setJointFeedback(feedback_.back().get());
  }

  // After two seconds.
  std::vector<Feedback> rest() {
    for (int step = 0; step < 120; ++step) world_.step(dt);
    std::vector<Feedback> result;
    for (const auto& f : feedback_) {
      result.push_back(
          {scenes::to_eigen(f->m_appliedForceBodyA), scenes::to_eigen(f->m_appliedTorqueBodyA),
           scenes::to_eigen(f->m_appliedForceBodyB), scenes::to_eigen(f->m_appliedTorqueBodyB)});
    }
    return result;
  }

 private:
  scenes::World world_;
  std::vector<std::unique_ptr<btJointFeedback>> feedback_;
};

void expect_near(const Vector3d& is, const Vector3d& expected, double error, const char* what) {
  EXPECT_LT((is - expected).norm(), error)
      << what << " is " << is.transpose() << ", expected " << expected.transpose();
}

// a carries `force_a` at rest, `torque_a` about its centre; b gets the opposite, about its own.
void expect_balance(const Feedback& f, const Vector3d& x_a, const Vector3d& x_b,
                    const Vector3d& force_a, const Vector3d& torque_a) {
  expect_near(f.force_a, force_a, tolerance * weight, "force on a");
  expect_near(f.torque_a, torque_a, tolerance * weight, "torque on a");
  expect_near(f.force_b, -force_a, tolerance * weight, "force on b");
  expect_near(f.torque_b, -torque_a - (x_a - x_b).cross(force_a), tolerance * weight,
              "torque on b");
}

void expect_equal(const Feedback& f, const Feedback& other, double error = tolerance) {
  expect_near(f.force_a, other.force_a, error * weight, "force on a");
  expect_near(f.torque_a, other.torque_a, error * weight, "torque on a");
  expect_near(f.force_b, other.force_b, error * weight, "force on b");
  expect_near(f.torque_b, other.torque_b, error * weight, "torque on b");
}

void set_block(btTypedConstraint& joint, bool block) {
  if (auto* const ours = dynamic_cast<pintle::Joint*>(&joint)) ours->setBlockRows(block);
  // With its frame offset on, stock's hinge reports a torque on a static body that is not about that
  // body's centre.
  else if (auto* const hinge = dynamic_cast<btHingeConstraint*>(&joint))
    hinge->setUseFrameOffset(false);
}

// A post to hold on to: its centre is far from the joint, so that torques about it tell levers.
const Vector3d post_centre(-1, 0.7, 0.4);
btRigidBody& add_post(Statics& statics) {
  return statics.world().add_box(0, vector(0.1, 0.1, 0.1),
                                 scenes::pose_at(scenes::to_bullet(post_centre)));
}

// A door whose centre is 0.45 m from its vertical hinge.
template <class Hinge>
Feedback door(bool block) {
  Statics statics;
  btRigidBody& post = add_post(statics);
  btRigidBody& panel =
      statics.world().add_box(mass, vector(0.45, 0.02, 1), scenes::pose_at(vector(0.45, 0, 0)));
  Hinge& hinge = statics.world().add_joint<Hinge>(panel, post, scenes::pose_at(vector(-0.45, 0, 0)),
                                                  scenes::pose_at(scenes::to_bullet(-post_centre)));
  set_block(hinge, block);
  statics.watch(hinge);
  return statics.rest()[0];
}

TEST(Statics, DoorHangsOnItsVerticalHinge) {
  const Feedback stock = door<btHingeConstraint>(true);
  for (const bool block : {true, false}) {
    SCOPED_TRACE(block ? "block rows" : "plain rows");
    const Feedback ours = door<pintle::QuaternionHinge>(block);
    // At rest nothing turns the door about its centre.
    expect_balance(ours, {0.45, 0, 0}, post_centre, {0, 0, weight}, {0, 0, 0});
    expect_equal(ours, stock);
  }
}

// A beam held out by its end, against a stop of the level hinge about y.
struct HeldBeam {
  Feedback feedback;
  double limit_torque = 0;  // N m, along the hinge angle
  double applied_impulse = 0;
};

template <class Hinge>
HeldBeam beam(bool block, bool reference_a, bool beam_is_b, double relaxation = 1) {
  Statics statics;
  btRigidBody& post = add_post(statics);
  btRigidBody& held =
      statics.world().add_box(mass, vector(0.5, 0.1, 0.1), scenes::pose_at(vector(0.5, 0, 0)));
  // z of the joint frames is the world's y.
  const btMatrix3x3 axes(1, 0, 0, 0, 0, 1, 0, -1, 0);
  const btTransform in_beam(axes, vector(-0.5, 0, 0));
  const btTransform in_post(axes, scenes::to_bullet(-post_centre));
  Hinge& hinge = beam_is_b
                     ? statics.world().add_joint<Hinge>(post, held, in_post, in_beam, reference_a)
                     : statics.world().add_joint<Hinge>(held, post, in_beam, in_post, reference_a);
  // Gravity turns the beam about +y.
  const bool angle_falls = beam_is_b != reference_a;
  hinge.setLimit(btScalar(angle_falls ? 0 : -0.5), btScalar(angle_falls ? 0.5 : 0), btScalar(0.9),
                 btScalar(0.3), btScalar(relaxation));
  set_block(hinge, block);
  statics.watch(hinge);
  HeldBeam result;
  result.feedback = statics.rest()[0];
  if constexpr (std::is_same_v<Hinge, pintle::QuaternionHinge>) {
    result.limit_torque = double(hinge.getLimitImpulse()) / dt;
  }
  result.applied_impulse = double(hinge.getAppliedImpulse());
  return result;
}

class HeldBeamTest : public testing::TestWithParam<std::tuple<bool, bool>> {};

TEST_P(HeldBeamTest, IsBalancedByTheLimit) {
  const auto [reference_a, beam_is_b] = GetParam();
  // Without rebound: with it, stock never comes to rest on its limit.
  const HeldBeam stock = beam<btHingeConstraint>(true, reference_a, beam_is_b, 0);
  for (const bool block : {true, false}) {
    SCOPED_TRACE(block ? "block rows" : "plain rows");
    const HeldBeam ours = beam<pintle::QuaternionHinge>(block, reference_a, beam_is_b);
    const Vector3d up(0, 0, weight);
    if (beam_is_b) {
      expect_balance(ours.feedback, post_centre, {0.5, 0, 0}, -up,
                     (Vector3d(0.5, 0, 0) - post_centre).cross(-up));
    } else {
      expect_balance(ours.feedback, {0.5, 0, 0}, post_centre, up, {0, 0, 0});
    }
    expect_equal(ours.feedback, stock.feedback, limit_tolerance);
    const double lever = 0.5, angle_falls = beam_is_b != reference_a ? 1 : -1;
    EXPECT_NEAR(ours.limit_torque, angle_falls * weight * lever, tolerance * weight);
    EXPECT_NEAR(ours.applied_impulse, stock.applied_impulse, limit_tolerance * weight * dt);
  }
}

INSTANTIATE_TEST_SUITE_P(ReferenceAAndBeamIsB, HeldBeamTest,
                         testing::Combine(testing::Bool(), testing::Bool()));

// A cube that hangs straight below its ball.
template <class Ball>
Feedback hanging(bool block) {
  Statics statics;
  btRigidBody& post = add_post(statics);
  btRigidBody& cube =
      statics.world().add_box(mass, vector(0.2, 0.2, 0.2), scenes::pose_at(vector(0, 0, -0.6)));
  Ball& ball = statics.world().add_joint<Ball>(cube, post, vector(0, 0, 0.6),
                                               scenes::to_bullet(-post_centre));
  set_block(ball, block);
  statics.watch(ball);
  return statics.rest()[0];
}

TEST(Statics, CubeHangsOnABall) {
  const Feedback stock = hanging<btPoint2PointConstraint>(true);
  for (const bool block : {true, false}) {
    SCOPED_TRACE(block ? "block rows" : "plain rows");
    const Feedback ours = hanging<pintle::BallJoint>(block);
    expect_balance(ours, {0, 0, -0.6}, post_centre, {0, 0, weight}, {0, 0, 0});
    expect_equal(ours, stock);
  }
}

// A plank on two balls, at 0.3 m and 0.6 m from its centre: the lever rule.
template <class Ball>
std::vector<Feedback> plank(bool block) {
  Statics statics;
  btRigidBody& post = add_post(statics);
  btRigidBody& held =
      statics.world().add_box(mass, vector(0.8, 0.1, 0.1), btTransform::getIdentity());
  for (const double x : {-0.3, 0.6}) {
    Ball& ball = statics.world().add_joint<Ball>(
        held, post, vector(x, 0, 0), scenes::to_bullet(Vector3d(x, 0, 0) - post_centre));
    set_block(ball, block);
    statics.watch(ball);
  }
  return statics.rest();
}

TEST(Statics, PlankOnTwoBallsFollowsTheLeverRule) {
  const std::vector<Feedback> stock = plank<btPoint2PointConstraint>(true);
  for (const bool block : {true, false}) {
    SCOPED_TRACE(block ? "block rows" : "plain rows");
    const std::vector<Feedback> ours = plank<pintle::BallJoint>(block);
    const Vector3d near(0, 0, weight * 2 / 3), far(0, 0, weight / 3);
    expect_balance(ours[0], {0, 0, 0}, post_centre, near, Vector3d(-0.3, 0, 0).cross(near));
    expect_balance(ours[1], {0, 0, 0}, post_centre, far, Vector3d(0.6, 0, 0).cross(far));
    for (int i = 0; i < 2; ++i) expect_equal(ours[i], stock[i]);
  }
}

}  // namespace physics_statics_test
