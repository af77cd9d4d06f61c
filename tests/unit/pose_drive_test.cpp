// Pose drives: one joint moves by the implicit Euler rule and sags by torque over stiffness, a moving target is followed without lag, the length
// of the torque keeps its bound, limits and locks win, and a ragdoll of twenty drives takes up poses and holds them.
#include <gtest/gtest.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/generic_6dof_joint.h>
#include <pintle/joints/generic_6dof_spring_2_joint.h>
#include <pintle/joints/generic_6dof_spring_joint.h>
#include <pintle/joints/hinge_2_joint.h>
#include <pintle/solver/exact_joint_solver.h>
#include <scenes/catalog.h>
#include <scenes/world.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "support.h"

namespace contract_test {
extern thread_local long allocated_bytes;  // by operator new
}

namespace pose_drive_test {
namespace {

using pintle::PoseDrive;
using scenes::pi;
using support::infinite;
using support::nan_value;
using support::Random;
using support::scalar;
using support::vec;

template <class Solver>
std::unique_ptr<btConstraintSolver> makeSolver() {
  return std::make_unique<Solver>();
}
using Sequential = btSequentialImpulseConstraintSolver;
using Exact = pintle::ExactJointSolver;

constexpr double rates[] = {30, 60, 120, 240};  // steps a second
// The rounding of some hundred steps.
constexpr double rounding = support::is_double ? 1e-12 : 1e-4;

btQuaternion about(const btVector3& axis, double angle) { return {axis, scalar(angle)}; }

// Joints whose frames are turned in their bodies, their angles free.
const btTransform frame_a(about(vec(1, 2, -1).normalized(), 0.7)),
    frame_b(about(vec(-2, 1, 1).normalized(), -1.9));

struct Ball {
  using Joint = pintle::BallJoint;
  static constexpr bool has_frames = false;
  static Joint& join(scenes::World& world, btRigidBody& a, btRigidBody& b, const btVector3& in_a,
                     const btVector3& in_b) {
    return world.add_joint<Joint>(a, b, in_a, in_b);
  }
};
template <class J>
struct Framed {
  using Joint = J;
  static constexpr bool has_frames = true;
  static Joint& join(scenes::World& world, btRigidBody& a, btRigidBody& b, const btVector3& in_a,
                     const btVector3& in_b) {
    Joint& joint = world.add_joint<Joint>(a, b, btTransform(frame_a.getBasis(), in_a),
                                          btTransform(frame_b.getBasis(), in_b));
    if constexpr (!std::is_same_v<Joint, pintle::ConeTwistJoint>)
      for (int i = 3; i < 6; ++i) joint.setLimit(i, 1, -1);
    return joint;
  }
};

template <class S, class K>
struct Case {
  using Solver = S;
  using Kind = K;
};

template <class C>
class One {
 public:
  using Kind = typename C::Kind;
  using Joint = typename Kind::Joint;
  static btMatrix3x3 frameOfA() {
    return Kind::has_frames ? frame_a.getBasis() : btMatrix3x3::getIdentity();
  }
  static btMatrix3x3 frameOfB() {
    return Kind::has_frames ? frame_b.getBasis() : btMatrix3x3::getIdentity();
  }

  explicit One(double gravity = 0) : world(gravity, 10, makeSolver<typename C::Solver>) {}

  // Two cubes that turn about their common centre.
  void joinCubes() {
    a = &world.add_box(2, vec(0.3, 0.3, 0.3), scenes::pose_at(vec(0, 0, 0)));
    b = &world.add_box(1, vec(0.2, 0.2, 0.2), scenes::pose_at(vec(0, 0, 0)));
    joint = &Kind::join(world, *a, *b, vec(0, 0, 0), vec(0, 0, 0));
  }
  // kg m^2, of the two cubes against each other
  double inertia() const {
    return 1 / double(a->getInvInertiaDiagLocal().x() + b->getInvInertiaDiagLocal().x());
  }
  // The rotation vector from the target to frame b, in the world.
  btVector3 error(const btQuaternion& target) const {
    const btMatrix3x3 R =
        b->getWorldTransform().getBasis() * frameOfB() *
        (a->getWorldTransform().getBasis() * frameOfA() * btMatrix3x3(target)).transpose();
    const Eigen::AngleAxisd turn(
        (Eigen::Matrix3d() << double(R[0][0]), double(R[0][1]), double(R[0][2]), double(R[1][0]),
         double(R[1][1]), double(R[1][2]), double(R[2][0]), double(R[2][1]), double(R[2][2]))
            .finished());
    return scenes::to_bullet(turn.angle() * turn.axis());
  }
  // Puts b where frame b is turned by `turn` (world) from the target.
  void turnFrom(const btQuaternion& target, const btQuaternion& turn) {
    btTransform pose = b->getWorldTransform();
    pose.setBasis(btMatrix3x3(turn) * a->getWorldTransform().getBasis() * frameOfA() *
                  btMatrix3x3(target) * frameOfB().transpose());
    b->setWorldTransform(pose);
    b->updateInertiaTensor();
  }

