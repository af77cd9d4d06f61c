// The fixed joint: it comes back from any error of its orientation, soon, gently and for good; what
// a client of btFixedConstraint calls gives the same answers; and bodies move alike, or better.
#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <gtest/gtest.h>
#include <pintle/body_pair.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/rows/row.h>
#include <scenes/recovery.h>
#include <scenes/unstable.h>

#include <tuple>
#include <vector>

#include "drawing.h"
#include "physics_support.h"
#include "solver_of_tests.h"
#include "support.h"

namespace fixed_joint_test {

using pintle::FixedJoint;
using pintle::Formulation;
using scenes::pi;
using scenes::pose_at;
using scenes::radians;
using scenes::RecoveryResult;
using scenes::RecoverySettings;
using support::infinite;
using support::nan_value;
using support::Random;
using support::scalar;
using support::SolverRows;
using support::vec;
using Stock = btFixedConstraint;

void expectNear(const btVector3& a, const btVector3& b, double tolerance) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "xyz"[i];
}
void expectNear(const btTransform& a, const btTransform& b, double tolerance) {
  expectNear(a.getOrigin(), b.getOrigin(), tolerance);
  for (int i = 0; i < 3; ++i) expectNear(a.getBasis()[i], b.getBasis()[i], tolerance);
}

// --- recovery ------------------------------------------------------------------------------------

struct Direction {
  const char* name;
  double x, y, z;
};
std::ostream& operator<<(std::ostream& out, const Direction& d) { return out << d.name; }

constexpr Direction directions[] = {{"X", 1, 0, 0},
                                    {"Y", 0, 1, 0},
                                    {"Z", 0, 0, 1},
                                    {"InXY", 0.6, 0.8, 0},
                                    {"InYZ", 0, 0.8, 0.6},
                                    {"Diagonal", 1, 1, 1},
                                    {"Askew", 0.36, -0.48, 0.8}};

RecoverySettings settings(double degrees, const Direction& about) {
  RecoverySettings result;
  result.lock = true;
  result.angle = radians(degrees);
  result.about = Eigen::Vector3d(about.x, about.y, about.z).normalized();
  return result;
}

struct Configure {
  Formulation formulation = Formulation::conditioned;
  double max_speed = 8;  // rad/s

  void operator()(FixedJoint& joint) const {
    joint.setFormulation(formulation);
    joint.setMaxCorrectionSpeed(scalar(max_speed));
  }
};

using Case = std::tuple<double, Direction>;

std::string case_name(const testing::TestParamInfo<Case>& tested) {
  return physics::angle_name(std::get<0>(tested.param)) + "About" + std::get<1>(tested.param).name;
}

class FixedRecovery : public testing::TestWithParam<Case> {};

TEST_P(FixedRecovery, IsSoonAndGentleAndForGood) {
  const RecoverySettings start = settings(std::get<0>(GetParam()), std::get<1>(GetParam()));
  const RecoveryResult ours = scenes::recovery<FixedJoint>(start);
  const RecoveryResult stock = scenes::recovery<Stock>(start);
  const auto text = [](const RecoveryResult& r) {
    return std::to_string(r.steps) + " steps, " + std::to_string(r.max_angular_speed) + " rad/s";
  };
  RecordProperty("ours", text(ours));
  RecordProperty("stock", text(stock));
  ASSERT_TRUE(ours.finite);
  ASSERT_NEAR(ours.start_axis_angle, start.angle, physics::rounding(1e-3, 1e-7));
  EXPECT_GT(ours.steps, 0) << "never";
  // From pi at 8 rad/s to the error of 8 rad/s in 60 Hz and ERP 0.2, 0.67 rad, are 19 steps, and
  // from there to 1 degree, each step 0.8 of the last, 17 more.
  EXPECT_LE(ours.steps, 38);
  // Half the bound each about a principal axis; about others the anchors pull the bodies along.
  EXPECT_LE(ours.max_turning, 12);
  EXPECT_LE(ours.max_gap, 0.005);
  if (stock.finite) {
    // The exact solver closes it by poses, by the last part at once.
    const double free = onExactSolver() ? 0.55 : 0.1, more = onExactSolver() ? 1.05 : 1.01;
    EXPECT_LE(ours.max_turning, std::max(more * stock.max_angular_speed, free));
  }
}

