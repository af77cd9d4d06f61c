// What drives a hinge: velocity motor, servo and friction, alone, together and against a limit.
#include <algorithm>
#include <limits>
#include <tuple>

#include "physics_support.h"

namespace motor_test {

using physics::HingeRig;
using physics::Partner;
using physics::pi;
using physics::RigSettings;
using physics::rounding;

using Rig = HingeRig<>;

RigSettings settings_of(Partner partner, bool reference_a, double dt = 1. / 60) {
  RigSettings settings;
  settings.partner = partner;
  settings.reference_a = reference_a;
  settings.centred_a = partner == Partner::free;
  settings.dt = dt;
  return settings;
}

using Setup = std::tuple<Partner, bool>;

std::string setup_name(const testing::TestParamInfo<Setup>& tested) {
  return to_string(std::get<0>(tested.param)) + (std::get<1>(tested.param) ? "ReferenceA" : "");
}

class Motor : public testing::TestWithParam<Setup> {
 protected:
  RigSettings settings(double dt = 1. / 60) const {
    return settings_of(std::get<0>(GetParam()), std::get<1>(GetParam()), dt);
  }
};

// N m s: what one step changed of the motion along the hinge angle, less what was applied to it.
class Momentum {
 public:
  explicit Momentum(const Rig& rig) : rig_(rig), speed_(rig.speed()) {}
  double change(double load) {
    const double before = speed_;
    speed_ = rig_.speed();
    return rig_.inertia() * (speed_ - before) - load * rig_.dt();
  }