  scenes::World world;
  btRigidBody *a = nullptr, *b = nullptr;
  Joint* joint = nullptr;
};

using Cases = testing::Types<
    Case<Sequential, Ball>, Case<Exact, Ball>, Case<Sequential, Framed<pintle::ConeTwistJoint>>,
    Case<Exact, Framed<pintle::ConeTwistJoint>>, Case<Sequential, Framed<pintle::Generic6DofJoint>>,
    Case<Exact, Framed<pintle::Generic6DofJoint>>,
    Case<Sequential, Framed<pintle::Generic6DofSpringJoint>>,
    Case<Exact, Framed<pintle::Generic6DofSpringJoint>>,
    Case<Sequential, Framed<pintle::Generic6DofSpring2Joint>>,
    Case<Exact, Framed<pintle::Generic6DofSpring2Joint>>>;
template <class C>
class PoseDriveOfOne : public testing::Test {
 public:
  using Rig = One<C>;
};
TYPED_TEST_SUITE(PoseDriveOfOne, Cases);

const btQuaternion a_target = about(vec(1, -1, 2).normalized(), 1.1);

// --- one joint -----------------------------------------------------------------------------------

// About one axis, with a target that jumps: u' = (u - dt w^2 phi) / (1 + dt^2 w^2 + 2 z w dt).
TYPED_TEST(PoseDriveOfOne, MovesByTheImplicitEulerRule) {
  for (const double hz : rates) {
    for (const double frequency : {0.5, 4., 30., 1000.}) {
      for (const bool in_units : {false, true}) {
        SCOPED_TRACE(testing::Message()
                     << hz << " steps a second, " << frequency << " Hz, " << in_units);
        typename TestFixture::Rig one;
        one.joinCubes();
        const btVector3 n = vec(2, -1, 1).normalized();
        const double dt = 1 / hz, w = 2 * pi * frequency, z = 0.3, I = one.inertia();
        double phi = 0.5, u = 0;
        btQuaternion target = a_target;
        one.turnFrom(target, about(n, phi));
        const auto settings =
            in_units ? PoseDrive::fromStiffness(scalar(w * w * I), scalar(2 * z * w * I))
                     : PoseDrive::fromFrequency(scalar(frequency), scalar(z));
        for (int i = 0; i < 60; ++i) {
          if (i % 20 == 10) {  // the target turns by 0.4 about n
            const btVector3 in_a = n * (one.a->getWorldTransform().getBasis() * one.frameOfA());
            target = about(in_a, 0.4) * target;
            phi -= 0.4;
          }
          one.joint->setPoseDrive(target, settings);
          one.world.step(dt);
          u = (u - dt * w * w * phi) / (1 + dt * dt * w * w + 2 * z * w * dt);
          phi += dt * u;
          ASSERT_LE(double((one.error(target) - scalar(phi) * n).length()), rounding) << i;
        }
      }
    }
  }
}

// A bar of 2 kg that is held level by its end.
TYPED_TEST(PoseDriveOfOne, SagsByTorqueOverStiffness) {
  for (const double hz : rates) {
    for (const double stiffness : {30., 1000., 1e6}) {
      typename TestFixture::Rig one(9.81);
      one.a = &one.world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
      one.b = &one.world.add_box(2, vec(0.3, 0.05, 0.05), scenes::pose_at(vec(0.3, 0, 0)));
      one.joint =
          &TestFixture::Rig::Kind::join(one.world, *one.a, *one.b, vec(0, 0, 0), vec(-0.3, 0, 0));
      const btMatrix3x3 level = one.frameOfA().transpose() * one.frameOfB();
      btQuaternion target;
      level.getRotation(target);
      const double inertia = 2 * 0.3 * 0.3 * 4 / 3;
      one.joint->setPoseDrive(
          target,
          PoseDrive::fromStiffness(scalar(stiffness), scalar(2 * std::sqrt(stiffness * inertia))));
      for (int i = 0; i < 6 * hz; ++i) one.world.step(1 / hz);
      const btVector3 phi = one.error(target);
      const double torque = 2 * 9.81 * 0.3 * std::cos(double(phi.length()));
      EXPECT_NEAR(double(phi.y()), torque / stiffness, support::is_double ? 1e-7 : 1e-4)
          << hz << " " << stiffness;
      EXPECT_NEAR(double(one.joint->getPoseDriveImpulse().y()) * hz, -torque,
                  (support::is_double ? 1e-6 : 2e-3) * torque);
    }
  }
}

// The target of the end of each step, and its velocity. Without that it lags by damping / stiffness times the speed.
TYPED_TEST(PoseDriveOfOne, FollowsAMovingTargetWithoutLag) {
  for (const double hz : rates) {
    for (const bool knows_velocity : {true, false}) {
      typename TestFixture::Rig one;
      one.joinCubes();
      one.a->setMassProps(0, vec(0, 0, 0));
      one.a->updateInertiaTensor();
      const double dt = 1 / hz, speed = 1.5, frequency = 5;
      const btVector3 n = vec(1, 3, -1).normalized();  // of frame a
      auto settings = PoseDrive::fromFrequency(scalar(frequency), 1);
      if (knows_velocity) settings.target_velocity = scalar(speed) * n;
      one.turnFrom(a_target, btQuaternion::getIdentity());
      btQuaternion target;
      for (int i = 1; i <= 2 * hz; ++i) {
        target = about(n, speed * i * dt) * a_target;
        one.joint->setPoseDrive(target, settings);
        one.world.step(dt);
      }
      const double lag = knows_velocity ? 0 : 2 * speed / (2 * pi * frequency);
      const btVector3 expected = -scalar(lag) * (one.frameOfA() * n);
      EXPECT_LE(double((one.error(target) - expected).length()), support::is_double ? 1e-10 : 2e-5)
          << hz << " " << knows_velocity;
    }
  }
}

// A damper alone brings the bodies to its velocity.
TYPED_TEST(PoseDriveOfOne, NeedsNoStiffness) {
  typename TestFixture::Rig one;
  one.joinCubes();
  one.a->setMassProps(0, vec(0, 0, 0));
  one.a->updateInertiaTensor();
  auto settings = PoseDrive::fromStiffness(0, 1);
  settings.target_velocity = vec(1, -2, 0.5);
  one.joint->setPoseDrive(btQuaternion::getIdentity(), settings);
  for (int i = 0; i < 200; ++i) one.world.step(1. / 60);
  EXPECT_LE(
      double((one.b->getAngularVelocity() - one.frameOfA() * settings.target_velocity).length()),
      rounding);
}

// --- its bound -----------------------------------------------------------------------------------

// The spin of a cube that nothing else acts on changes by the torque.
TYPED_TEST(PoseDriveOfOne, TorqueIsNeverLongerThanItsBound) {
  Random random(7);
  double longest = 0;
  for (const double hz : rates) {
    typename TestFixture::Rig one;
    one.joinCubes();
    one.a->setMassProps(0, vec(0, 0, 0));
    one.a->updateInertiaTensor();
    const double I = 1 / double(one.b->getInvInertiaDiagLocal().x());
    for (int i = 0; i < support::trials(400); ++i) {
      const double torque = std::pow(10, random.uniform(-2, 2));
      const auto settings =
          i % 2 ? PoseDrive::fromFrequency(scalar(std::pow(10, random.uniform(-1, 3))),
                                           scalar(random.uniform(0, 2)), scalar(torque))
                : PoseDrive::fromStiffness(scalar(std::pow(10, random.uniform(-2, 6))),
                                           scalar(std::pow(10, random.uniform(-2, 4))),
                                           scalar(torque));
      one.joint->setPoseDrive(random.pose(1).getRotation(), settings);
      if (i % 5 == 0) one.b->setAngularVelocity(random.vector(10));
      const btVector3 before = one.b->getAngularVelocity();
      one.world.step(1 / hz);
      const btVector3 change = scalar(I) * (one.b->getAngularVelocity() - before);
      const btVector3 drive = one.joint->getPoseDriveImpulse();
      const double impulse = double(drive.length()), bound = torque / hz;
      ASSERT_LE(impulse, bound * (1 + 16 * double(SIMD_EPSILON))) << i;
      ASSERT_LE(double((drive - change).length()),
                200 * double(SIMD_EPSILON) * (bound + I * double(before.length())))
          << i;
      longest = std::max(longest, impulse / bound);
    }
  }
  EXPECT_GT(longest, 0.94);  // (pintle::max_part_along)
}

// Far from its target a single joint is turned with all but a twentieth of the bound, along the way there.
TYPED_TEST(PoseDriveOfOne, GivesNearlyAllThatItHas) {
  typename TestFixture::Rig one;
  one.joinCubes();
  one.a->setMassProps(0, vec(0, 0, 0));
  one.a->updateInertiaTensor();
  const double I = 1 / double(one.b->getInvInertiaDiagLocal().x()), torque = 0.02, dt = 1. / 60;
  const btVector3 n = vec(1, 2, 3).normalized();
  one.turnFrom(a_target, about(n, 2));
  one.joint->setPoseDrive(a_target, PoseDrive::fromStiffness(100, 1, scalar(torque)));
  for (int i = 1; i <= 5; ++i) {
    one.world.step(dt);
    const btVector3 expected = scalar(-0.95 * torque * dt * i / I) * n;
    EXPECT_LE(double((one.b->getAngularVelocity() - expected).length()), rounding) << i;
  }
}

// --- limits, locks, settings ---------------------------------------------------------------------

TYPED_TEST(PoseDriveOfOne, HalfATurnIsTakenOneWayAndNoNumberIsLost) {
  typename TestFixture::Rig one;
  one.joinCubes();
  one.turnFrom(a_target, about(vec(0, 0, 1), pi));
  one.joint->setPoseDrive(a_target, PoseDrive::fromFrequency(3, 1));
  for (int i = 0; i < 120; ++i) {
    one.world.step(1. / 60);
    ASSERT_TRUE(support::is_finite(*one.b));
  }
  EXPECT_LE(double(one.error(a_target).length()), 1e-3);
}

TYPED_TEST(PoseDriveOfOne, BadSettingsThrowAndChangeNothing) {
  typename TestFixture::Rig one;
  one.joinCubes();
  auto& joint = *one.joint;
  const auto good = PoseDrive::fromStiffness(5, 2, 3);
  joint.setPoseDrive(btQuaternion(0, 0, 3, 4), good);
  const auto rejects = [&](const char* field, const btQuaternion& target,
                           const PoseDrive& settings) {
    try {
      joint.setPoseDrive(target, settings);
      ADD_FAILURE() << field;
    } catch (const std::invalid_argument& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find(joint.name()), std::string::npos) << text;
      EXPECT_NE(text.find(field), std::string::npos) << text;
    }
    EXPECT_EQ(joint.getPoseDrive().spring.stiffness, 5);
    EXPECT_EQ(joint.getPoseDrive().spring.damping, 2);
    EXPECT_EQ(joint.getPoseDrive().max_torque, 3);
    EXPECT_LE(
        double((joint.getPoseTarget() - btQuaternion(0, 0, scalar(0.6), scalar(0.8))).length()),
        rounding);
  };
  const btQuaternion one_turn(0, 0, 0, 1);
  rejects("pose target", {0, 0, 0, 0}, good);
  for (const btScalar bad : {nan_value, infinite}) {
    rejects("pose target", {0, bad, 0, 1}, good);
    rejects("pose drive stiffness", one_turn, PoseDrive::fromStiffness(bad, 1));
    rejects("pose drive damping", one_turn, PoseDrive::fromStiffness(1, bad));
    rejects("pose drive frequency", one_turn, PoseDrive::fromFrequency(bad, 1));
    rejects("pose drive damping ratio", one_turn, PoseDrive::fromFrequency(1, bad));
    auto moving = good;
    moving.target_velocity = {0, 0, bad};
    rejects("pose drive target velocity", one_turn, moving);
  }
  rejects("pose drive stiffness", one_turn, PoseDrive::fromStiffness(-1, 1));
  rejects("pose drive damping", one_turn, PoseDrive::fromStiffness(1, -1));
  rejects("pose drive frequency", one_turn, PoseDrive::fromStiffness(0, 0));
  rejects("pose drive frequency", one_turn, PoseDrive::fromFrequency(0, 1));
  rejects("pose drive damping ratio", one_turn, PoseDrive::fromFrequency(1, -1));
  rejects("pose drive max torque", one_turn, PoseDrive::fromStiffness(1, 1, -1));
  rejects("pose drive max torque", one_turn, PoseDrive::fromStiffness(1, 1, nan_value));
}

// Without a drive a joint has neither rows nor memory for one; another target takes none.
TYPED_TEST(PoseDriveOfOne, CostsNothingUntilItIsSet) {
  typename TestFixture::Rig one;
  one.joinCubes();
  auto& joint = *one.joint;
  const int without = support::SolverRows::ofStep(joint).announced();
  EXPECT_FALSE(joint.hasPoseDrive());
  EXPECT_EQ(joint.getPoseDriveImpulse(), vec(0, 0, 0));
  joint.setPoseDrive(a_target, PoseDrive::fromFrequency(3, 1));
  EXPECT_TRUE(joint.hasPoseDrive());
  const long before = contract_test::allocated_bytes;
  joint.setPoseDrive(btQuaternion::getIdentity(), PoseDrive::fromStiffness(3, 1, 7));
  EXPECT_EQ(contract_test::allocated_bytes, before);
  EXPECT_GE(support::SolverRows::ofStep(joint).announced(), without + 3);
  joint.clearPoseDrive();
  EXPECT_FALSE(joint.hasPoseDrive());
  EXPECT_EQ(support::SolverRows::ofStep(joint).announced(), without);
  for (int i = 0; i < 3; ++i) one.world.step(1. / 60);
  EXPECT_EQ(joint.getPoseDriveImpulse(), vec(0, 0, 0));
}

template <class Solver>
class Limb {
 public:
  btRigidBody& ground() {
    return world.add_box(0, vec(0.1, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
  }
  btRigidBody& limb() {
    return world.add_box(1, vec(0.3, 0.1, 0.2), scenes::pose_at(vec(0.3, 0, 0)));
  }
  scenes::World world{0, 50, makeSolver<Solver>};
};
template <class Solver>
class PoseDriveOfALimb : public testing::Test {
 public:
  using Rig = Limb<Solver>;
};
using Solvers = testing::Types<Sequential, Exact>;
TYPED_TEST_SUITE(PoseDriveOfALimb, Solvers);

btTransform at(double x) { return scenes::pose_at(vec(x, 0, 0)); }
const PoseDrive strong = PoseDrive::fromStiffness(2000, 100);

// The pose is 1 rad out, the cone ends at 0.6 rad, the twist at 0.3 rad.
TYPED_TEST(PoseDriveOfALimb, ConeTwistLimitsWin) {
  for (const btVector3& axis :
       {vec(0, 1, 0), vec(0, 0, 1), vec(1, 0, 0), vec(1, 1, 0.5).normalized()}) {
    typename TestFixture::Rig made;
    btRigidBody &a = made.ground(), &b = made.limb();
    // Bullet's frame of the cone is b's.
    auto& joint = made.world.template add_joint<pintle::ConeTwistJoint>(a, b, at(0), at(-0.3));
    joint.setLimit(scalar(0.6), scalar(0.6), scalar(0.3), 1, scalar(0.3), 1);
    joint.setPoseDrive(about(axis, 1), strong);
    double swing = 0, twist = 0;
    for (int i = 0; i < 120; ++i) {
      made.world.step(1. / 60);
      swing = std::hypot(double(joint.getSwing1()), double(joint.getSwing2()));
      twist = std::abs(double(joint.getTwist()));
      ASSERT_LE(swing, 0.6 + 2e-3) << i;
      ASSERT_LE(twist, 0.3 + 2e-3) << i;
    }
    if (axis.x() == 0) {
      EXPECT_NEAR(swing, 0.6, 2e-3);
    }
    if (axis.x() == 1) {
      EXPECT_NEAR(twist, 0.3, 2e-3);
    }
  }
}

TYPED_TEST(PoseDriveOfALimb, SixDofLimitsWinAndLocksHold) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int locked = 0; locked < 3; ++locked) {
      SCOPED_TRACE(testing::Message() << "axis " << axis << ", locked " << locked);
      typename TestFixture::Rig made;
      btRigidBody &a = made.ground(), &b = made.limb();
      auto& joint =
          made.world.template add_joint<pintle::Generic6DofSpring2Joint>(a, b, at(0), at(-0.3));
      for (int i = 0; i < 3; ++i) joint.setLimit(3 + i, scalar(-0.4), scalar(0.4));
      // As many of the others are locked.
      for (int i = 1; i <= locked; ++i) joint.setLimit(3 + (axis + i) % 3, 0, 0);
      btVector3 n(0, 0, 0);
      n[axis] = 1;
      joint.setPoseDrive(about((n + vec(0.3, 0.2, 0.25)).normalized(), 1), strong);
      for (int i = 0; i < 120; ++i) {
        made.world.step(1. / 60);
        for (int k = 0; k < 3; ++k) {
          const bool is_locked = locked >= 1 && k == (axis + 1) % 3;
          const bool is_locked_2 = locked >= 2 && k == (axis + 2) % 3;
          ASSERT_LE(std::abs(double(joint.getAccumulatedAngle(3 + k))),
                    is_locked || is_locked_2 ? 1e-4 : 0.4 + 2e-3)
              << i << " " << k;
        }
      }
      EXPECT_NEAR(std::abs(double(joint.getAccumulatedAngle(3 + axis))), 0.4, 2e-3);
    }
  }
}