INSTANTIATE_TEST_SUITE_P(AngleAndDirection, FixedRecovery,
                         testing::Combine(testing::Values(0, 1, 10, 45, 60, 90, 120, 135, 150, 170,
                                                          175, 179, 179.9, 179.999, 180),
                                          testing::ValuesIn(directions)),
                         case_name);

TEST(FixedJointRecovery, StockThrowsTheBodiesAboutOrLosesThem) {
  // Its Euler angles have no axis at 90 degrees about y.
  if (physics::single_precision) {
    EXPECT_FALSE(scenes::recovery<Stock>(settings(90, directions[1])).finite);
  }
  EXPECT_GT(scenes::recovery<Stock>(settings(170, directions[1])).max_angular_speed, 50);
}

TEST(FixedJointRecovery, SpeedIsBoundedByItsSetting) {
  for (const double speed : {1., 2., 4., 8.}) {
    const RecoveryResult run =
        scenes::recovery<FixedJoint>(settings(150, directions[0]), Configure{{}, speed});
    EXPECT_GT(run.steps, 0) << speed;
    // Each body at half the relative speed; the last steps' rounding.
    EXPECT_NEAR(run.max_turning, speed / 2, 0.01 * speed);
  }
}

TEST(FixedJointRecovery, TheDocumentsComesBackButNotFrom180) {
  Configure document;
  document.formulation = Formulation::document;
  for (const Direction& about : directions) {
    for (const double degrees : {10., 45., 90., 120.})
      EXPECT_GT(scenes::recovery<FixedJoint>(settings(degrees, about), document).steps, 0)
          << degrees << " about " << about;
  }
  // Half a turn about x is a pose without rounding: its row vanishes there.
  const RecoveryResult run = scenes::recovery<FixedJoint>(settings(180, directions[0]), document);
  EXPECT_EQ(run.steps, -1);
  EXPECT_NEAR(run.end_axis_angle, pi, physics::rounding(1e-3, 1e-6));
}

// --- as stock's ----------------------------------------------------------------------------------

TEST(DropInFixed, ReadsAsStocks) {
  Random random(1);
  for (int n = 0; n < 200; ++n) {
    SCOPED_TRACE(n);
    const auto a = support::body(1, vec(1, 2, 3), random.pose(2));
    const auto b = support::body(1, vec(1, 2, 3), random.pose(2));
    const btTransform frame_a = random.pose(1), frame_b = random.pose(1);
    Stock stock(*a, *b, frame_a, frame_b);
    FixedJoint ours(*a, *b, frame_a, frame_b);
    const auto expectSame = [&] {
      stock.calculateTransforms();
      ours.calculateTransforms();
      const double rounding = support::is_double ? 1e-12 : 1e-5;
      expectNear(stock.getFrameOffsetA(), ours.getFrameOffsetA(), 0);
      expectNear(stock.getFrameOffsetB(), ours.getFrameOffsetB(), 0);
      expectNear(stock.getCalculatedTransformA(), ours.getCalculatedTransformA(), rounding);
      expectNear(stock.getCalculatedTransformB(), ours.getCalculatedTransformB(), rounding);
      // Euler angles lose digits by their middle one.
      const double level = std::max(0.01, std::cos(double(stock.getAngle(1))));
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(stock.getRelativePivotPosition(i), ours.getRelativePivotPosition(i), rounding);
        EXPECT_NEAR(std::remainder(double(stock.getAngle(i) - ours.getAngle(i)), 2 * pi), 0,
                    rounding / level);
        expectNear(stock.getAxis(i), ours.getAxis(i), rounding / level);
        EXPECT_EQ(stock.isLimited(i), ours.isLimited(i));
      }
    };
    expectSame();
    const btTransform new_a = random.pose(1), new_b = random.pose(1);
    stock.setFrames(new_a, new_b);
    ours.setFrames(new_a, new_b);
    expectSame();
    stock.getFrameOffsetA() = frame_b;
    ours.getFrameOffsetA() = frame_b;
    expectSame();
  }
  // Half-way round y no axis is stock's: a definite one here.
  const auto a = support::body(1, vec(1, 2, 3), btTransform::getIdentity());
  const auto b =
      support::body(1, vec(1, 2, 3), btTransform(btMatrix3x3(0, 0, 1, 0, 1, 0, -1, 0, 0)));
  FixedJoint quarter(*a, *b, btTransform::getIdentity(), btTransform::getIdentity());
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(quarter.getAxis(i).length(), 1, 1e-6);
    EXPECT_NEAR(quarter.getAngle(i), i == 1 ? -pi / 2 : 0, 1e-6);
  }
}

