// Programs that are compiled with -ffast-math compile the joints so, too: what is not a number is refused all the same, and a step
// writes nothing of it.
#include <pintle/finite.h>
#include <pintle/pintle.h>
#include <pintle/solver/solver_options.h>

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <stdexcept>
#include <vector>

#ifndef __FAST_MATH__
#error "is to be compiled with -ffast-math"
#endif

namespace {

using namespace pintle;

// Where the compiler cannot see what they are.
volatile btScalar nan_value = std::numeric_limits<btScalar>::quiet_NaN();
volatile btScalar infinite = std::numeric_limits<btScalar>::infinity();

struct Setting {
  const char* name;
  std::function<void(btScalar)> call;
  bool takes_infinity = false;
};

bool isRefused(const std::function<void(btScalar)>& call, btScalar value) {
  try {
    call(value);
  } catch (const std::invalid_argument&) {
    return true;
  }
  return false;
}

class FastMath : public testing::Test {
 protected:
  btRigidBody a{btRigidBody::btRigidBodyConstructionInfo(1, nullptr, nullptr, btVector3(1, 1, 1))};
  btRigidBody b{btRigidBody::btRigidBodyConstructionInfo(1, nullptr, nullptr, btVector3(1, 1, 1))};
  btTransform frame = btTransform::getIdentity();
  QuaternionHinge hinge{a, b, frame, frame};
  BallJoint ball{a, b, btVector3(0, 0, 0), btVector3(0, 0, 0)};
  SliderJoint slider{a, b, frame, frame, true};
  ConeTwistJoint cone_twist{a, b, frame, frame};
  UniversalJoint universal{a, b, btVector3(0, 0, 0), btVector3(0, 0, 1), btVector3(0, 1, 0)};
  FixedJoint fixed{a, b, frame, frame};
  ConstantVelocityJoint constant_velocity{a, b, frame, frame};
};

TEST(Finite, IsToldByBits) {
  EXPECT_FALSE(isFinite(double(nan_value)));
  EXPECT_FALSE(isFinite(float(-infinite)));
  EXPECT_FALSE(isNumber(double(-nan_value)));
  EXPECT_FALSE(isNumber(float(nan_value)));
  EXPECT_TRUE(isNumber(double(infinite)));
  EXPECT_TRUE(isNumber(float(-infinite)));
  for (const double x : {0., -0., 5e-324, -1., std::numeric_limits<double>::max()})
    EXPECT_TRUE(isFinite(x)) << x;
  for (const float x : {0.f, -0.f, 1e-45f, -1.f, std::numeric_limits<float>::max()})
    EXPECT_TRUE(isFinite(x)) << x;
}

TEST_F(FastMath, RefusesWhatIsNotFinite) {
  const std::vector<Setting> settings = {
      {"hinge servo frequency", [&](btScalar x) { hinge.setMotorServo(1, x, 1, 1); }},
      {"hinge servo torque", [&](btScalar x) { hinge.setMotorServo(1, 1, 1, x); }, true},
      {"hinge friction", [&](btScalar x) { hinge.setFriction(x); }, true},
      {"hinge limit spring", [&](btScalar x) { hinge.setLimitSpring(x, 1); }},
      {"correction speed", [&](btScalar x) { hinge.setMaxCorrectionSpeed(x); }},
      {"cone-twist swing", [&](btScalar x) { cone_twist.setSwingLimits(-1, 1, -1, x); }, true},
      {"cone-twist twist", [&](btScalar x) { cone_twist.setTwistLimit(-1, x); }},
      {"universal limit", [&](btScalar x) { universal.setUpperLimit(x, 1); }, true},
      {"universal bounce", [&](btScalar x) { universal.setLimitBounce(5, x); }},
      {"fixed limit", [&](btScalar x) { fixed.setLinearLowerLimit(btVector3(0, x - 1, 0)); }},
      {"bend limit", [&](btScalar x) { constant_velocity.setBendLimit(x); }, true},
      {"bend servo", [&](btScalar x) { constant_velocity.setBendServo(x, 1, 1, 1); }},
      {"solver's tolerance",
       [](btScalar x) {
         SolverOptions options;
         options.pose_tolerance = double(x);
         check(options);
       }},
  };
  for (const Setting& setting : settings) {
    SCOPED_TRACE(setting.name);
    EXPECT_TRUE(isRefused(setting.call, nan_value));
    EXPECT_TRUE(isRefused(setting.call, -nan_value));
    if (!setting.takes_infinity) {
      EXPECT_TRUE(isRefused(setting.call, infinite));
    }
    EXPECT_FALSE(isRefused(setting.call, 1)) << "a test that cannot pass";
  }
}

// Bullet's own methods take it. It is not used, and the joint says so.
TEST_F(FastMath, DoesNotUseWhatIsNotFinite) {
  hinge.setLimit(-1, 1);
  hinge.enableAngularMotor(true, 1, 1);
  const std::vector<Setting> settings = {
      {"limit", [&](btScalar x) { hinge.setLimit(x, 1); }, true},
      {"bias", [&](btScalar x) { hinge.setLimit(-1, 1, 1, x); }},
      {"motor velocity", [&](btScalar x) { hinge.enableAngularMotor(true, x, 1); }},
      {"motor bound", [&](btScalar x) { hinge.setMaxMotorImpulse(x); }, true},
      {"motor target", [&](btScalar x) { hinge.setMotorTarget(x, 1); }, true},
      {"motor target's dt", [&](btScalar x) { hinge.setMotorTarget(1, x); }, true},
      {"axis",
       [&](btScalar x) {
         btVector3 axis(0, x, 1);
         hinge.setAxis(axis);
       }},
      {"ERP", [&](btScalar x) { hinge.setParam(BT_CONSTRAINT_STOP_ERP, x); }},
      {"CFM", [&](btScalar x) { hinge.setParam(BT_CONSTRAINT_CFM, x); }},
      {"frame",
       [&](btScalar x) {
         hinge.setFrames(btTransform(btQuaternion(0, 0, 0, 1), btVector3(x, 0, 0)), frame);
       }},
  };
  const std::vector<Setting> of_ball = {
      {"pivot", [&](btScalar x) { ball.setPivotA(btVector3(0, 0, x)); }},
      {"ERP", [&](btScalar x) { ball.setParam(BT_CONSTRAINT_ERP, x); }},
      {"damping", [&](btScalar x) { ball.m_setting.m_damping = x; }},
      {"impulse clamp", [&](btScalar x) { ball.m_setting.m_impulseClamp = x; }, true},
  };
  const auto check = [](Joint& joint, const std::vector<Setting>& all) {
    for (const Setting& setting : all) {
      SCOPED_TRACE(setting.name);
      setting.call(nan_value);
      EXPECT_NE(joint.whyIgnored(), "");
      if (!setting.takes_infinity) {
        setting.call(infinite);
        EXPECT_NE(joint.whyIgnored(), "");
      }
      setting.call(1);
      EXPECT_EQ(joint.whyIgnored(), "");
    }
  };
  slider.setPoweredLinMotor(true);
  const std::vector<Setting> of_slider = {
      {"lower limit", [&](btScalar x) { slider.setLowerLinLimit(x); }, true},
      {"upper angle", [&](btScalar x) { slider.setUpperAngLimit(x); }, true},
      {"motor", [&](btScalar x) { slider.setTargetLinMotorVelocity(x); }},
      {"motor bound", [&](btScalar x) { slider.setMaxLinMotorForce(x); }, true},
      {"damping", [&](btScalar x) { slider.setDampingLimLin(x); }},
  };
  cone_twist.enableMotor(true);
  const std::vector<Setting> of_cone_twist = {
      {"span", [&](btScalar x) { cone_twist.setLimit(x, 1, 1); }, true},
      {"span by its index", [&](btScalar x) { cone_twist.setLimit(3, x); }, true},
      {"bias", [&](btScalar x) { cone_twist.setLimit(1, 1, 1, 1, x); }},
      {"fix threshold", [&](btScalar x) { cone_twist.setFixThresh(x); }},
      {"target", [&](btScalar x) { cone_twist.setMotorTarget(btQuaternion(0, x, 0, 1)); }},
      {"motor bound", [&](btScalar x) { cone_twist.setMaxMotorImpulse(x); }, true},
      {"ERP", [&](btScalar x) { cone_twist.setParam(BT_CONSTRAINT_ERP, x, 0); }},
  };
  check(hinge, settings);
  check(cone_twist, of_cone_twist);
  check(slider, of_slider);
  check(ball, of_ball);
}

TEST_F(FastMath, ABodyThatIsNotFiniteGetsNoRows) {
  btTypedConstraint* const joints[] = {&hinge,     &ball,  &slider,           &cone_twist,
                                       &universal, &fixed, &constant_velocity};
  const auto rows = [&](btTypedConstraint* joint) {
    btTypedConstraint::btConstraintInfo1 info{};
    joint->buildJacobian();
    joint->getInfo1(&info);
    return info.m_numConstraintRows;
  };
  for (btTypedConstraint* const joint : joints) EXPECT_GT(rows(joint), 0);
  a.setAngularVelocity(btVector3(0, btScalar(nan_value), 0));
  for (btTypedConstraint* const joint : joints) EXPECT_EQ(rows(joint), 0);
  a.setAngularVelocity(btVector3(0, 0, 0));
  a.setCenterOfMassTransform(
      btTransform(btQuaternion(0, 0, 0, 1), btVector3(0, btScalar(infinite), 0)));
  for (btTypedConstraint* const joint : joints) EXPECT_EQ(rows(joint), 0);
}

}  // namespace