// Two locked angles leave one row, three none; there it moves nothing.
TYPED_TEST(PoseDriveOfALimb, HasNoRowsForWhatIsLocked) {
  typename TestFixture::Rig made;
  btRigidBody &a = made.ground(), &b = made.limb();
  auto& joint = made.world.template add_joint<pintle::Generic6DofJoint>(a, b, at(0), at(-0.3));
  for (int i = 3; i < 6; ++i) joint.setLimit(i, 0, 0);
  const int locked = support::SolverRows::ofStep(joint).announced();
  joint.setPoseDrive(a_target, strong);
  EXPECT_EQ(support::SolverRows::ofStep(joint).announced(), locked);
  joint.setLimit(4, 1, -1);
  // (A spring of Bullet's solver may be two rows; of the joint it is one.)
  const int free = support::SolverRows::ofStep(joint).announced();
  EXPECT_GE(free, locked - 1 + 1);
  EXPECT_LE(free, locked - 1 + 2);
  for (int i = 0; i < 240; ++i) made.world.step(1. / 60);
  // The angle that is nearest to the target: of its turns about y.
  EXPECT_LE(std::abs(double(joint.getAccumulatedAngle(3))), 1e-4);
  EXPECT_GE(std::abs(double(joint.getAccumulatedAngle(4))), 0.2);
  EXPECT_LE(std::abs(double(joint.getAccumulatedAngle(5))), 1e-4);
}