TEST(DropInFixed, ParametersOfTheStopAreThoseOfTheJoint) {
  const auto a = support::body(1, vec(1, 2, 3), btTransform::getIdentity());
  const auto b = support::body(1, vec(1, 2, 3), btTransform::getIdentity());
  const btTransform frame = btTransform::getIdentity();
  Stock stock(*a, *b, frame, frame);
  FixedJoint ours(*a, *b, frame, frame);
  for (int axis = 0; axis < 6; ++axis) {
    EXPECT_EQ(stock.getParam(BT_CONSTRAINT_STOP_ERP, axis),
              ours.getParam(BT_CONSTRAINT_STOP_ERP, axis));
    EXPECT_EQ(stock.getParam(BT_CONSTRAINT_STOP_CFM, axis),
              ours.getParam(BT_CONSTRAINT_STOP_CFM, axis));
  }
  const auto set = [](btTypedConstraint& joint) {
    for (int axis = 0; axis < 6; ++axis) {
      joint.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.7), axis);
      joint.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.01), axis);
    }
  };
  set(stock);
  set(ours);
  for (int axis = 0; axis < 6; ++axis) {
    EXPECT_EQ(stock.getParam(BT_CONSTRAINT_STOP_ERP, axis),
              ours.getParam(BT_CONSTRAINT_STOP_ERP, axis));
    EXPECT_EQ(stock.getParam(BT_CONSTRAINT_STOP_CFM, axis),
              ours.getParam(BT_CONSTRAINT_STOP_CFM, axis));
  }
  // And they reach the rows.
  const SolverRows rows = SolverRows::ofStep(ours);
  ASSERT_EQ(rows.announced(), 6);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(rows[i].cfm(), scalar(0.01));
}

// One box fixed to a static one, or to a free one.
template <class Joint>
struct Rig {
  scenes::World world;
  btRigidBody &a, &b;
  Joint& joint;

  explicit Rig(bool static_a, int iterations = 100)
      : world(0, iterations),
        a(world.add_box(static_a ? 0 : 2, vec(0.5, 0.2, 0.1), pose_at(vec(0, 0, 0)))),
        b(world.add_box(1, vec(0.5, 0.2, 0.1), pose_at(vec(1, 0, 0)))),
        joint(world.add_joint<Joint>(a, b, pose_at(vec(0.5, 0, 0)), pose_at(vec(-0.5, 0, 0)))) {}
  void step(int steps = 1) {
    for (int i = 0; i < steps; ++i) world.step(1.0 / 60);
  }
  btRigidBody& free() { return b; }
};

template <class Joint>
std::vector<btVector3> feedbackUnderALoad(bool static_a) {
  Rig<Joint> rig(static_a);
  btJointFeedback feedback;
  rig.joint.setJointFeedback(&feedback);
  rig.joint.enableFeedback(true);
  rig.b.applyCentralForce(vec(3, -5, 7));
  rig.b.applyTorque(vec(1, 0.5, -0.25));
  rig.step();
  rig.joint.setJointFeedback(nullptr);
  return {feedback.m_appliedForceBodyA, feedback.m_appliedTorqueBodyA, feedback.m_appliedForceBodyB,
          feedback.m_appliedTorqueBodyB};
}

