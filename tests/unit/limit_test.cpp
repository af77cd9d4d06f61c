// Limits of the hinge over any number of turns, the angle that they need counted, and limits as
// springs.
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>

#include <algorithm>
#include <random>
#include <tuple>

#include "physics_support.h"
#include "solver_of_tests.h"

namespace limit_test {

using physics::angle_name;
using physics::degrees;
using physics::HingeRig;
using physics::Partner;
using physics::pi;
using physics::radians;
using physics::RigSettings;
using physics::rounding;

using Rig = HingeRig<>;

// rad: what a step may leave of a limit that it reaches at speed.
constexpr double reached = 1e-4;

struct Range {
  double low, high, start;  // degrees
};

std::ostream& operator<<(std::ostream& out, const Range& r) {
  return out << angle_name(r.low) << "to" << angle_name(r.high);
}

constexpr Range ranges[] = {{-30, 50, 0},     {-180, 180, 0},     {-270, 270, 0},
                            {-360, 360, 0},   {-720, 720, 0},     {0, 720, 90},
                            {-1800, 1800, 0}, {-100, 400, 0},     {-1000, 20, -170},
                            {400, 700, 500},  {-900, -500, -600}, {3590, 3610, 3600}};

// A rig that stands inside of the range, in the right turn, with the limit set.
Rig& limit(Rig& rig, const Range& range) {
  rig.hinge().setAccumulatedHingeAngle(btScalar(radians(range.start)));
  rig.hinge().setAccumulatedLimit(btScalar(radians(range.low)), btScalar(radians(range.high)));
  return rig;
}

RigSettings at(const Range& range, Partner partner, bool reference_a) {
  RigSettings settings;
  settings.partner = partner;
  settings.reference_a = reference_a;
  settings.start = std::remainder(radians(range.start), 2 * pi);
  if (partner == Partner::kinematic) settings.kinematic_speed = 1.5;
  return settings;
}

// The true angle of a rig, from the turn in which it was set up.
class TrueAngle {
 public:
  TrueAngle(const Rig& rig, double start) : rig_(rig), offset_(start - rig.angle()) {}
  double operator()() const { return rig_.angle() + offset_; }