// A wheel's suspension has two free angles.
TYPED_TEST(PoseDriveOfALimb, TurnsTheWheelOfAHinge2) {
  typename TestFixture::Rig made;
  btRigidBody& a = made.ground();
  btRigidBody& b = made.world.add_box(1, vec(0.1, 0.3, 0.3), scenes::pose_at(vec(0, 0, 0)));
  auto& joint = made.world.template add_joint<pintle::Hinge2Joint>(a, b, at(0), at(0));
  joint.setPoseDrive(about(vec(1, 0, 0), 0.8), strong);
  for (int i = 0; i < 240; ++i) made.world.step(1. / 60);
  EXPECT_NEAR(std::abs(double(joint.getAccumulatedAngle(3))), 0.8, 1e-3);
}

// Bullet's motor of a cone-twist joint rests while a pose drive is set, and acts again after it.
TYPED_TEST(PoseDriveOfALimb, ComesBeforeBulletsMotor) {
  typename TestFixture::Rig made;
  btRigidBody &a = made.ground(), &b = made.limb();
  auto& joint = made.world.template add_joint<pintle::ConeTwistJoint>(a, b, at(0), at(-0.3));
  joint.setMaxMotorImpulse(-1);
  joint.enableMotor(true);
  joint.setMotorTarget(about(vec(0, 0, 1), 0.5));  // of a against b
  const auto settle = [&] {
    for (int i = 0; i < 180; ++i) made.world.step(1. / 60);
    return 2 * std::atan2(double(b.getOrientation().z()), double(b.getOrientation().w()));
  };
  EXPECT_NEAR(settle(), -0.5, 1e-3);
  joint.setPoseDrive(about(vec(0, 0, 1), 0.3), strong);
  EXPECT_NEAR(settle(), 0.3, 1e-3);
  EXPECT_EQ(joint.getMotorImpulse(), vec(0, 0, 0));
  joint.clearPoseDrive();
  EXPECT_NEAR(settle(), -0.5, 1e-3);
}