TEST(DropInFixed, FeedbackIsStocks) {
  PINTLE_SKIP_ON_EXACT_SOLVER("impulses are those that hold the joint at the end of the step");
  for (const bool static_a : {true, false}) {
    const auto stock = feedbackUnderALoad<Stock>(static_a);
    const auto ours = feedbackUnderALoad<FixedJoint>(static_a);
    // Some N: what 100 iterations leave of stock's.
    for (size_t i = 0; i < ours.size(); ++i) expectNear(stock[i], ours[i], 2e-3);
    if (!static_a) continue;
    // Statics: the joint takes all of the force and of the torque about the centre.
    expectNear(ours[2], vec(-3, 5, -7), 1e-4);
    expectNear(ours[3], vec(-1, -0.5, 0.25), 1e-4);
  }
}

TEST(DropInFixed, BreaksInTheStepInWhichStocksDoes) {
  const auto stepOfBreaking = [](auto&& rig, const btVector3& force, const btVector3& torque) {
    rig.joint.setBreakingImpulseThreshold(scalar(0.5));  // 30 N or N m at 60 Hz
    return support::stepOfBreaking(rig, rig.joint, force, torque);
  };
  for (const bool static_a : {true, false}) {
    for (int axis = 0; axis < 3; ++axis) {
      btVector3 u(0, 0, 0);
      u[axis] = 1;
      for (const bool twist : {false, true}) {
        SCOPED_TRACE(testing::Message() << (twist ? "torque " : "force ") << "xyz"[axis]
                                        << (static_a ? ", static" : ""));
        const btVector3 force = twist ? btVector3(0, 0, 0) : u, torque = u - force;
        const int stock = stepOfBreaking(Rig<Stock>(static_a), force, torque);
        const int ours = stepOfBreaking(Rig<FixedJoint>(static_a), force, torque);
        EXPECT_GT(stock, 0);
        // Two free bodies tumble under the load, and stock's joint is stretched by then. (The exact solver's is not. Its force along x
        // has a peak just below the threshold, which it misses, and that along z comes there three steps later.)
        EXPECT_NEAR(ours, stock, static_a ? 1 : onExactSolver() ? 3 : 2);
      }
    }
  }
}

TEST(DropInFixed, ADisabledJointLetsGoAndHoldsAgain) {
  Rig<FixedJoint> rig(true);
  rig.joint.setEnabled(false);
  rig.b.setAngularVelocity(vec(2, 1, 3));
  rig.b.setLinearVelocity(vec(0, 0, 0.5));
  rig.step(60);
  EXPECT_GT(scenes::angle_between(rig.a, rig.b), 1);
  rig.joint.setEnabled(true);
  rig.step(120);
  EXPECT_LT(scenes::angle_between(rig.a, rig.b), 1e-3);
  expectNear(rig.b.getCenterOfMassPosition(), vec(1, 0, 0), 1e-3);
}

TEST(FixedJoint, OneBodyIsFixedToTheWorldWhereItIs) {
  Random random(2);
  scenes::World world;
  const btTransform pose = random.pose(2), frame = random.pose(1);
  btRigidBody& body = world.add_box(1, vec(0.5, 0.2, 0.1), pose);
  auto& joint = world.add_joint<FixedJoint>(body, frame);
  EXPECT_EQ(&joint.getRigidBodyB(), &btTypedConstraint::getFixedBody());
  expectNear(joint.getCalculatedTransformA(), joint.getCalculatedTransformB(), 1e-5);
  for (int i = 0; i < 300; ++i) world.step(1.0 / 60);
  expectNear(body.getCenterOfMassTransform(), pose, physics::rounding(1e-4, 1e-10));
}