 private:
  const Rig& rig_;
  double offset_;
};

enum class Drive { torque, motor };

using Case = std::tuple<Range, Partner, bool, Drive>;

std::string case_name(const testing::TestParamInfo<Case>& tested) {
  const auto& [range, partner, reference_a, drive] = tested.param;
  return testing::PrintToString(range) + to_string(partner) + (reference_a ? "ReferenceA" : "") +
         (drive == Drive::torque ? "ByTorque" : "ByMotor");
}

class Limit : public testing::TestWithParam<Case> {};

TEST_P(Limit, HoldsAtBothEndsAndIsNeverPassed) {
  const auto& [range, partner, reference_a, drive] = GetParam();
  Rig rig(at(range, partner, reference_a));
  const double start =
      radians(range.start) + (rig.angle() - std::remainder(radians(range.start), 2 * pi));
  limit(rig, range);
  const TrueAngle angle(rig, start);
  const double low = radians(range.low), high = radians(range.high);
  EXPECT_EQ(rig.hinge().getLowerLimit(), btScalar(low));
  EXPECT_EQ(rig.hinge().getUpperLimit(), btScalar(high));
  EXPECT_TRUE(rig.hinge().hasLimit());

  double last = angle(), overshoot = 0, reading = 0, jump = 0;
  for (const double way : {1., -1.}) {
    for (int step = 0; step < 600; ++step) {
      if (drive == Drive::torque) {
        rig.push(way * 5);
      } else {
        rig.hinge().enableAngularMotor(true, btScalar(way * 15), btScalar(0.5));
      }
      rig.step();
      overshoot = std::max({overshoot, angle() - high, low - angle()});
      reading =
          std::max(reading, std::abs(double(rig.hinge().getAccumulatedHingeAngle()) - angle()));
      jump = std::max(jump, std::abs(angle() - last));
      last = angle();
    }
    EXPECT_NEAR(angle(), way > 0 ? high : low, 1e-3) << "is where it comes to rest";
  }
  // Bullet measures the speed of a kinematic body by an arc cosine: in single precision it is off
  // by 1e-5 rad a step, which piles up until the limit takes back as much (bias times ERP: 6 % a
  // step).
  const bool coarse = partner == Partner::kinematic && physics::single_precision;
  // Of a motor and the limit against which it drives, the exact solver leaves as much again.
  EXPECT_LT(overshoot, coarse ? onExactSolver() ? 2e-3 : 5e-4 : reached);
  // Of two bodies that turn by a quarter of pi each, as far as Bullet turns one in a step. (The exact solver moves poses beside that.)
  EXPECT_LT(jump, onExactSolver() ? 2 : pi / 2) << "a flip";
  EXPECT_LT(reading, reached);
}

INSTANTIATE_TEST_SUITE_P(Ranges, Limit,
                         testing::Combine(testing::ValuesIn(ranges),
                                          testing::Values(Partner::fixed_b, Partner::fixed_a,
                                                          Partner::free, Partner::kinematic),
                                          testing::Bool(),
                                          testing::Values(Drive::torque, Drive::motor)),
                         case_name);

// A new limit of less than a turn holds in the turn of the joint; the pose tells the turn.
TEST(LimitOfLessThanATurn, HoldsInTheTurnOfTheJointWithoutBeingTold) {
  for (const Range& range :
       {Range{400, 700, 500}, Range{-900, -700, -800}, Range{3590, 3610, 3600}}) {
    Rig rig(at(range, Partner::fixed_b, false));
    rig.hinge().setAccumulatedLimit(btScalar(radians(range.low)), btScalar(radians(range.high)));
    EXPECT_NEAR(double(rig.hinge().getAccumulatedHingeAngle()), radians(range.start), 1e-4)
        << range;
  }
}

// --- at speed ------------------------------------------------------------------------------------

// The limits at +- so many degrees; rad/s of the body that moves, or of both against each other.
class FastLimit : public testing::TestWithParam<std::tuple<double, double, Partner>> {};

TEST_P(FastLimit, IsEnforcedInTheStepThatReachesIt) {
  const auto [stop, speed, partner] = GetParam();
  for (const double offset : {0., 0.3}) {
    for (const double way : {1., -1.}) {
      RigSettings settings;
      settings.partner = partner;
      settings.offset = offset;
      Rig rig(settings);
      rig.hinge().setLimit(btScalar(-radians(stop)), btScalar(radians(stop)));
      partner == Partner::free ? rig.spin(way * speed, -way * speed) : rig.spin(way * speed);
      double overshoot = -HUGE_VAL, fastest = 0, reading = 0;
      for (int step = 0; step < 120; ++step) {
        rig.step();
        overshoot = std::max(overshoot, std::abs(rig.angle()) - radians(stop));
        reading = std::max(reading,
                           std::abs(double(rig.hinge().getAccumulatedHingeAngle()) - rig.angle()));
        fastest = std::max(fastest, std::abs(rig.speed()));
      }
      SCOPED_TRACE("offset " + std::to_string(offset) + ", way " + std::to_string(way));
      // On the exact solver a pair keeps its speed: it swings about itself so fast that it turns further
      // than its velocity says, past limits that this does not reach.
      const bool swings = onExactSolver() && partner == Partner::free && speed > 100;
      // The exact solver brings such a pair together by poses, of which the count of its turns does not know.
      const bool uncounted = swings && offset > 0 && speed / 60 > pi;
      EXPECT_LT(overshoot, uncounted ? 2 * pi + reached : swings ? 0.02 : reached);
      EXPECT_LT(reading, uncounted ? 7 : reached) << "the count is lost, of that pair by a turn";
      // A rebound is slower than what came. (About a centre: off it, the inertia of a free pair
      // changes with the angle.)
      if (offset == 0) {
        EXPECT_LT(fastest, (partner == Partner::free ? 2 : 1) * speed * 1.001);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Impacts, FastLimit,
                         testing::Combine(testing::Values(0.2865, 20, 89, 100, 150, 200, 800),
                                          testing::Values(3, 30, 60, 90, 110, 200, 1000),
                                          testing::Values(Partner::fixed_b, Partner::fixed_a,
                                                          Partner::free)),
                         [](const auto& tested) {
                           return angle_name(std::get<0>(tested.param)) + "At" +
                                  angle_name(std::get<1>(tested.param)) +
                                  to_string(std::get<2>(tested.param));
                         });

// --- at rest -------------------------------------------------------------------------------------

TEST(LimitAtRest, HoldsStillAgainstAMotorForTenSeconds) {
  for (const Partner partner : {Partner::fixed_b, Partner::fixed_a, Partner::free}) {
    for (const double stop : {0.005, 1., 20.}) {
      for (const double dt : {1. / 60, 1. / 240}) {
        RigSettings settings;
        settings.partner = partner;
        settings.dt = dt;
        Rig rig(settings);
        rig.hinge().setLimit(btScalar(-stop), btScalar(stop));
        rig.hinge().enableAngularMotor(true, 8, btScalar(10 * dt));
        for (int step = 0; step < std::lround(8 / dt); ++step) rig.step();
        const double before = rig.angle();
        double fastest = 0, drift = 0;
        for (int step = 0; step < std::lround(10 / dt); ++step) {
          rig.step();
          fastest = std::max(fastest, std::abs(rig.speed()));
          drift = std::max(drift, std::abs(rig.angle() - before));
        }
        SCOPED_TRACE(to_string(partner) + ", stop " + std::to_string(stop) + ", dt " +
                     std::to_string(dt));
        EXPECT_NEAR(rig.angle(), stop, 1e-3);
        EXPECT_LT(fastest, 1e-3);
        EXPECT_LT(drift, 1e-3);
      }
    }
  }
}

// --- far beyond ----------------------------------------------------------------------------------

class BrokenLimit : public testing::TestWithParam<std::tuple<double, Partner, bool>> {};

TEST_P(BrokenLimit, IsCorrectedTheWayItCame) {
  const auto [angle_now, partner, reference_a] = GetParam();
  RigSettings settings;
  settings.partner = partner;
  settings.reference_a = reference_a;
  Rig rig(settings);
  const double stop = radians(90), start = radians(angle_now), side = start > 0 ? 1 : -1;
  rig.hinge().setLimit(btScalar(-stop), btScalar(stop));
  // A teleport: the moving body turns about the hinge axis, which tells nothing of the turns.
  const double turn = rig.sign() * std::remainder(start, 2 * pi);
  if (partner == Partner::fixed_a) {
    rig.b().setCenterOfMassTransform(physics::about_z(-turn) * rig.b().getCenterOfMassTransform());
  } else {
    rig.a().setCenterOfMassTransform(physics::about_z(turn) * rig.a().getCenterOfMassTransform());
  }
  rig.look();
  rig.hinge().setAccumulatedHingeAngle(btScalar(start));
  const double offset = start - rig.angle();

  double last = start, backward = 0;
  for (int step = 0; step < 600; ++step) {
    rig.step();
    const double now = rig.angle() + offset;
    if (side * last > stop) backward = std::max(backward, side * (now - last));
    last = now;
  }
  // It may rest at the limit, or swing on inside of it.
  EXPECT_LT(std::abs(last), stop + 1e-3);
  EXPECT_LT(backward, 1e-3) << "turned on, away from the limit";
  EXPECT_NEAR(double(rig.hinge().getAccumulatedHingeAngle()), last, reached);
}

INSTANTIATE_TEST_SUITE_P(
    Angles, BrokenLimit,
    testing::Combine(testing::Values(100, 170, 181, 260, 275, 300, 359, 360, 450, 630, 720, 1000,
                                     3600, -200, -300, -450, -1000),
                     testing::Values(Partner::fixed_b, Partner::fixed_a, Partner::free),
                     testing::Bool()),
    [](const auto& tested) {
      return angle_name(std::get<0>(tested.param)) + to_string(std::get<1>(tested.param)) +
             (std::get<2>(tested.param) ? "ReferenceA" : "");
    });

// --- locked, free, half free ---------------------------------------------------------------------

TEST(LockedLimit, HoldsItsAngleInItsTurn) {
  for (const double angle : {0., 0.7, radians(450), radians(-3000)}) {
    for (const Partner partner : {Partner::fixed_b, Partner::fixed_a, Partner::free}) {
      Rig rig(at({0, 0, degrees(angle)}, partner, false));
      limit(rig, {degrees(angle), degrees(angle), degrees(angle)});
      const double before = rig.angle();
      double away = 0;
      for (int step = 0; step < 300; ++step) {
        rig.push(step < 150 ? 20 : -20);
        rig.step();
        away = std::max(away, std::abs(rig.angle() - before));
      }
      // A rigid row yields nothing.
      EXPECT_LT(away, reached) << angle << ' ' << to_string(partner);
    }
  }
}

TEST(FreeLimit, LetsATorqueTurnTheHingeAsIfItWereNotThere) {
  RigSettings settings;
  settings.offset = 0;  // where Bullet's step is symplectic Euler without an error
  Rig rig(settings);
  rig.hinge().setLimit(1, -1);
  EXPECT_FALSE(rig.hinge().hasLimit());
  double angle = 0, speed = 0;
  for (int step = 0; step < 300; ++step) {
    rig.push(1);
    rig.step();
    speed += settings.dt / rig.inertia();
    angle += settings.dt * speed;
  }
  EXPECT_GT(angle, 2 * pi);
  EXPECT_NEAR(rig.angle(), angle, rounding(1e-4, 1e-9) * angle);
}

TEST(HalfFreeLimit, StopsOnlyOnItsFiniteSide) {
  for (const bool upper : {true, false}) {
    for (const btScalar none : {SIMD_INFINITY, std::numeric_limits<btScalar>::infinity()}) {
      Rig rig(RigSettings{});
      const double stop = upper ? 4 : -4, side = upper ? 1 : -1;
      upper ? rig.hinge().setLimit(-none, btScalar(stop))
            : rig.hinge().setLimit(btScalar(stop), none);
      for (int step = 0; step < 200; ++step) {
        rig.push(-side * 5);
        rig.step();
      }
      EXPECT_GT(-side * rig.angle(), 4 * pi) << "its free side is not free";
      double overshoot = -HUGE_VAL;
      for (int step = 0; step < 1200; ++step) {
        rig.push(side * 5);
        rig.step();
        overshoot = std::max(overshoot, side * (rig.angle() - stop));
      }
      EXPECT_NEAR(rig.angle(), stop, 1e-3);
      EXPECT_LT(overshoot, reached);
    }
  }
}

// --- the document's form -------------------------------------------------------------------------

// Its coordinate is sin(angle / 2) within each turn, and its row cos(angle / 2) / 2 long: it meets
// a limit at speed to first order only, least well at odd multiples of half a turn, where the row
// has no length.
TEST(DocumentLimit, HoldsOverAnyNumberOfTurnsAndIsOvershotByLessThanAStepsMotion) {
  for (const Range& range : ranges) {
    for (const bool reference_a : {false, true}) {
      SCOPED_TRACE(testing::PrintToString(range));
      Rig rig(at(range, Partner::fixed_b, reference_a));
      limit(rig, range);
      rig.hinge().setFormulation(pintle::Formulation::document);
      const TrueAngle angle(rig, radians(range.start));
      double last = angle(), motion = 0, overshoot = 0;
      for (const double way : {1., -1.}) {
        for (int step = 0; step < 1500; ++step) {
          rig.push(way * 2);
          rig.step();
          motion = std::max(motion, std::abs(angle() - last));
          last = angle();
          overshoot = std::max({overshoot, last - radians(range.high), radians(range.low) - last});
        }
        // Where the row has no length, its coordinate is that of the limit, in single precision, up to a few times 7e-4 rad from it.
        EXPECT_NEAR(last, radians(way > 0 ? range.high : range.low), rounding(3e-3, 2e-3));
      }
      EXPECT_LT(overshoot, motion);
    }
  }
}

// --- as a spring ---------------------------------------------------------------------------------

// Frequency (Hz), damping ratio, partner, step rate (Hz).
class LimitSpring : public testing::TestWithParam<physics::SpringCase> {};

// One step of implicit Euler for x'' = push - w^2 x - 2 z w x', which the spring may only add to if
// it pushes out of the limit, and which acts from beyond it only.
void euler(double& x, double& v, double w, double z, double push, double h) {
  const double coast = v + h * push;
  v = coast;
  if (x > 0) v = std::min(coast, (coast - h * w * w * x) / (1 + 2 * z * w * h + w * w * h * h));
  x += h * v;
}

TEST_P(LimitSpring, IsTheImplicitEulerStepOfASpringAboutTheTrueInertia) {
  const auto [frequency, damping_ratio, partner, rate] = GetParam();
  // The step rate is the highest frequency asked for.
  const double w = 2 * pi * std::min(frequency, rate), h = 1 / rate;
  // Slow enough for a turning body to move as its angular velocity says: 0.02 rad a step.
  const double speed = std::min(0.3 * w, 0.02 * rate);
  const int steps = int(std::min(1500., std::max(60., 2 * rate / std::min(frequency, rate))));
  for (const bool reference_a : {false, true}) {
    for (const bool loaded : {false, true}) {
      RigSettings settings;
      settings.partner = partner;
      settings.reference_a = reference_a;
      settings.dt = h;
      settings.centred_a = partner == Partner::free;
      Rig rig(settings);
      const double stop = 0.1, load = loaded ? 0.2 * w * speed : 0;
      rig.hinge().setLimit(-3, btScalar(stop));
      rig.hinge().setLimitSpring(btScalar(std::min(frequency, rate)), btScalar(damping_ratio));
      rig.spin(speed);
      double x = rig.angle() - stop, v = speed, largest = 0, error = 0;
      for (int step = 0; step < steps; ++step) {
        rig.push(load * rig.inertia());
        rig.step();
        euler(x, v, w, damping_ratio, load, h);
        // Not where it hits the other side, far away.
        if (x < -2.5) break;
        largest = std::max(largest, x);
        error = std::max(error, std::abs(rig.angle() - stop - x));
      }
      SCOPED_TRACE(loaded ? "loaded" : "not loaded");
      ASSERT_GT(largest, 0) << "the limit was not reached";
      // 1 % of the swing; and what rounding makes of an angle that is measured from 0.
      EXPECT_LT(error, 0.01 * (largest + stop));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Springs, LimitSpring, physics::springCases(), physics::springName);

// --- the count -----------------------------------------------------------------------------------

struct Spin {
  const char* name;
  Partner partner;
  double w_a, w_b;        // rad/s; of a kinematic b, w_b is what its owner turns it by
  bool disabled = false;  // in the middle of the run
  int looks = 0;          // getAccumulatedHingeAngle calls a step, at most, at random
  int infos = 0;          // additional getInfo1 calls a step
};

std::ostream& operator<<(std::ostream& out, const Spin& s) { return out << s.name; }

template <class Hinge>
double lost(const Spin& spin, bool reference_a) {
  RigSettings settings;
  settings.partner = spin.partner;
  settings.reference_a = reference_a;
  settings.offset = 0;
  // The way of a half turn is told by where the joint came from.
  settings.kinematic_speed = spin.w_b > 0 ? radians(30) * 60 : -radians(30) * 60;
  HingeRig<Hinge> rig(settings);
  std::mt19937 random(1);
  if (spin.partner == Partner::kinematic) {
    rig.step();
    rig.set_kinematic_speed(spin.w_b);
  } else {
    rig.spin(spin.w_a, spin.w_b);
  }
  for (int step = 0; step < 200; ++step) {
    if (spin.disabled) rig.hinge().setEnabled(step < 70 || step > 130);
    btTypedConstraint::btConstraintInfo1 info;
    for (int i = 0; i < spin.infos; ++i) rig.hinge().getInfo1(&info);
    rig.step();
    if (spin.looks > 0) {
      for (int i = int(random() % unsigned(spin.looks + 1)); i > 0; --i)
        rig.hinge().getAccumulatedHingeAngle();
    }
  }
  EXPECT_GT(std::abs(rig.angle()), 20 * pi) << "it did not turn";
  return double(rig.hinge().getAccumulatedHingeAngle()) - rig.angle();
}

class Count : public testing::TestWithParam<Spin> {};

TEST_P(Count, KeepsEveryTurn) {
  for (const bool reference_a : {false, true})
    EXPECT_NEAR(lost<pintle::QuaternionHinge>(GetParam(), reference_a), 0, rounding(2e-3, 1e-9));
}

TEST_P(Count, IsLostByStock) {
  EXPECT_GT(std::abs(lost<btHingeAccumulatedAngleConstraint>(GetParam(), false)), pi);
}

INSTANTIATE_TEST_SUITE_P(
    Spins, Count,
    testing::Values(
        Spin{"At40", Partner::fixed_b, 40, 0}, Spin{"At1000", Partner::fixed_b, 1000, 0},
        Spin{"At1000OfB", Partner::fixed_a, 0, -1000}, Spin{"Opposite40", Partner::free, 40, -40},
        Spin{"Opposite90", Partner::free, -90, 90}, Spin{"Opposite110", Partner::free, 110, -110},
        Spin{"Opposite120", Partner::free, 120, -120},
        Spin{"Opposite1000", Partner::free, 1000, -1000},
        Spin{"Kinematic90", Partner::kinematic, 0, radians(90) * 60},
        Spin{"Kinematic179", Partner::kinematic, 0, radians(179) * 60},
        Spin{"Kinematic179Backward", Partner::kinematic, 0, -radians(179) * 60},
        Spin{"Kinematic180", Partner::kinematic, 0, pi * 60},
        Spin{"Disabled", Partner::fixed_b, 40, 0, true},
        Spin{"DisabledAt1000", Partner::fixed_b, -1000, 0, true},
        Spin{"RepeatedGetInfo1", Partner::fixed_b, 1000, 0, false, 0, 3},
        Spin{"RandomLooks", Partner::fixed_b, 1000, 0, false, 5, 0},
        Spin{"AllOfIt", Partner::kinematic, 0, radians(179) * 60, true, 5, 2}),
    [](const testing::TestParamInfo<Spin>& tested) { return std::string(tested.param.name); });

}  // namespace limit_test