// --- a ragdoll -----------------------------------------------------------------------------------

// That of the scene: it hangs by its pelvis, which does not move, with twenty drives. Each is as stiff as makes what it carries swing at `frequency`,
// critically damped.
template <class Joint>
class Ragdoll {
 public:
  Ragdoll(scenes::World& world, double frequency, double max_torque) {
    const scenes::Scene scene = scenes::named("active_ragdoll");
    m_bodies = world.add_bodies(scene);
    const double faster = frequency / scene_frequency;
    for (const scenes::Joint& from : scene.joints) {
      m_limbs.push_back({from.a, m_bodies[size_t(from.b)],
                         &world.add_joint_of<Joint>(from, m_bodies),
                         scenes::to_bullet(from.in_b).getOrigin()});
      m_drives.push_back(PoseDrive::fromStiffness(scalar(faster * faster * from.muscle.stiffness),
                                                  scalar(faster * from.muscle.damping),
                                                  scalar(max_torque)));
    }
  }

  int drives() const { return int(m_limbs.size()); }
  void take(const std::vector<btQuaternion>& pose) {
    m_pose = pose;
    for (size_t i = 0; i < m_limbs.size(); ++i)
      m_limbs[i].joint->setPoseDrive(pose[i], m_drives[i]);
  }
  // Each joint turned by up to so much.
  std::vector<btQuaternion> randomPose(unsigned seed, double most) const {
    Random random(seed);
    std::vector<btQuaternion> pose;
    for (size_t i = 0; i < m_limbs.size(); ++i)
      pose.push_back(about(random.unit(), random.uniform(-most, most)));
    return pose;
  }
  // rad: the error of the worst joint
  double error() const {
    double worst = 0;
    for (size_t i = 0; i < m_limbs.size(); ++i)
      worst = std::max(worst, double(errorOf(i).length()));
    return worst;
  }
  // rad/s
  double speed() const {
    double fastest = 0;
    for (const Limb& limb : m_limbs)
      fastest = std::max(fastest, double(limb.body->getAngularVelocity().length()));
    return fastest;
  }
  // rad: the largest difference between a joint's error and the moment of the weight that it carries over its stiffness.
  double distanceFromStatics() const {
    double worst = 0;
    for (size_t i = 0; i < m_limbs.size(); ++i) {
      btVector3 moment(0, 0, 0);
      forEachCarried(m_limbs[i], [&](const btRigidBody& body) {
        const btVector3 arm = body.getCenterOfMassPosition() - pivot(m_limbs[i]);
        moment += arm.cross(vec(0, 0, -scenes::standard_gravity) / body.getInvMass());
      });
      const btVector3 expected = moment / m_drives[i].spring.stiffness;
      worst = std::max(worst, double((errorOf(i) - expected).length()));
    }
    return worst;
  }
  // N m: the longest torque in the last step
  double torque(double hz) const {
    double longest = 0;
    for (const Limb& limb : m_limbs)
      longest = std::max(longest, hz * double(limb.joint->getPoseDriveImpulse().length()));
    return longest;
  }