 private:
  const Rig& rig_;
  double speed_;
};

double motor(const Rig& rig) { return double(const_cast<Rig&>(rig).hinge().getMotorImpulse()); }
double friction(const Rig& rig) {
  return double(const_cast<Rig&>(rig).hinge().getFrictionImpulse());
}
double limit(const Rig& rig) { return double(const_cast<Rig&>(rig).hinge().getLimitImpulse()); }

// --- velocity motor ------------------------------------------------------------------------------

TEST_P(Motor, ReachesItsVelocityAndThenHasNothingToDo) {
  for (const double target : {3., -3.}) {
    Rig rig(settings());
    rig.hinge().enableAngularMotor(true, btScalar(target), 1);
    for (int step = 0; step < 120; ++step) rig.step();
    // What the position rows lose or gain in a step at 0.05 rad, the motor makes good.
    EXPECT_NEAR(rig.speed(), target, rounding(1e-4, 1e-6) * 3);
    EXPECT_NEAR(motor(rig), 0, 0.01);
  }
}

TEST_P(Motor, SaturatesAtItsLargestImpulse) {
  for (const double way : {1., -1.}) {
    Rig rig(settings());
    const double impulse = 0.002;
    rig.hinge().enableAngularMotor(true, btScalar(way * 100), btScalar(impulse));
    for (int step = 1; step <= 30; ++step) {
      rig.step();
      EXPECT_NEAR(rig.speed(), way * step * impulse / rig.inertia(),
                  rounding(1e-4, 1e-5) * step * impulse / rig.inertia());
      EXPECT_NEAR(motor(rig), way * impulse, rounding(1e-6, 1e-12) * impulse);
      EXPECT_EQ(friction(rig), 0);
      EXPECT_EQ(limit(rig), 0);
    }
  }
}

TEST_P(Motor, HoldsALoadUpToItsLargestImpulse) {
  for (const double load : {-4.9, 5.5}) {
    Rig rig(settings());
    rig.hinge().enableAngularMotor(true, 0, btScalar(5 * rig.dt()));
    for (int step = 0; step < 12; ++step) {
      rig.push(load);
      rig.step();
    }
    if (std::abs(load) < 5) {
      EXPECT_NEAR(rig.speed(), 0, 1e-5);
      EXPECT_NEAR(motor(rig), -load * rig.dt(), 1e-5);
    } else {
      EXPECT_NEAR(rig.speed(), 0.5 / rig.inertia() * 12 * rig.dt(), 0.01 * rig.speed());
      EXPECT_NEAR(motor(rig), -5 * rig.dt(), 1e-6);
    }
  }
}

// --- servo ---------------------------------------------------------------------------------------

TEST_P(Motor, ServoGoesToItsTargetOverSeveralTurnsWithoutBeingCalledAgain) {
  for (const double turns : {3.5, -3.5, 0.5}) {
    Rig rig(settings());
    rig.hinge().setMotorServo(btScalar(turns * 2 * pi), 1, 1, 20);
    for (int step = 0; step < 60 * 20; ++step) rig.step();
    EXPECT_NEAR(rig.angle(), turns * 2 * pi, 1e-4);
    EXPECT_NEAR(rig.speed(), 0, 1e-4);
  }
}

TEST_P(Motor, ServoCarriesAWeightAtItsStiffness) {
  if (std::get<0>(GetParam()) == Partner::free) return;  // nothing to stand on
  const double target = 3.5 * 2 * pi, frequency = 2, w = 2 * pi * frequency;
  Rig rig(settings());
  btRigidBody& body = rig.a().getInvMass() > 0 ? rig.a() : rig.b();
  rig.hinge().setMotorServo(btScalar(target), btScalar(frequency), 1, 200);
  const double weight = Rig::mass * scenes::standard_gravity;
  for (int step = 0; step < 60 * 20; ++step) {
    body.applyCentralForce(physics::vector(0, -weight, 0));
    rig.step();
  }
  // Along the hinge angle: the weight's torque about z, times the way in which the body turns it.
  const double turns_it = &body == &rig.a() ? rig.sign() : -rig.sign();
  const double torque = -turns_it * weight * scenes::position(body).x();
  const double stiffness = rig.inertia() * w * w;
  EXPECT_NEAR(rig.speed(), 0, 1e-4);
  EXPECT_NEAR(stiffness * (rig.angle() - target), torque, 0.01 * weight * 0.3);
  EXPECT_NEAR(motor(rig), -torque * rig.dt(), 0.001 * weight * 0.3 * rig.dt());
}

TEST_P(Motor, ServoSaturatesAtItsLargestTorque) {
  for (const double way : {1., -1.}) {
    Rig rig(settings());
    const double torque = 0.12;
    rig.hinge().setMotorServo(btScalar(way * 50), 5, 1, btScalar(torque));
    for (int step = 1; step <= 30; ++step) {
      rig.step();
      const double speed = step * torque * rig.dt() / rig.inertia();
      EXPECT_NEAR(rig.speed(), way * speed, rounding(1e-4, 1e-5) * speed);
      EXPECT_NEAR(motor(rig), way * torque * rig.dt(), 1e-6 * torque);
    }
  }
}

TEST_P(Motor, ServoBeyondALimitPressesOnIt) {
  for (const double way : {1., -1.}) {
    Rig rig(settings());
    const double stop = 2.5 * pi, beyond = 0.5, w = 2 * pi;
    rig.hinge().setLimit(btScalar(-stop), btScalar(stop));
    rig.hinge().setMotorServo(btScalar(way * (stop + beyond)), 1, 1, 100);
    double away = 0;
    for (int step = 0; step < 60 * 40; ++step) {
      rig.step();
      if (step > 60 * 10) away = std::max(away, std::abs(rig.angle() - way * stop));
    }
    const double torque = rig.inertia() * w * w * beyond;
    EXPECT_LT(away, 1e-4) << "it does not stay there";
    EXPECT_NEAR(rig.angle(), way * stop, 1e-4);
    EXPECT_NEAR(rig.speed(), 0, 1e-4);
    EXPECT_NEAR(motor(rig), way * torque * rig.dt(), 0.001 * torque * rig.dt());
    EXPECT_NEAR(limit(rig), -way * torque * rig.dt(), 0.001 * torque * rig.dt());
  }
}

TEST_P(Motor, ServoStopsWhereFrictionHoldsIt) {
  for (const double way : {1., -1.}) {
    Rig rig(settings());
    const double w = 2 * pi, stiffness = rig.inertia() * w * w, held = 0.2;
    rig.hinge().setFriction(btScalar(stiffness * held));
    // A spring that friction can hold moves nothing.
    rig.hinge().setMotorServo(btScalar(way * 0.9 * held), 1, 0.2, 100);
    for (int step = 0; step < 120; ++step) rig.step();
    EXPECT_NEAR(rig.angle(), 0, 1e-5);
    EXPECT_NEAR(motor(rig), way * 0.9 * held * stiffness * rig.dt(), 1e-4 * stiffness * rig.dt());
    EXPECT_NEAR(friction(rig), -motor(rig), 1e-4 * stiffness * rig.dt());
    // One that it cannot hold moves to where it can.
    rig.hinge().setMotorServo(btScalar(way * 2), 1, 0.2, 100);
    for (int step = 0; step < 600; ++step) rig.step();
    EXPECT_NEAR(rig.speed(), 0, 1e-5);
    EXPECT_LT(std::abs(rig.angle() - way * 2), held * 1.001);
    EXPECT_NEAR(friction(rig), -motor(rig), 1e-4 * stiffness * rig.dt());
  }
}

class Servo : public testing::TestWithParam<physics::SpringCase> {};

TEST_P(Servo, StepResponseIsThatOfImplicitEuler) {
  const auto [frequency_, damping_ratio, partner, rate] = GetParam();
  const double frequency = std::min(frequency_, rate), w = 2 * pi * frequency, h = 1 / rate;
  // 0.02 rad a step at most.
  const double target = std::min(0.5, 0.02 / (h * w) * (1 + h * w));
  const int steps = int(std::min(1500., std::max(60., 2 * rate / frequency)));
  for (const bool reference_a : {false, true}) {
    Rig rig(settings_of(partner, reference_a, h));
    rig.hinge().setMotorServo(btScalar(target), btScalar(frequency), btScalar(damping_ratio), 1000);
    const double share = rig.springShare(w);
    double x = 0, v = 0, error = 0;
    for (int step = 0; step < steps; ++step) {
      rig.step();
      v = (v + h * w * w * (target - x)) / (1 + 2 * damping_ratio * w * h + share * w * w * h * h);
      x += h * v;
      error = std::max(error, std::abs(rig.angle() - x));
    }
    EXPECT_LT(error, 0.01 * target);
  }
}

INSTANTIATE_TEST_SUITE_P(Springs, Servo, physics::springCases(), physics::springName);

TEST_P(Motor, ServoOfUnboundedTorqueIsThatOfALargeOne) {
  for (const btScalar unbounded : {SIMD_INFINITY, std::numeric_limits<btScalar>::infinity()}) {
    Rig rig(settings()), bounded(settings());
    rig.hinge().setMotorServo(1, 1, 1, unbounded);
    bounded.hinge().setMotorServo(1, 1, 1, 1000);
    for (int step = 0; step < 120; ++step) {
      rig.step();
      bounded.step();
      ASSERT_NEAR(rig.angle(), bounded.angle(), 1e-5) << "step " << step;
    }
  }
}

// --- friction ------------------------------------------------------------------------------------

TEST_P(Motor, FrictionDeceleratesByItsTorqueAndThenHolds) {
  for (const double way : {1., -1.}) {
    Rig rig(settings());
    const double torque = 0.1, start = 0.5, a = torque / rig.inertia();
    rig.spin(way * start);
    rig.hinge().setFriction(btScalar(torque));
    const int stop = int(std::ceil(start / a / rig.dt()));
    for (int step = 1; step <= stop + 60; ++step) {
      rig.step();
      const double speed = std::max(0., start - step * rig.dt() * a);
      EXPECT_NEAR(rig.speed(), way * speed, rounding(1e-4, 1e-4) * start) << "step " << step;
      if (step < stop) {
        EXPECT_NEAR(friction(rig), -way * torque * rig.dt(), 1e-5 * torque);
      }
    }
    EXPECT_NEAR(friction(rig), 0, 1e-5 * torque);
  }
}

TEST_P(Motor, FrictionHoldsASmallerLoadAndSlipsUnderALarger) {
  for (const double way : {1., -1.}) {
    for (const double load : {0.09, 0.11}) {
      Rig rig(settings());
      const double torque = 0.1;
      rig.hinge().setFriction(btScalar(torque));
      for (int step = 0; step < 60; ++step) {
        rig.push(way * load);
        rig.step();
      }
      const double speed = std::max(0., load - torque) / rig.inertia();  // after 1 s
      EXPECT_NEAR(rig.speed(), way * speed, 1e-5 + 1e-4 * speed);
      EXPECT_NEAR(friction(rig), -way * std::min(load, torque) * rig.dt(), 1e-5 * torque);
    }
  }
}

TEST_P(Motor, UnboundedFrictionHoldsAnyLoad) {
  for (const btScalar unbounded : {SIMD_INFINITY, std::numeric_limits<btScalar>::infinity()}) {
    Rig rig(settings());
    rig.hinge().setFriction(unbounded);
    for (int step = 0; step < 60; ++step) {
      rig.push(1000);
      rig.step();
    }
    // A rigid row gives way by nothing.
    EXPECT_NEAR(rig.speed(), 0, 1e-3);
    EXPECT_NEAR(friction(rig), -1000 * rig.dt(), 0.001);
  }
}

// --- all together --------------------------------------------------------------------------------

TEST_P(Motor, MotorFrictionAndLimitEachReportTheirImpulse) {
  RigSettings centred = settings();
  centred.offset = 0;  // the position rows then have no part in the motion along the hinge
  for (const double way : {1., -1.}) {
    Rig rig(centred);
    const double motor_impulse = 0.01, friction_torque = 0.15, load = way * 0.2;
    rig.hinge().setLimit(-1, 1);
    rig.hinge().enableAngularMotor(true, btScalar(way * 100), btScalar(motor_impulse));
    rig.hinge().setFriction(btScalar(friction_torque));
    rig.hinge().enableFeedback(true);
    Momentum momentum(rig);
    bool free_run = false, pressed = false;
    for (int step = 0; step < 600; ++step) {
      const double distance = 1 - way * rig.angle();
      rig.push(load);
      rig.step();
      const double sum = motor(rig) + friction(rig) + limit(rig);
      // The parts make up all that acts along the hinge. Bullet knows the last one's row: the limit's, if it acts.
      EXPECT_NEAR(sum, momentum.change(load), 1e-4 * (motor_impulse + std::abs(sum)) + 1e-5);
      const double applied = std::abs(double(rig.hinge().getAppliedImpulse()));
      if (limit(rig) != 0) {
        EXPECT_NEAR(applied, std::abs(limit(rig)), 1e-6);
      } else if (distance > 0.5) {  // far from the limit, which has no row there
        EXPECT_NEAR(applied, std::abs(motor(rig)), 1e-6);
      }
      EXPECT_LE(std::abs(friction(rig)), friction_torque * rig.dt() + 1e-6);
      EXPECT_LE(std::abs(motor(rig)), motor_impulse + 1e-6);
      EXPECT_LE(way * limit(rig), 1e-6) << "a limit does not pull";
      if (distance > 0.5) {
        EXPECT_NEAR(motor(rig), way * motor_impulse, 1e-6);
        EXPECT_NEAR(friction(rig), -way * friction_torque * rig.dt(), 1e-6);
        EXPECT_EQ(limit(rig), 0);
        free_run = true;
      }
      if (step > 500) {
        EXPECT_NEAR(way * rig.angle(), 1, 1e-4);
        // As in Bullet a motor's target is 0 at a limit: it then brakes, as friction does, and how
        // these three share the load is not certain.
        EXPECT_NEAR(sum, -load * rig.dt(), 1e-5);
        pressed = true;
      }
    }
    EXPECT_TRUE(free_run && pressed);
  }
}

TEST_P(Motor, ReportsZeroWhenNothingActs) {
  Rig rig(settings());
  const auto expect_zero = [&] {
    EXPECT_EQ(motor(rig), 0);
    EXPECT_EQ(friction(rig), 0);
    EXPECT_EQ(limit(rig), 0);
  };
  rig.spin(1);
  expect_zero();
  rig.hinge().setLimit(-2, 2);
  rig.step();
  expect_zero();
  // And again zero after something did.
  rig.hinge().enableAngularMotor(true, 5, 1);
  rig.hinge().setFriction(btScalar(0.1));
  rig.step();
  EXPECT_NE(motor(rig), 0);
  rig.hinge().enableMotor(false);
  rig.hinge().setFriction(0);
  rig.step();
  expect_zero();
}

INSTANTIATE_TEST_SUITE_P(Setups, Motor,
                         testing::Combine(testing::Values(Partner::fixed_b, Partner::fixed_a,
                                                          Partner::free),
                                          testing::Bool()),
                         setup_name);

}  // namespace motor_test