TEST(FixedJoint, AngularOnlyLocksTheOrientationOnly) {
  Rig<FixedJoint> rig(true);
  rig.joint.setAngularOnly(true);
  EXPECT_EQ(SolverRows::ofStep(rig.joint).announced(), 3);
  rig.b.setLinearVelocity(vec(1, 2, 3));
  rig.b.setAngularVelocity(vec(1, 2, 3));
  rig.step(60);
  // It goes its way without turning.
  expectNear(rig.b.getCenterOfMassPosition(), vec(2, 2, 3), 1e-3);
  EXPECT_LT(scenes::angle_between(rig.a, rig.b), 1e-3);
}

// --- physics -------------------------------------------------------------------------------------

// Links fixed end to end stick out from the world: how far the tip sags at most in two seconds.
template <class Joint>
double sag(int links, int iterations, double load) {
  scenes::World world(scenes::standard_gravity, iterations);
  btRigidBody* last = &world.add_box(0, vec(0.5, 0.1, 0.1), pose_at(vec(0, 0, 0)));
  for (int i = 1; i <= links; ++i) {
    btRigidBody& next =
        world.add_box(i == links ? load : 1, vec(0.5, 0.1, 0.1), pose_at(vec(i, 0, 0)));
    world.add_joint<Joint>(*last, next, pose_at(vec(0.5, 0, 0)), pose_at(vec(-0.5, 0, 0)));
    last = &next;
  }
  double most = 0;
  for (int i = 0; i < 120; ++i) {
    world.step(1.0 / 60);
    most = std::max(most, -scenes::position(*last).z());
  }
  return most;
}

TEST(FixedJointPhysics, ABeamSagsLessThanStocks) {
  for (const int links : {1, 2, 4}) {
    for (const int iterations : {4, 10, 50}) {
      for (const double load : {1., 10.}) {
        SCOPED_TRACE(testing::Message()
                     << links << " links, " << iterations << " iterations, load " << load);
        const double stock = sag<Stock>(links, iterations, load);
        const double ours = sag<FixedJoint>(links, iterations, load);
        RecordProperty("stock", std::to_string(stock));
        RecordProperty("ours", std::to_string(ours));
        EXPECT_LE(ours, stock);
      }
    }
  }
  // One link alone is solved in one pass.
  EXPECT_LT((sag<FixedJoint>(1, 1, 1)), physics::rounding(1e-5, 1e-12));
}

TEST(FixedJointPhysics, APairSpinsAsOneBody) {
  // About the principal axis z of the pair, free: for good at the same speed, with the pair's length.
  const auto run = [](auto&& rig) {
    const double w = 3;
    const btVector3 centre = vec(1.0 / 3, 0, 0);
    for (btRigidBody* body : {&rig.a, &rig.b}) {
      body->setAngularVelocity(vec(0, 0, w));
      body->setLinearVelocity(vec(0, 0, w).cross(body->getCenterOfMassPosition() - centre));
    }
    rig.step(300);
    return std::abs(double(rig.b.getAngularVelocity().z()) - w) / w;
  };
  const double stock = run(Rig<Stock>(false, 10)), ours = run(Rig<FixedJoint>(false, 10));
  // The curvature is foreseen to second order: w dt to the fourth, a step.
  EXPECT_LT(ours, 2e-3);
  EXPECT_LT(ours, stock);
}

TEST(FixedJointPhysics, AViolatedPairKeepsItsAngularMomentum) {
  PINTLE_SKIP_ON_EXACT_SOLVER(
      "bodies that move against each other are brought together by their poses");
  scenes::SpinSettings settings;
  settings.lock = true;
  settings.dt = 1.0 / 240;
  const auto ours = scenes::spin<FixedJoint>(settings);
  const auto stock = scenes::spin<Stock>(settings);
  // What Bullet's integrator of the free motion takes at this step; its error is of first order.
  EXPECT_LT(ours.momentum_change, 1e-3);
  EXPECT_LT(ours.momentum_change, stock.momentum_change);
  EXPECT_LT(ours.end_error, 1e-3);
}