 private:
  struct Limb {
    int parent;
    btRigidBody* body;
    Joint* joint;
    btVector3 in_body;  ///< pivot
  };

  btVector3 pivot(const Limb& limb) const {
    return limb.body->getCenterOfMassTransform()(limb.in_body);
  }
  template <class Visit>
  void forEachCarried(const Limb& from, const Visit& visit) const {
    std::vector<const btRigidBody*> carried = {from.body};
    visit(*from.body);
    // Limbs come after what they hang on.
    for (const Limb& limb : m_limbs) {
      const btRigidBody* on = m_bodies[size_t(limb.parent)];
      if (std::find(carried.begin(), carried.end(), on) == carried.end()) continue;
      carried.push_back(limb.body);
      visit(*limb.body);
    }
  }
  btVector3 errorOf(size_t i) const {
    const Limb& limb = m_limbs[i];
    btQuaternion turn = limb.body->getOrientation() *
                        (m_bodies[size_t(limb.parent)]->getOrientation() * m_pose[i]).inverse();
    if (turn.w() < 0) turn = -turn;
    const btVector3 v(turn.x(), turn.y(), turn.z());
    const double sine = double(v.length());
    return sine > 0 ? v * scalar(2 * std::atan2(sine, double(turn.w())) / sine) : v;
  }