// --- settings and drawing ------------------------------------------------------------------------

TEST(FixedJoint, RefusesBadSettingsAndStaysAsItWas) {
  Random random(3);
  const auto a = support::body(1, vec(1, 2, 3), random.pose(1));
  const auto b = support::body(1, vec(1, 2, 3), random.pose(1));
  const btTransform good = random.pose(1);
  FixedJoint joint(*a, *b, good, good), twin(*a, *b, good, good);
  const auto expectRefused = [&](auto call, const char* field) {
    SCOPED_TRACE(field);
    std::string message = "accepted";
    try {
      call();
    } catch (const std::invalid_argument& error) {
      message = error.what();
    }
    EXPECT_NE(message.find("FixedJoint"), std::string::npos) << message;
    EXPECT_NE(message.find(field), std::string::npos) << message;
    EXPECT_EQ(SolverRows::ofStep(joint), SolverRows::ofStep(twin));
  };
  for (const btScalar value : {nan_value, infinite, scalar(-1)}) {
    expectRefused([&] { joint.setParam(BT_CONSTRAINT_STOP_ERP, value, 2); }, "STOP_ERP");
    expectRefused([&] { joint.setParam(BT_CONSTRAINT_STOP_CFM, value, 5); }, "STOP_CFM");
    expectRefused([&] { joint.setMaxCorrectionSpeed(value); }, "correction speed");
  }
  btTransform bad = good;
  bad.getOrigin().setX(nan_value);
  expectRefused([&] { joint.setFrames(bad, good); }, "frameInA");
  expectRefused([&] { joint.setFrames(good, bad); }, "frameInB");
}

TEST(FixedJoint, IsDrawnAsItsTwoFrames) {
  Rig<FixedJoint> rig(true);
  EXPECT_EQ(drawing::linesOf(rig.joint, 0), 0);
  EXPECT_EQ(drawing::linesOf(rig.joint, btIDebugDraw::DBG_DrawConstraints), 6);
}

// --- rows ----------------------------------------------------------------------------------------

TEST(FixedJoint, RowsAreUnitAtAnyErrorAndTheirErrorIsTheShortestTurn) {
  Random random(4);
  for (int n = 0; n < 300; ++n) {
    const btTransform frame_a = random.pose(1), frame_b = random.pose(1);
    const auto a = support::body(1, vec(1, 2, 3), random.pose(1));
    const btVector3 axis = random.unit();
    const double angle = n % 3 == 0 ? pi : random.uniform(0, pi);
    btTransform b_frame = a->getCenterOfMassTransform() * frame_a;
    b_frame.setBasis(btMatrix3x3(btQuaternion(axis, scalar(angle))) * b_frame.getBasis());
    const auto b = support::body(1, vec(1, 2, 3), b_frame * frame_b.inverse());
    FixedJoint joint(*a, *b, frame_a, frame_b);
    pintle::RowMemory<6, 8> memory;
    pintle::Rows rows(memory);
    joint.addRows(pintle::BodyPair(*a, *b), rows);
    ASSERT_EQ(rows.size(), 6);
    btVector3 phi, most;
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(rows[i].A_b, pintle::Vec3(pintle::Vec3::Unit(i)));
      EXPECT_TRUE(rows[i].angular);
      phi[i] = rows[i].position;
      most[i] = rows[i].max_speed;
    }
    const double rounding = physics::rounding(1e-5, 1e-13);
    EXPECT_NEAR(phi.length(), angle, rounding);
    const double side = n % 3 == 0 && phi.dot(axis) < 0 ? -1 : 1;
    // Near pi the axis has half of the digits' rounding only, 1 / |w| of it.
    expectNear(phi, axis * scalar(side * angle), physics::rounding(2e-3, 1e-7));
    // The bound is along the error, and 8 rad/s in all.
    if (angle > 0.01) {
      EXPECT_NEAR(most.length(), 8, 1e-4);
    }
  }
}

}  // namespace fixed_joint_test