  static constexpr double scene_frequency = 10;  // Hz

  std::vector<btRigidBody*> m_bodies;
  std::vector<Limb> m_limbs;
  std::vector<PoseDrive> m_drives;
  std::vector<btQuaternion> m_pose;
};

template <class Joint>
class Ragdolls : public testing::Test {};
using RagdollJoints = testing::Types<pintle::BallJoint, pintle::ConeTwistJoint>;
TYPED_TEST_SUITE(Ragdolls, RagdollJoints);

constexpr double stiff = 10, strongest = 400;  // Hz, N m

// From pose to pose in 2 s, and then it stays there: off by what its weight bends the drives by.
TYPED_TEST(Ragdolls, TakesUpAnyPoseAndHoldsItOnTheExactSolver) {
  for (const double hz : rates) {
    for (const double torque : {double(infinite), strongest}) {
      SCOPED_TRACE(testing::Message() << hz << " steps a second, " << torque << " N m");
      scenes::World world(scenes::standard_gravity, 10, makeSolver<Exact>);
      Ragdoll<TypeParam> doll(world, stiff, torque);
      ASSERT_EQ(doll.drives(), 20);
      for (unsigned pose = 0; pose < 3; ++pose) {
        doll.take(doll.randomPose(pose, 1));
        for (int i = 0; i < 2 * hz; ++i) {
          world.step(1 / hz);
          ASSERT_LE(doll.torque(hz), torque * (1 + 10 * rounding));
        }
        EXPECT_LE(doll.error(), 0.03);
        for (int i = 0; i < 2 * hz; ++i) world.step(1 / hz);
        EXPECT_LE(doll.distanceFromStatics(), support::is_double ? 1e-6 : 2e-4);
        EXPECT_LE(doll.speed(), support::is_double ? 1e-4 : 1e-3);
      }
    }
  }
}

// Bullet's solver needs passes for so many that bear on each other: with these what it leaves is a hundredth of a radian.
TYPED_TEST(Ragdolls, TakesUpAnyPoseAndHoldsItOnBulletsSolver) {
  for (const double hz : rates) {
    for (const double torque : {double(infinite), strongest}) {
      SCOPED_TRACE(testing::Message() << hz << " steps a second, " << torque << " N m");
      const int passes = hz < 50 ? 400 : hz < 100 ? 200 : 100;
      scenes::World world(scenes::standard_gravity, passes, makeSolver<Sequential>);
      Ragdoll<TypeParam> doll(world, stiff, torque);
      for (unsigned pose = 0; pose < 2; ++pose) {
        doll.take(doll.randomPose(pose, 1));
        for (int i = 0; i < 2 * hz; ++i) {
          world.step(1 / hz);
          ASSERT_LE(doll.torque(hz), torque * (1 + 10 * rounding));
        }
        EXPECT_LE(doll.error(), 0.04);
        EXPECT_LE(doll.distanceFromStatics(), 0.01);
        EXPECT_LE(doll.speed(), 0.01);
      }
    }
  }
}

}  // namespace
}  // namespace pose_drive_test
