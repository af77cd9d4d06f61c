// The cone twist joint in the place of btConeTwistConstraint: the same calls with the same answers,
// who is inside, limits that hold at speed and at rest, the motor, and where stock fails.
#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <gtest/gtest.h>
#include <pintle/body_pair.h>
#include <pintle/equations/cone_twist.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/rows/row.h>
#include <pintle/rows/unwrapped_angle.h>
#include <scenes/shoulder.h>

#include <algorithm>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "joint_kinds.h"
#include "drawing.h"
#include "solver_of_tests.h"
#include "support.h"

namespace cone_twist_joint_test {

using scenes::pi;
using scenes::radians;
using scenes::SwingTwistAngles;
using support::infinite;
using support::nan_value;
using support::Random;
using support::scalar;
using support::SolverRows;
using support::vec;
using Stock = btConeTwistConstraint;
using Ours = pintle::ConeTwistJoint;

// Of a few operations on numbers of order one.
constexpr double rounding = support::is_double ? 1e-12 : 1e-5;
// Bullet takes its angles by an arc cosine, which keeps half of the digits.
constexpr double half_digits = support::is_double ? 1e-7 : 2e-3;

const btTransform identity = btTransform::getIdentity();

btQuaternion about(double x, double y, double z, double angle) {
  return {vec(x, y, z).normalized(), scalar(angle)};
}

// A swing of this angle about (0, cos, sin) of the direction, after a twist.
btQuaternion rotation(double swing, double direction, double twist) {
  return about(0, std::cos(direction), std::sin(direction), swing) * about(1, 0, 0, twist);
}

// --- the same answers ----------------------------------------------------------------------------

void expectSame(const btTransform& expected, const btTransform& got) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(expected.getOrigin()[i], got.getOrigin()[i]);
    for (int j = 0; j < 3; ++j) EXPECT_EQ(expected.getBasis()[i][j], got.getBasis()[i][j]);
  }
}

TEST(DropInConeTwist, ConstructorsMakeStocksFrames) {
  Random random(1);
  for (int n = 0; n < 20; ++n) {
    const auto a = support::body(1, vec(1, 2, 3), random.pose(3));
    const auto b = support::body(1, vec(1, 2, 3), random.pose(3));
    const btTransform frame_a = random.pose(1), frame_b = random.pose(1);
    Stock stock(*a, *b, frame_a, frame_b), stock_one(*a, frame_a);
    Ours ours(*a, *b, frame_a, frame_b), ours_one(*a, frame_a);
    expectSame(stock.getAFrame(), ours.getAFrame());
    expectSame(stock.getBFrame(), ours.getBFrame());
    expectSame(stock_one.getFrameOffsetA(), ours_one.getFrameOffsetA());
    expectSame(stock_one.getFrameOffsetB(), ours_one.getFrameOffsetB());
    EXPECT_EQ(&stock_one.getRigidBodyB(), &ours_one.getRigidBodyB());
    stock.setFrames(frame_b, frame_a);
    ours.setFrames(frame_b, frame_a);
    expectSame(stock.getFrameOffsetA(), ours.getFrameOffsetA());
    expectSame(stock.getFrameOffsetB(), ours.getFrameOffsetB());
  }
}

using Answers = std::vector<std::pair<std::string, double>>;

template <class Joint>
Answers settersAndGetters() {
  const auto a = support::body(1, vec(1, 1, 1), identity);
  const auto b = support::body(1, vec(1, 1, 1), identity);
  Joint joint(*a, *b, identity, identity);
  btTypedConstraint& base = joint;
  Answers out;
  const auto ask = [&](const char* after) {
    const Joint& constant = joint;
    const auto add = [&](const char* what, double value) {
      out.push_back({std::string(after) + ": " + what, value});
    };
    add("swing span 1", constant.getSwingSpan1());
    add("swing span 2", constant.getSwingSpan2());
    add("twist span", constant.getTwistSpan());
    for (const int i : {3, 4, 5}) add("limit", constant.getLimit(i));
    add("softness", constant.getLimitSoftness());
    add("bias", constant.getBiasFactor());
    add("relaxation", constant.getRelaxationFactor());
    add("damping", constant.getDamping());
    add("fix threshold", joint.getFixThresh());
    add("angular only", constant.getAngularOnly());
    add("motor", constant.isMotorEnabled());
    add("motor impulse", constant.getMaxMotorImpulse());
    add("flags", constant.getFlags());
    for (const int axis : {0, 2, 3, 5})
      for (const int number :
           {BT_CONSTRAINT_ERP, BT_CONSTRAINT_STOP_ERP, BT_CONSTRAINT_CFM, BT_CONSTRAINT_STOP_CFM})
        add("parameter", constant.getParam(number, axis));
  };
  ask("new");
  joint.setLimit(scalar(0.5), scalar(0.75), scalar(0.25));
  ask("limit");
  joint.setLimit(scalar(0.5), scalar(0.75), -1, scalar(0.8), scalar(0.2), scalar(0.9));
  ask("limit with factors");
  joint.setLimit(3, scalar(0.3));
  joint.setLimit(4, scalar(0.4));
  joint.setLimit(5, scalar(0.6));
  ask("limit by index");
  joint.setLimit(5, -1);
  ask("span below 0");
  joint.setFixThresh(scalar(0.1));
  joint.setDamping(scalar(0.5));
  joint.setAngularOnly(true);
  joint.enableMotor(true);
  joint.setMaxMotorImpulse(scalar(2.5));
  ask("motor");
  out.push_back({"normalized", joint.isMaxMotorImpulseNormalized()});
  joint.setMaxMotorImpulseNormalized(scalar(1.5));
  ask("normalized motor");
  out.push_back({"normalized", joint.isMaxMotorImpulseNormalized()});
  base.setParam(BT_CONSTRAINT_ERP, scalar(0.4), 1);
  ask("linear ERP");
  joint.setParam(BT_CONSTRAINT_STOP_CFM, scalar(0.01), 0);
  ask("linear CFM");
  base.setParam(BT_CONSTRAINT_CFM, scalar(0.02));
  ask("CFM");
  joint.setParam(BT_CONSTRAINT_STOP_ERP, scalar(0.7), 4);
  ask("ERP");
  return out;
}

TEST(DropInConeTwist, SettersAndGettersGiveStocksAnswers) {
  const Answers stock = settersAndGetters<Stock>(), ours = settersAndGetters<Ours>();
  ASSERT_EQ(stock.size(), ours.size());
  for (size_t i = 0; i < stock.size(); ++i)
    EXPECT_EQ(stock[i].second, ours[i].second) << stock[i].first;
}

TEST(DropInConeTwist, PointForAngleIsStocks) {
  const auto a = support::body(1, vec(1, 1, 1), identity);
  Stock stock(*a, identity);
  Ours ours(*a, identity);
  Random random(2);
  for (int n = 0; n < 1000; ++n) {
    const btScalar span_1 = scalar(random.uniform(0.01, 3.1)),
                   span_2 = scalar(random.uniform(0.01, 3.1));
    stock.setLimit(span_1, span_2, 1);
    ours.setLimit(span_1, span_2, 1);
    const btScalar angle = scalar(random.uniform(-7, 7));
    const btVector3 expected = stock.GetPointForAngle(angle, 2),
                    got = ours.GetPointForAngle(angle, 2);
    // Half of the angle's digits are the ellipse's, at its flattest 300 times magnified.
    EXPECT_LT((expected - got).length(), 300 * rounding) << span_1 << ' ' << span_2 << ' ' << angle;
  }
  ours.setLimit(BT_LARGE_FLOAT, BT_LARGE_FLOAT, 1);
  EXPECT_NEAR(ours.GetPointForAngle(1, 1).x(), -1, rounding) << "stock's is anywhere";
}

TEST(DropInConeTwist, MotorTargetsAreCutOffAsStocks) {
  const auto a = support::body(1, vec(1, 1, 1), identity);
  const auto b = support::body(1, vec(1, 1, 1), identity);
  Random random(3);
  int cut = 0;
  for (int n = 0; n < 1000; ++n) {
    const btTransform frame_a = random.pose(1), frame_b = random.pose(1);
    Stock stock(*a, *b, frame_a, frame_b);
    Ours ours(*a, *b, frame_a, frame_b);
    const btScalar span_1 = scalar(random.uniform(0.1, 3.1)),
                   span_2 = scalar(random.uniform(0.1, 3.1)),
                   twist = scalar(random.uniform(0.1, 3.1));
    stock.setLimit(span_1, span_2, twist);
    ours.setLimit(span_1, span_2, twist);
    const btQuaternion q = random.pose(1).getRotation();
    if (n % 2) {
      stock.setMotorTarget(q);
      ours.setMotorTarget(q);
    } else {
      stock.setMotorTargetInConstraintSpace(q);
      ours.setMotorTargetInConstraintSpace(q);
    }
    const btQuaternion expected = stock.getMotorTarget(), got = ours.getMotorTarget();
    const double same = std::abs(double(expected.dot(got)));
    // Stock's swing angle is an arc cosine.
    EXPECT_GT(same, 1 - half_digits * half_digits) << n;
    EXPECT_NEAR(got.length2(), 1, rounding);
    cut += n % 2 == 0 && std::abs(double(q.dot(got))) < 0.99;
  }
  EXPECT_GT(cut, 100);
}

// --- readings, and who is inside -----------------------------------------------------------------

struct Classified {
  int counted = 0, outside = 0, wrong = 0, wrong_stock = 0;
};

// Poses are made from their swing and twist: what is outside is known before a joint is asked.
TEST(ConeTwistInside, IsToldWithoutErrorsAsByStock) {
  const auto a = support::body(1, vec(1, 1, 1), identity);
  const auto b = support::body(1, vec(1, 1, 1), identity);
  Random random(4);
  Classified swings, twists;
  double reading = 0;
  for (int n = 0; n < 100000; ++n) {
    if (testing::Test::HasFailure()) break;
    const btTransform frame_a = n % 10 == 0 ? random.pose(1) : identity;
    Stock stock(*a, *b, frame_a, identity);
    Ours ours(*a, *b, frame_a, identity);
    const double span_1 = random.uniform(0.06, pi), span_2 = random.uniform(0.06, pi),
                 twist_span = random.uniform(0, pi), softness = n % 3 ? 1 : random.uniform(0.5, 1);
    for (const auto set : {0, 1})
      set ? ours.setLimit(scalar(span_1), scalar(span_2), scalar(twist_span), scalar(softness))
          : stock.setLimit(scalar(span_1), scalar(span_2), scalar(twist_span), scalar(softness));
    const double direction = random.uniform(-pi, pi), twist = random.uniform(-pi, pi);
    const double radius =
        softness / std::hypot(std::cos(direction) / span_2, std::sin(direction) / span_1);
    const double swing = n % 2 ? random.uniform(0, pi) : radius * random.uniform(0.9, 1.1);
    if (swing > pi - 0.01) continue;
    const btTransform pose_b = random.pose(1);
    b->setCenterOfMassTransform(pose_b);
    a->setCenterOfMassTransform(pose_b * btTransform(rotation(swing, direction, twist)) *
                                frame_a.inverse());
    stock.calcAngleInfo2(a->getCenterOfMassTransform(), b->getCenterOfMassTransform(),
                         a->getInvInertiaTensorWorld(), b->getInvInertiaTensorWorld());
    // Digits of the pose that a swing near half a turn costs, and a flat ellipse.
    const double lost = 1 / std::cos(swing / 2);
    const double flat = std::max(span_1, span_2) / std::min(span_1, span_2);
    reading = std::max({reading, std::abs(double(ours.getTwist()) - twist) / lost,
                        std::abs(double(ours.getSwing2()) - swing * std::cos(direction)) / lost,
                        std::abs(double(ours.getSwing1()) - swing * std::sin(direction)) / lost});
    EXPECT_NEAR(stock.getTwistAngle(), ours.getTwistAngle(), half_digits * lost);
    const auto count = [&](Classified& of, double beyond, double margin, bool is,
                           bool is_of_stock) {
      if (std::abs(beyond) < margin) return;
      ++of.counted;
      of.outside += beyond > 0;
      of.wrong += is != (beyond > 0);
      of.wrong_stock += std::abs(beyond) > half_digits * flat * lost && is_of_stock != (beyond > 0);
    };
    count(swings, swing - radius, 10 * rounding * flat * lost, ours.isPastSwingLimit(),
          stock.isPastSwingLimit());
    count(twists, std::abs(twist) - softness * twist_span, 10 * rounding * lost,
          ours.getSolveTwistLimit() != 0, stock.getSolveTwistLimit() != 0);
  }
  EXPECT_EQ(swings.wrong + twists.wrong, 0);
  EXPECT_EQ(swings.wrong_stock + twists.wrong_stock, 0) << "these are stock's own limits";
  EXPECT_LT(reading, 5 * rounding);
  EXPECT_GT(swings.counted, 80000);
  EXPECT_GT(twists.counted, 80000);
  EXPECT_GT(swings.outside, 20000);
  EXPECT_GT(twists.outside, 20000);
}

TEST(ConeTwistInside, OfLimitsThatDifferOnBothSides) {
  const auto a = support::body(1, vec(1, 1, 1), identity);
  const auto b = support::body(1, vec(1, 1, 1), identity);
  Ours joint(*a, *b, identity, identity);
  Random random(5);
  Classified swings, twists;
  for (int n = 0; n < 30000; ++n) {
    const auto side = [&] { return random.uniform(0.06, pi); };
    const double min_1 = -side(), max_1 = side(), min_2 = -side(), max_2 = side();
    joint.setSwingLimits(scalar(min_1), scalar(max_1), scalar(min_2), scalar(max_2));
    double low = random.uniform(-2 * pi, 2 * pi), high = random.uniform(-2 * pi, 2 * pi);
    if (low > high) std::swap(low, high);
    joint.setTwistLimit(scalar(low), scalar(high));
    const double direction = random.uniform(-pi, pi), twist = random.uniform(-pi, pi);
    const double about_2 = std::cos(direction), about_1 = std::sin(direction);
    const double radius = 1 / std::hypot(about_2 / (about_2 < 0 ? min_2 : max_2),
                                         about_1 / (about_1 < 0 ? min_1 : max_1));
    const double swing = n % 2 ? random.uniform(0, 3.1) : radius * random.uniform(0.9, 1.1);
    if (swing > 3.1) continue;
    b->setCenterOfMassTransform(random.pose(1));
    a->setCenterOfMassTransform(b->getCenterOfMassTransform() *
                                btTransform(rotation(swing, direction, twist)));
    const double margin = 100 * rounding;
    if (std::abs(swing - radius) > margin) {
      ++swings.counted;
      swings.wrong += joint.isPastSwingLimit() != (swing > radius);
    }
    // In one of the turns.
    double inside = -HUGE_VAL;
    for (int turn = -2; turn <= 2; ++turn) {
      const double angle = twist + 2 * pi * turn;
      inside = std::max(inside, std::min(angle - low, high - angle));
    }
    if (std::abs(inside) > margin) {
      ++twists.counted;
      twists.outside += inside < 0;
      twists.wrong += (joint.getSolveTwistLimit() != 0) != (inside < 0);
    }
  }
  EXPECT_EQ(swings.wrong, 0);
  EXPECT_EQ(twists.wrong, 0);
  EXPECT_GT(swings.counted, 20000);
  EXPECT_GT(twists.outside, 3000);
}

TEST(ConeTwistInside, OfSpansThatAreNone) {
  const auto a = support::body(1, vec(1, 1, 1), btTransform(rotation(3, 1, 3)));
  const auto b = support::body(1, vec(1, 1, 1), identity);
  Ours joint(*a, *b, identity, identity);
  EXPECT_FALSE(joint.isPastSwingLimit());
  EXPECT_FALSE(joint.getSolveTwistLimit());
  joint.setLimit(infinite, infinite, infinite);
  EXPECT_FALSE(joint.isPastSwingLimit());
  EXPECT_FALSE(joint.getSolveTwistLimit());
  // A strip: free along its length.
  joint.setLimit(scalar(0.1), BT_LARGE_FLOAT, -1);
  a->setCenterOfMassTransform(btTransform(rotation(3, 0, 3)));
  EXPECT_FALSE(joint.isPastSwingLimit());
  EXPECT_EQ(joint.getTwistAngle(), 0);
  a->setCenterOfMassTransform(btTransform(rotation(0.11, pi / 2, 3)));
  EXPECT_TRUE(joint.isPastSwingLimit());
  joint.setLimit(scalar(0.1), scalar(0.1), scalar(0.1), 1, scalar(0.3), 0);
  EXPECT_FALSE(joint.isPastSwingLimit()) << "no relaxation: no rows";
  EXPECT_FALSE(joint.getSolveTwistLimit());
}

// --- rows ----------------------------------------------------------------------------------------

TEST(ConeTwistRows, ThereIsOneForWhatActs) {
  struct Count {
    const char* name;
    int rows;
    std::function<void(Ours&, btRigidBody&)> set;
  };
  const btVector3 spin = vec(0, 6, 0);  // 0.1 rad a step of 1/60 s
  const Count counts[] = {
      {"new", 3, [](auto&, auto&) {}},
      {"inside", 3, [](auto& j, auto&) { j.setLimit(1, 2, 1); }},
      {"inside and slow", 3,
       [&](auto& j, auto& a) {
         j.setLimit(1, 2, 1);
         a.setAngularVelocity(spin);
       }},
      {"about to reach the cone", 4,
       [&](auto& j, auto& a) {
         j.setLimit(1, scalar(0.15), 1);
         a.setAngularVelocity(spin);
       }},
      {"about to reach the twist", 4,
       [&](auto& j, auto& a) {
         j.setLimit(1, 1, scalar(0.09));
         a.setAngularVelocity(vec(6, 0, 0));
       }},
      {"twist locked", 4, [](auto& j, auto&) { j.setLimit(1, 1, 0); }},
      {"one swing locked", 4, [](auto& j, auto&) { j.setLimit(0, 1, 1); }},
      {"the other one", 4, [](auto& j, auto&) { j.setLimit(1, scalar(0.04), 1); }},
      {"both", 5, [](auto& j, auto&) { j.setLimit(scalar(0.04), scalar(0.04), 1); }},
      {"all", 6, [](auto& j, auto&) { j.setLimit(0, 0, 0); }},
      {"no threshold", 4,
       [&](auto& j, auto& a) {
         j.setFixThresh(scalar(0.01));
         j.setLimit(scalar(0.04), scalar(0.03), 1);
         a.setAngularVelocity(spin);
       }},
      {"motor", 6, [](auto& j, auto&) { j.enableMotor(true); }},
      {"motor off", 3,
       [](auto& j, auto&) {
         j.enableMotor(true);
         j.enableMotor(false);
       }},
      {"friction", 6, [](auto& j, auto&) { j.setFriction(1); }},
      {"motor and friction", 9,  // a row each about each axis
       [](auto& j, auto&) {
         j.enableMotor(true);
         j.setFriction(1);
       }},
      {"friction of a hinge", 6,
       [](auto& j, auto&) {
         j.setLimit(0, 0, 1);
         j.setFriction(1);
       }},
      {"friction of a universal joint", 6,
       [](auto& j, auto&) {
         j.setLimit(1, 0, 1);
         j.setFriction(1);
       }},
      {"everything", 11,
       [&](auto& j, auto& a) {
         j.setLimit(1, scalar(0.15), 0);
         j.setFriction(1);
         j.enableMotor(true);
         a.setAngularVelocity(spin);
       }},
  };
  for (const auto form : {pintle::Formulation::document, pintle::Formulation::conditioned}) {
    for (const bool angular_only : {false, true}) {
      for (const Count& count : counts) {
        SCOPED_TRACE(testing::Message() << count.name << (angular_only ? ", angular only" : ""));
        const auto a = support::body(1, vec(1, 1, 1), identity);
        const auto b = support::body(1, vec(1, 1, 1), identity);
        Ours joint(*a, *b, identity, identity);
        joint.setFormulation(form);
        joint.setAngularOnly(angular_only);
        count.set(joint, *a);
        const SolverRows rows = SolverRows::ofStep(joint);
        EXPECT_EQ(rows.announced(), count.rows - (angular_only ? 3 : 0));
        EXPECT_TRUE(rows.finite());
      }
    }
  }
}

// What the joint adds to shared parts.
TEST(ConeTwistRows, TwistRowFromTheAxesIsThatOfTheSwing) {
  using V = pintle::Vec3;
  Random random(6);
  for (int n = 0; n < 10000; ++n) {
    const btVector3 u = random.unit(), v = random.unit();
    const V c_a(u.x(), u.y(), u.z()), c_b(v.x(), v.y(), v.z());
    const auto swing = pintle::equations::swing(c_a, c_b);
    if (swing.h_scale > 1000) continue;
    const V expected = pintle::equations::twist_row(swing),
            got = pintle::equations::twist_row<btScalar>(c_a, c_b);
    EXPECT_LT(double((expected - got).norm()),
              20 * double(SIMD_EPSILON) * double(swing.h_scale) * double(expected.norm()));
  }
  EXPECT_TRUE(pintle::equations::twist_row<btScalar>(V(1, 0, 0), V(-1, 0, 0)).allFinite());
}

TEST(ConeTwistRows, TheTangentAheadHasTheConeBehindItAndIsTheNearestIfNothingMoves) {
  namespace eq = pintle::equations;
  using V = pintle::Vec3;
  Random random(19);
  const V x = V::Unit(0), y = V::Unit(1), z = V::Unit(2);
  double same = 0, in_front = -HUGE_VAL, missed = 0;
  for (int n = 0; n < 20000; ++n) {
    const auto side = [&] { return scalar(random.uniform(0.05, 2.5)); };
    const eq::SwingSpans<btScalar> spans{side(), side(), side(), side()};
    const double direction = random.uniform(-pi, pi);
    const auto point = [&](double at, double scale) {
      const double s_1 = std::cos(at), s_2 = std::sin(at);
      const double f = std::sqrt(double(eq::cone_ratio2(scalar(s_1), scalar(s_2), spans)));
      return std::pair(scale * s_1 / f, scale * s_2 / f);
    };
    const auto [s_1, s_2] = point(direction, random.uniform(0, 1));
    const double angle = std::hypot(s_1, s_2);
    if (angle > 2.5) continue;
    const V axis = (scalar(s_1) * z + scalar(s_2) * y) / scalar(std::max(angle, 1e-9));
    const auto swing =
        eq::swing<btScalar>(x, eq::rotate(eq::rotation<btScalar>(axis, scalar(angle)), V(x)));
    const V w(random.vector(5).x(), random.vector(5).y(), random.vector(5).z());
    const btScalar dt = scalar(1.0 / 60), push = scalar(random.uniform(0, 0.1));
    const auto nearest = eq::elliptic_cone_row<btScalar>(swing, x, z, y, spans);
    const auto still =
        eq::elliptic_cone_row_ahead<btScalar>(swing, x, z, y, spans, V::Zero(), dt, 0);
    same = std::max(
        {same, std::abs(double(nearest.C - still.C)), double((nearest.J_b - still.J_b).norm())});
    const auto ahead = eq::elliptic_cone_row_ahead<btScalar>(swing, x, z, y, spans, w, dt, push);
    // n, from the row: its parts along the swing's own rows.
    const V row_1 = eq::swing_row<btScalar>(swing, x, z),
            row_2 = eq::swing_row<btScalar>(swing, x, y);
    Eigen::Matrix<double, 3, 2> rows;
    rows << row_1.cast<double>(), row_2.cast<double>();
    const Eigen::Matrix2d square = rows.transpose() * rows;
    const Eigen::Vector2d right = rows.transpose() * ahead.J_b.cast<double>();
    const double det = square(0, 0) * square(1, 1) - square(0, 1) * square(1, 0);
    const Eigen::Vector2d normal((square(1, 1) * right[0] - square(0, 1) * right[1]) / det,
                                 (square(0, 0) * right[1] - square(1, 0) * right[0]) / det);
    missed = std::max(missed, std::abs(normal.norm() - 1));
    for (int i = 0; i < 8; ++i) {
      const auto [q_1, q_2] = point(random.uniform(-pi, pi), 1);
      in_front =
          std::max(in_front, double(ahead.C) + normal[0] * (q_1 - s_1) + normal[1] * (q_2 - s_2));
    }
  }
  EXPECT_LT(same, 20 * rounding);
  EXPECT_LT(in_front, 100 * rounding) << "a point of the boundary before the tangent";
  EXPECT_LT(missed, 100 * rounding);
}

// --- limits in motion ----------------------------------------------------------------------------

struct Spans {
  double swing_1, swing_2, twist;
};
std::ostream& operator<<(std::ostream& out, const Spans& s) {
  return out << s.swing_1 << " x " << s.swing_2 << ", " << s.twist;
}

struct LimbSettings {
  bool free_b = false;  // both bodies move
  double gravity = 0, damping = 0;
  int iterations = 10;
  double dt = 1.0 / 60;
  bool at_centre = false, turned = false;  // the frame in the limb
};

// A limb (body a) on a body that is fixed, or not, in any direction.
template <class Joint>
class Limb {
 public:
  Limb(Random& random, const LimbSettings& settings = {})
      : m_settings(settings), m_world(settings.gravity, settings.iterations) {
    frame_a = scenes::pose_at(settings.at_centre ? vec(0, 0, 0) : vec(-0.3, 0, 0));
    frame_b = random.pose(0);
    if (settings.turned) frame_a.setBasis(random.pose(0).getBasis());
    b = &m_world.add_box(settings.free_b ? 3 : 0, vec(0.2, 0.3, 0.25), random.pose(0));
    a = &m_world.add_box(1, vec(0.3, 0.06, 0.08),
                         b->getCenterOfMassTransform() * frame_b * frame_a.inverse());
    a->setDamping(scalar(settings.damping), scalar(settings.damping));
    joint = &m_world.add_joint<Joint>(*a, *b, frame_a, frame_b);
  }
  void limit(const Spans& spans) {
    joint->setLimit(scalar(spans.swing_1), scalar(spans.swing_2), scalar(spans.twist));
  }
  /// Puts the limb at this rotation against b (frame to frame).
  void put(const btQuaternion& q) {
    a->setCenterOfMassTransform(b->getCenterOfMassTransform() * frame_b * btTransform(q) *
                                frame_a.inverse());
  }
  /// About the pivot.
  void spin(const btVector3& w) {
    a->setAngularVelocity(w);
    const btTransform pivot = a->getCenterOfMassTransform() * frame_a;
    a->setLinearVelocity(w.cross(a->getCenterOfMassPosition() - pivot.getOrigin()));
  }
  void step(int steps = 1) {
    for (int i = 0; i < steps; ++i) m_world.step(m_settings.dt);
  }
  SwingTwistAngles at() const { return scenes::swing_twist_angles(*a, frame_a, *b, frame_b); }
  double beyond(const Spans& spans) const {
    const SwingTwistAngles now = at();
    return scenes::distance_from_ellipse(now.swing_1, now.swing_2, spans.swing_1, spans.swing_2);
  }
  double twistBeyond(const Spans& spans) const { return std::abs(at().twist) - spans.twist; }
  /// rad/s, of a against b.
  btVector3 velocity() const { return a->getAngularVelocity() - b->getAngularVelocity(); }
  double speed() const { return double(velocity().length()); }
  double energy() const {
    return scenes::energy(*a, m_settings.gravity) +
           (m_settings.free_b ? scenes::energy(*b, m_settings.gravity) : 0);
  }
  double gap() const {
    const btTransform A = a->getCenterOfMassTransform() * frame_a,
                      B = b->getCenterOfMassTransform() * frame_b;
    return double((A.getOrigin() - B.getOrigin()).length());
  }
  scenes::World& world() { return m_world; }

  btRigidBody *a, *b;
  Joint* joint;
  btTransform frame_a, frame_b;

 private:
  LimbSettings m_settings;
  scenes::World m_world;
};

constexpr Spans many_spans[] = {{0.8, 0.8, 0.5}, {0.5, 1.2, 0.4}, {1.2, 0.5, 2.9},
                                {0.1, 1.2, 0.3}, {1.5, 2.5, 1},   {0.06, 1.8, 0.1}};

struct Throw {
  double worst = -HUGE_VAL;            // rad beyond a limit
  double worst_of_motion = -HUGE_VAL;  // the same, over the motion of a step
  double energy = 0;                   // largest, over that of the throw
};

template <class Joint>
Throw thrown(const Spans& spans, unsigned seed, double speed, bool free_b) {
  Random random(seed);
  LimbSettings settings;
  settings.free_b = free_b;
  Limb<Joint> limb(random, settings);
  limb.limit(spans);
  limb.spin(random.unit() * scalar(speed));
  const double energy = limb.energy();
  Throw result;
  double fastest = 0;
  for (int i = 0; i < 180; ++i) {
    fastest = std::max(fastest, limb.speed());
    limb.step();
    const SwingTwistAngles now = limb.at();
    const double beyond = limb.beyond(spans);
    // The twist moves by as much more than the bodies do.
    const double twist_beyond =
        limb.twistBeyond(spans) * std::cos(std::min(now.swing(), pi - 0.1) / 2);
    const double worst = std::max(beyond, twist_beyond);
    result.worst = std::max(result.worst, worst);
    result.worst_of_motion = std::max(result.worst_of_motion, worst / (fastest / 60));
    result.energy = std::max(result.energy, limb.energy() / energy);
  }
  return result;
}

TEST(ConeTwistAtSpeed, OvershootsByLessThanAStepAndAddsNoEnergy) {
  for (const Spans& spans : many_spans) {
    for (const double speed : {2., 8., 20.}) {
      for (const bool free_b : {false, true}) {
        SCOPED_TRACE(testing::Message() << spans << " at " << speed << (free_b ? ", free" : ""));
        double stock = 0, ours = 0;
        for (unsigned seed = 0; seed < 4; ++seed) {
          const Throw result = thrown<Ours>(spans, seed, speed, free_b);
          ours = std::max(ours, result.worst);
          stock = std::max(stock, thrown<Stock>(spans, seed, speed, free_b).worst);
          EXPECT_LT(result.worst_of_motion, 1) << seed;
          EXPECT_LT(result.energy, 1.05) << seed;
        }
        EXPECT_LT(ours, stock);
      }
    }
  }
}

// The same where the sides differ, with the range that the twist is in not around 0.
TEST(ConeTwistAtSpeed, LimitsThatDifferOnBothSidesHold) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    Limb<Ours> limb(random);
    const double min_1 = -0.2, max_1 = 1.2, min_2 = -0.7, max_2 = 0.4, low = 0.5, high = 1.4;
    limb.joint->setSwingLimits(scalar(min_1), scalar(max_1), scalar(min_2), scalar(max_2));
    limb.joint->setTwistLimit(scalar(low), scalar(high));
    limb.put(rotation(0, 0, 1));
    const double speed = random.uniform(1, 15);
    limb.spin(random.unit() * scalar(speed));
    double worst = -HUGE_VAL;
    for (int i = 0; i < 180; ++i) {
      limb.step();
      const SwingTwistAngles now = limb.at();
      worst = std::max(
          {worst, now.twist - high, low - now.twist,
           scenes::distance_from_ellipse(now.swing_1, now.swing_2, now.swing_1 < 0 ? -min_1 : max_1,
                                         now.swing_2 < 0 ? -min_2 : max_2)});
    }
    EXPECT_LT(worst, speed / 60) << seed;
  }
}

struct Rest {
  double speed = 0, beyond = -HUGE_VAL;
};

// Gravity pulls a limb, whose centre is on no axis of the joint, into a corner or along an edge.
template <class Joint>
Rest rest(const Spans& spans, unsigned seed, int iterations) {
  Random random(seed);
  LimbSettings settings;
  settings.gravity = scenes::standard_gravity;
  settings.damping = 0.9;
  settings.turned = true;
  settings.iterations = iterations;
  Limb<Joint> limb(random, settings);
  limb.limit(spans);
  limb.spin(random.unit() * 5);
  Rest result;
  for (int i = 0; i < 1000; ++i) {
    limb.step();
    if (i < 900) continue;
    result.speed = std::max(result.speed, limb.speed());
    result.beyond = std::max({result.beyond, limb.beyond(spans), limb.twistBeyond(spans)});
  }
  return result;
}

TEST(ConeTwistAtRest, NoCornerSticksOrJitters) {
  for (const Spans& spans : many_spans) {
    // The flattest one's corners are hard to find for 10 iterations.
    for (const int iterations : {10, 50}) {
      if (spans.swing_1 < 0.1 && iterations == 10) continue;
      double stock = -HUGE_VAL, ours = -HUGE_VAL;
      for (unsigned seed = 100; seed < 108; ++seed) {
        SCOPED_TRACE(testing::Message() << spans << ", " << seed << ", " << iterations);
        const Rest result = rest<Ours>(spans, seed, iterations);
        // Its tip has a radius of 0.002 rad, about which the exact solver may creep, a degree a step there and back. (Stock's whirls, at
        // up to 70 rad/s.)
        const bool creeps = onExactSolver() && spans.swing_1 < 0.1;
        EXPECT_LT(result.speed, creeps ? 1.1 : 1e-3);
        ours = std::max(ours, result.beyond);
        if (iterations == 10) stock = std::max(stock, rest<Stock>(spans, seed, iterations).beyond);
      }
      SCOPED_TRACE(testing::Message() << spans << ", " << iterations);
      if (iterations == 10) {
        // The two limits of a corner yield as iterations leave them.
        EXPECT_LT(ours, stock / 10);
      } else {
        // A cone's tip yields a little instead of rattling; on the exact solver by the degree by which it creeps.
        const double at_tip = onExactSolver() ? 0.02 : 0.015,
                     sharp = std::min(spans.swing_1, spans.swing_2) < 0.2 ? at_tip : 6e-3;
        EXPECT_LT(ours, sharp);
      }
    }
  }
}

TEST(ConeTwistAtRest, ALimitThatIsBrokenIsCorrectedWithoutAThrow) {
  for (const Spans& spans : many_spans) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      SCOPED_TRACE(testing::Message() << spans << ", " << seed);
      Random random(seed);
      LimbSettings settings;
      settings.damping = 0.5;
      Limb<Ours> limb(random, settings);
      limb.limit(spans);
      limb.put(rotation(random.uniform(0, 3), random.uniform(-pi, pi), random.uniform(-pi, pi)));
      double fastest = 0;
      for (int i = 0; i < 600; ++i) {
        limb.step();
        fastest = std::max(fastest, limb.speed());
      }
      EXPECT_LT(limb.beyond(spans), 1e-3);
      EXPECT_LT(limb.twistBeyond(spans), 1e-3);
      // 8 rad/s of each limit.
      EXPECT_LT(fastest, 24);
    }
  }
}

// A ragdoll's shoulder, with the one source for both.
TEST(ConeTwistShoulder, IsNoWorseThanStocksInAnything) {
  for (const int iterations : {4, 10, 50}) {
    for (const Spans& spans : {Spans{0.8, 0.8, 0.5}, Spans{0.5, 1.2, 0.5}, Spans{0.1, 1.2, 0.5}}) {
      for (const double speed : {2., 10.}) {
        SCOPED_TRACE(testing::Message() << spans << " at " << speed << ", " << iterations);
        scenes::ShoulderSettings settings;
        settings.span_1 = spans.swing_1;
        settings.span_2 = spans.swing_2;
        settings.twist_span = spans.twist;
        settings.spin = settings.spin.normalized() * speed;
        settings.iterations = iterations;
        settings.seconds = 15;
        const auto stock = scenes::shoulder<Stock>(settings);
        const auto ours = scenes::shoulder<Ours>(settings);
        EXPECT_TRUE(ours.finite);
        EXPECT_LT(ours.swing_beyond, stock.swing_beyond);
        EXPECT_LT(ours.twist_beyond, stock.twist_beyond);
        EXPECT_LT(ours.end_swing_beyond, 1e-3);
        EXPECT_LT(ours.end_twist_beyond, 1e-3);
        EXPECT_LT(ours.rest_speed, std::max(stock.rest_speed, 1e-2));
        EXPECT_LE(ours.max_gap, stock.max_gap * 1.001);
      }
    }
  }
}

// Inside of its limits a joint is a ball: the same motion.
TEST(ConeTwistShoulder, MovesAsStockInside) {
  const auto course = [](auto* type) {
    using Joint = std::remove_pointer_t<decltype(type)>;
    Random random(7);
    LimbSettings settings;
    settings.gravity = 1;
    settings.iterations = 50;
    settings.dt = 1.0 / 240;
    Limb<Joint> limb(random, settings);
    limb.joint->setLimit(2, scalar(2.5), 2);
    limb.spin(vec(0.5, 1, -1));
    std::vector<SwingTwistAngles> result;
    for (int i = 0; i < 120; ++i) {
      limb.step();
      result.push_back(limb.at());
    }
    return result;
  };
  const auto stock = course(static_cast<Stock*>(nullptr)),
             ours = course(static_cast<Ours*>(nullptr));
  EXPECT_GT(ours.back().swing(), 0.3);
  // Stock's pivot drifts by as much.
  for (size_t i = 0; i < ours.size(); ++i) {
    EXPECT_NEAR(stock[i].swing_1, ours[i].swing_1, 2e-3);
    EXPECT_NEAR(stock[i].swing_2, ours[i].swing_2, 2e-3);
    EXPECT_NEAR(stock[i].twist, ours[i].twist, 2e-3);
  }
}

// --- locks ---------------------------------------------------------------------------------------

TEST(ConeTwistLocks, HoldTheirDirectionsAndLeaveTheOthers) {
  struct Case {
    double span_1, span_2, twist;
  };
  for (const Case& c : {Case{0, 0, -1}, Case{0, 0, 0}, Case{0, 1, 0}, Case{1, 0, 0}, Case{0, 4, -1},
                        Case{4, -1, -1}, Case{0.04, 0.04, 0.3}}) {
    SCOPED_TRACE(testing::Message() << c.span_1 << ' ' << c.span_2 << ' ' << c.twist);
    Random random(8);
    LimbSettings settings;
    settings.gravity = scenes::standard_gravity;
    Limb<Ours> limb(random, settings);
    limb.joint->setLimit(scalar(c.span_1), scalar(c.span_2), scalar(c.twist));
    limb.spin(random.unit() * 5);
    double locked = 0, free = 0;
    for (int i = 0; i < 300; ++i) {
      limb.step();
      const Eigen::Matrix3d A = scenes::rotation(*limb.a),
                            B = scenes::rotation(*limb.b) *
                                scenes::to_eigen(limb.frame_b.getBasis());
      // x of b in body a.
      const Eigen::Vector3d x = A.transpose() * B.col(0);
      if (c.span_1 < 0.05) locked = std::max(locked, std::abs(x.y()));
      if (c.span_2 < 0.05) locked = std::max(locked, std::abs(x.z()));
      const double twist = std::abs(limb.at().twist);
      if (c.twist == 0) locked = std::max(locked, twist);
      if (c.twist > 0) locked = std::max(locked, twist - c.twist);
      const double swing = std::atan2(std::hypot(x.y(), x.z()), x.x());
      if (c.span_1 == 1 || c.span_2 == 1) locked = std::max(locked, swing - 1);
      free = std::max({free, twist, swing});
    }
    // What a bend that changes leaves in a step of 0.15 rad.
    EXPECT_LT(locked, 1.2e-2);
    if (c.twist < 0 || c.span_1 + c.span_2 > 0.5) {
      EXPECT_GT(free, 0.2);
    }
  }
}

// A sideways load on a hinge of two locks: stock's rows yield, as they are none while aligned.
TEST(ConeTwistLocks, YieldLessThanStocks) {
  const auto worst = [](auto* type) {
    using Joint = std::remove_pointer_t<decltype(type)>;
    Random random(9);
    LimbSettings settings;
    settings.gravity = scenes::standard_gravity;
    Limb<Joint> limb(random, settings);
    limb.joint->setLimit(0, 0, -1);
    limb.spin(limb.a->getCenterOfMassTransform().getBasis().getColumn(0) * 10);
    double swing = 0;
    for (int i = 0; i < 300; ++i) {
      limb.step();
      swing = std::max(swing, limb.at().swing());
    }
    return swing;
  };
  EXPECT_LT(worst(static_cast<Ours*>(nullptr)), 1e-4);
  EXPECT_LT(worst(static_cast<Ours*>(nullptr)), worst(static_cast<Stock*>(nullptr)));
}

TEST(ConeTwistLocks, AngularOnlyLeavesThePosition) {
  Random random(10);
  Limb<Ours> limb(random);
  limb.joint->setAngularOnly(true);
  limb.joint->setLimit(scalar(0.3), scalar(0.3), scalar(0.3));
  limb.a->setLinearVelocity(vec(1, 0, 0));
  limb.a->setAngularVelocity(vec(3, 2, 1));
  limb.step(60);
  EXPECT_NEAR(limb.a->getLinearVelocity().x(), 1, 1e-6);
  EXPECT_LT(limb.beyond({0.3, 0.3, 0.3}), 0.01);
  EXPECT_LT(limb.twistBeyond({0.3, 0.3, 0.3}), 0.01);
}

// --- motor ---------------------------------------------------------------------------------------

// rad, from the target.
template <class Joint>
double error(const Limb<Joint>& limb, const btQuaternion& target) {
  const Eigen::Matrix3d R =
      (scenes::rotation(*limb.b) * scenes::to_eigen(limb.frame_b.getBasis())).transpose() *
      scenes::rotation(*limb.a) * scenes::to_eigen(limb.frame_a.getBasis());
  const Eigen::Matrix3d E = R.transpose() * scenes::to_eigen(btMatrix3x3(target));
  return std::abs(Eigen::AngleAxisd(E).angle());
}

TEST(ConeTwistMotor, GoesStocksWayWithAllTheImpulseItNeeds) {
  for (const bool normalized : {false, true}) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      Random target_random(50 + seed);
      const btQuaternion target =
          rotation(target_random.uniform(0.2, 1.2), target_random.uniform(-pi, pi),
                   target_random.uniform(-1, 1));
      const auto course = [&](auto* type) {
        using Joint = std::remove_pointer_t<decltype(type)>;
        Random random(seed);
        LimbSettings settings;
        settings.at_centre = true;
        Limb<Joint> limb(random, settings);
        limb.joint->setLimit(2, 2, 2);
        limb.joint->setMotorTargetInConstraintSpace(target);
        if (normalized)
          limb.joint->setMaxMotorImpulseNormalized(1000);
        else if (seed % 2)
          limb.joint->setMaxMotorImpulse(1000);
        limb.joint->enableMotor(true);
        std::vector<double> errors;
        for (int i = 0; i < 30; ++i) {
          limb.step();
          errors.push_back(error(limb, target));
        }
        return errors;
      };
      const auto stock = course(static_cast<Stock*>(nullptr)),
                 ours = course(static_cast<Ours*>(nullptr));
      SCOPED_TRACE(testing::Message() << seed << normalized);
      double e = 2 * std::acos(std::min(1.0, std::abs(double(target.w()))));
      for (size_t i = 0; i < ours.size(); ++i) {
        e *= 0.7;  // of the way: the bias factor is 0.3
        EXPECT_NEAR(ours[i], e, 2e-3) << i;
      }
      EXPECT_LT(ours.back(), 1e-3);
      // Stock's single row leaves what the way has turned aside.
      EXPECT_LT(ours.back(), stock.back() + 1e-3);
    }
  }
}

// With little impulse the speed rises by what it gives: N m s about the way, or normalized rad/s.
TEST(ConeTwistMotor, IsBoundedByItsImpulseAlongTheWay) {
  for (const bool normalized : {false, true}) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      Random random(seed);
      LimbSettings settings;
      settings.at_centre = true;
      settings.free_b = seed % 2 != 0;
      Limb<Ours> limb(random, settings);
      const btVector3 way = random.unit();
      limb.joint->setMotorTargetInConstraintSpace(btQuaternion(way, 1));
      constexpr double most = 2e-4;
      normalized ? limb.joint->setMaxMotorImpulseNormalized(scalar(most))
                 : limb.joint->setMaxMotorImpulse(scalar(most));
      limb.joint->enableMotor(true);
      limb.step();
      const btVector3 axis = (limb.b->getCenterOfMassTransform() * limb.frame_b).getBasis() * way;
      const double inertia = 1 / double(axis.dot(limb.a->getInvInertiaTensorWorld() * axis));
      const double impulse = normalized ? most * inertia : most;
      const btVector3 expected = axis * scalar(impulse), got = limb.joint->getMotorImpulse();
      // The two rows across it keep it on its way, which is none of the body's axes.
      EXPECT_NEAR(got.dot(axis), impulse, 1e-3 * impulse) << seed;
      EXPECT_LT((got - expected).length(), 1.5 * impulse);
      // On body a.
      const btVector3 w = limb.a->getInvInertiaTensorWorld() * got;
      EXPECT_LT((w - limb.a->getAngularVelocity()).length(), 1e-2 * most / inertia + 1e-6);
      // Stock's first row gives the same.
      if (normalized) continue;  // does nothing in stock
      Random again(seed);
      Limb<Stock> stock(again, settings);
      stock.joint->setMotorTargetInConstraintSpace(btQuaternion(way, 1));
      stock.joint->setMaxMotorImpulse(scalar(most));
      stock.joint->enableMotor(true);
      stock.joint->enableFeedback(true);
      stock.step();
      EXPECT_NEAR(std::abs(double(stock.joint->getAppliedImpulse())), impulse, 1e-3 * impulse);
    }
  }
}

TEST(ConeTwistMotor, TurnsAtAVelocityUntilATargetIsSet) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    Random random(seed);
    LimbSettings settings;
    settings.at_centre = true;
    Limb<Ours> limb(random, settings);
    const btVector3 velocity = random.unit() * 2;
    limb.joint->setMotorVelocity(velocity);
    limb.joint->enableMotor(true);
    for (int i = 0; i < 20; ++i) limb.step();
    const btMatrix3x3 F_b = (limb.b->getCenterOfMassTransform() * limb.frame_b).getBasis();
    const btVector3 turning = limb.a->getAngularVelocity() - limb.b->getAngularVelocity();
    EXPECT_LT((turning - F_b * velocity).length(), 1e-3) << seed;
    const btQuaternion target = rotation(0.5, 0.3, 0.2);
    limb.joint->setMotorTargetInConstraintSpace(target);
    for (int i = 0; i < 120; ++i) limb.step();
    EXPECT_LT(error(limb, target), 1e-3) << seed;
    // And no farther than a limit.
    limb.joint->setLimit(1, 1, scalar(0.5));
    limb.joint->setMotorVelocity(vec(3, 0, 0));
    limb.joint->setMaxMotorImpulse(scalar(0.1));
    for (int i = 0; i < 120; ++i) limb.step();
    EXPECT_NEAR(limb.joint->getTwist(), 0.5, 1e-2) << seed;
  }
}

TEST(ConeTwistMotor, HoldsItsTargetAgainstGravityAndBlowsWhereStockSwingsOn) {
  const btQuaternion target = rotation(0.9, 0.5, 0.6);
  const auto last = [&](auto* type) {
    using Joint = std::remove_pointer_t<decltype(type)>;
    Random random(11);
    LimbSettings settings;
    settings.gravity = scenes::standard_gravity;
    Limb<Joint> limb(random, settings);
    limb.joint->setMotorTargetInConstraintSpace(target);
    limb.joint->setMaxMotorImpulse(scalar(0.2));
    limb.joint->enableMotor(true);
    double worst = 0;
    for (int i = 0; i < 600; ++i) {
      if (i == 200) limb.spin(vec(2, -3, 4));
      limb.step();
      if (i > 400) worst = std::max(worst, error(limb, target));
    }
    return worst;
  };
  EXPECT_LT(last(static_cast<Ours*>(nullptr)), 1e-3);
  EXPECT_GT(last(static_cast<Stock*>(nullptr)), 0.05) << "stock's motor cannot brake";
}

TEST(ConeTwistMotor, KeepsToTheLimits) {
  for (const Spans& spans : many_spans) {
    for (unsigned seed = 0; seed < 4; ++seed) {
      for (const double softness : {1., 0.8}) {
        SCOPED_TRACE(testing::Message() << spans << ", " << seed << ", softness " << softness);
        Random random(seed);
        Limb<Ours> limb(random);
        limb.joint->setLimit(scalar(spans.swing_1), scalar(spans.swing_2), scalar(spans.twist),
                             scalar(softness));
        const Spans soft{softness * spans.swing_1, softness * spans.swing_2,
                         softness * spans.twist};
        // Out of the cone: cut off.
        limb.joint->setMotorTargetInConstraintSpace(random.pose(0).getRotation());
        limb.joint->setMaxMotorImpulse(scalar(0.5));
        limb.joint->enableMotor(true);
        double beyond = -HUGE_VAL;
        for (int i = 0; i < 240; ++i) {
          limb.step();
          beyond = std::max({beyond, limb.beyond(soft), limb.twistBeyond(soft)});
        }
        EXPECT_LT(beyond, 0.02);
        EXPECT_LT(limb.speed(), 1e-3) << "at rest";
      }
    }
  }
}

TEST(ConeTwistMotor, TurnsWhatIsNotLocked) {
  for (const auto& [span_1, span_2] : {std::pair(0., 0.), {0., 1.}, {1., 0.}}) {
    SCOPED_TRACE(testing::Message() << span_1 << ' ' << span_2);
    Random random(12);
    LimbSettings settings;
    settings.gravity = scenes::standard_gravity;
    Limb<Ours> limb(random, settings);
    limb.joint->setLimit(scalar(span_1), scalar(span_2), scalar(1.5));
    limb.joint->setMotorTargetInConstraintSpace(rotation(0.5, 0.6, 1));
    limb.joint->enableMotor(true);
    limb.step(300);
    EXPECT_NEAR(limb.at().twist, 1, 0.01);
    EXPECT_LT(error(limb, limb.joint->getMotorTarget()), 2e-3) << "the target that is left";
    EXPECT_LT(limb.speed(), 1e-3);
    if (span_1 + span_2 > 0) {
      EXPECT_GT(limb.at().swing(), 0.1);
    }
  }
}

// --- springs, friction, impulses -----------------------------------------------------------------

TEST(ConeTwistSprings, YieldByTorqueOverStiffness) {
  // k = I w^2 of the coordinate; the swing's coordinate turns with the bodies, the twist's about x.
  Random random(13);
  for (const bool of_twist : {false, true}) {
    LimbSettings settings;
    settings.at_centre = true;
    settings.damping = 0.99;  // along the edge nothing else does
    Limb<Ours> limb(random, settings);
    const Spans spans{0.5, 0.5, 0.3};
    limb.limit(spans);
    constexpr double hz = 3, torque = 0.1;
    limb.joint->setSwingLimitSpring(hz, 1);
    limb.joint->setTwistLimitSpring(hz, 1);
    const btMatrix3x3 frame = (limb.b->getCenterOfMassTransform() * limb.frame_b).getBasis();
    const btVector3 axis = frame.getColumn(of_twist ? 0 : 2);
    const double inertia = 1 / double(axis.dot(limb.a->getInvInertiaTensorWorld() * axis));
    for (int i = 0; i < 900; ++i) {
      limb.a->applyTorque(axis * scalar(torque));
      limb.step();
    }
    const double w = 2 * pi * hz, expected = torque / (inertia * w * w);
    const double yielded = of_twist ? limb.twistBeyond(spans) : limb.beyond(spans);
    EXPECT_NEAR(yielded, expected, 0.02 * expected) << (of_twist ? "twist" : "swing");
    EXPECT_GT(expected, 0.005);
    EXPECT_LT(limb.speed(), 1e-3);
    const double impulse =
        double(of_twist ? limb.joint->getTwistLimitImpulse() : limb.joint->getSwingLimitImpulse());
    EXPECT_NEAR(impulse, -torque / 60, 0.01 * torque / 60);
  }
}

TEST(ConeTwistFriction, HoldsBelowItsTorqueAndSlidesAbove) {
  for (const double torque : {0.9, 1.5}) {
    for (const int axis_index : {0, 1, 2}) {
      Random random(14);
      LimbSettings settings;
      settings.at_centre = true;
      Limb<Ours> limb(random, settings);
      limb.joint->setFriction(1);
      const btVector3 axis =
          (limb.b->getCenterOfMassTransform() * limb.frame_b).getBasis().getColumn(axis_index);
      // The frame is that of the body's main axes.
      const double inertia = 1 / double(axis.dot(limb.a->getInvInertiaTensorWorld() * axis));
      for (int i = 0; i < 3; ++i) {
        limb.a->applyTorque(axis * scalar(torque));
        limb.step();
      }
      const double expected = torque < 1 ? 0 : (torque - 1) / inertia * 3 / 60;
      EXPECT_NEAR(limb.velocity().dot(axis), expected, 1e-3 * expected + 1e-5);
      EXPECT_NEAR(limb.joint->getFrictionImpulse().dot(axis), -std::min(torque, 1.0) / 60, 1e-4);
    }
  }
}

TEST(ConeTwistImpulses, AddUpToTheJointsTorque) {
  Random random(15);
  for (int n = 0; n < 10; ++n) {
    LimbSettings settings;
    settings.iterations = 50;
    Limb<Ours> limb(random, settings);
    limb.joint->setAngularOnly(true);
    limb.joint->setLimit(scalar(0.4), scalar(0.4), scalar(0.3));
    limb.put(rotation(0.45, 1, 0.35));
    limb.joint->setFriction(scalar(0.1));
    limb.joint->setMaxMotorImpulse(scalar(0.01));
    limb.joint->setMotorTargetInConstraintSpace(btQuaternion::getIdentity());
    limb.joint->enableMotor(true);
    limb.a->setAngularVelocity(random.vector(3));
    btJointFeedback feedback;
    limb.joint->setJointFeedback(&feedback);
    limb.joint->enableFeedback(true);
    pintle::RowMemory<8, 8> memory;
    const pintle::BodyPair pair(*limb.a, *limb.b);
    const pintle::StepMotion motion{pair, scalar(1. / 60), 0, 1, false};
    // (The exact solver takes the rows of the pose alone.)
    pintle::Rows rows(memory, onExactSolver() ? nullptr : &motion);
    limb.joint->addRows(pair, rows);
    ASSERT_EQ(rows.size(), 5);
    // In which a turns as the coordinate grows.
    const auto direction = [&](int i) {
      const pintle::Vec3 J = -pintle::Scalar(rows.axis(rows[i].axis).sign) * rows[i].A_b;
      return btVector3(J.x(), J.y(), J.z());
    };
    limb.step();
    const btVector3 sum = limb.joint->getMotorImpulse() + limb.joint->getFrictionImpulse() +
                          direction(3) * limb.joint->getSwingLimitImpulse() +
                          direction(4) * limb.joint->getTwistLimitImpulse();
    EXPECT_LT((sum - feedback.m_appliedTorqueBodyA / 60).length(), 1e-5) << n;
    EXPECT_GT(sum.length(), 1e-3);
    EXPECT_GT(limb.joint->getMotorImpulse().length(), 1e-4);
    EXPECT_LE(limb.joint->getSwingLimitImpulse(), 0);
    EXPECT_LE(limb.joint->getTwistLimitImpulse(), 0);
  }
}

// --- feedback, breaking --------------------------------------------------------------------------

TEST(DropInConeTwist, FeedbackAndBreakingAreStocks) {
  const auto run = [](auto* type, bool breaks) {
    using Joint = std::remove_pointer_t<decltype(type)>;
    Random random(16);
    LimbSettings settings;
    settings.gravity = scenes::standard_gravity;
    settings.iterations = 50;
    Limb<Joint> limb(random, settings);
    limb.joint->setLimit(scalar(0.3), scalar(0.3), scalar(0.3));
    limb.a->setDamping(scalar(0.9), scalar(0.9));
    btJointFeedback feedback;
    limb.joint->setJointFeedback(&feedback);
    limb.joint->enableFeedback(true);
    limb.step(600);
    if (breaks) limb.joint->setBreakingImpulseThreshold(scalar(0.5));
    int step = 0;
    while (step < 300 && limb.joint->isEnabled() && breaks) {
      limb.a->applyCentralForce(vec(0, 0, -step));
      limb.step();
      ++step;
    }
    return std::pair(feedback, step);
  };
  const auto stock = run(static_cast<Stock*>(nullptr), false),
             ours = run(static_cast<Ours*>(nullptr), false);
  const double weight = scenes::standard_gravity;
  EXPECT_NEAR(ours.first.m_appliedForceBodyA.z(), weight, 0.01 * weight);
  EXPECT_LT((stock.first.m_appliedForceBodyA - ours.first.m_appliedForceBodyA).length(),
            0.02 * weight);
  EXPECT_LT((stock.first.m_appliedForceBodyB - ours.first.m_appliedForceBodyB).length(),
            0.02 * weight);
  EXPECT_LT((stock.first.m_appliedTorqueBodyB - ours.first.m_appliedTorqueBodyB).length(), 0.05);
  EXPECT_LT((stock.first.m_appliedTorqueBodyA - ours.first.m_appliedTorqueBodyA).length(), 0.05);
  const int stock_step = run(static_cast<Stock*>(nullptr), true).second,
            our_step = run(static_cast<Ours*>(nullptr), true).second;
  EXPECT_GT(stock_step, 5);
  EXPECT_LT(our_step, 300);
  EXPECT_NEAR(our_step, stock_step, 2);
}

// --- where stock fails ---------------------------------------------------------------------------

template <class Joint>
double energyOverThatOfTheThrow(const Spans& spans) {
  return thrown<Joint>(spans, 3, 8, false).energy;
}

TEST(ConeTwistBeyondStock, AFlatConeAddsNoEnergy) {
  EXPECT_GT(energyOverThatOfTheThrow<Stock>({0.1, 1.2, 0.3}), 5);
  EXPECT_LT(energyOverThatOfTheThrow<Ours>({0.1, 1.2, 0.3}), 1.001);
}

TEST(ConeTwistBeyondStock, SwingsOfUpToHalfATurnKeepTheirTwist) {
  scenes::ShoulderSettings settings;
  settings.span_1 = settings.span_2 = radians(170);
  const auto stock = scenes::shoulder<Stock>(settings);
  const auto ours = scenes::shoulder<Ours>(settings);
  EXPECT_GT(stock.twist_beyond, 1);
  EXPECT_LT(ours.twist_beyond, 0.02);
  EXPECT_LT(ours.swing_beyond, 0.02);
}

TEST(ConeTwistBeyondStock, TwistOfATwistedLimbIsHeldAboutTheAxisThatItIsAbout) {
  // Swung by 2 rad: stock's row is along x of b, 1 rad off the axis of the twist.
  const auto twist = [](auto* type) {
    using Joint = std::remove_pointer_t<decltype(type)>;
    Random random(17);
    LimbSettings settings;
    settings.damping = 0.2;
    Limb<Joint> limb(random, settings);
    limb.joint->setLimit(3, 3, scalar(0.5));
    limb.put(rotation(2, 1, 0));
    double worst = 0;
    for (int i = 0; i < 300; ++i) {
      limb.a->applyTorque(limb.a->getCenterOfMassTransform().getBasis().getColumn(0) * scalar(0.2));
      limb.step();
      worst = std::max(worst, limb.twistBeyond({3, 3, 0.5}));
    }
    return worst;
  };
  EXPECT_LT(twist(static_cast<Ours*>(nullptr)), 0.01);
  EXPECT_GT(twist(static_cast<Stock*>(nullptr)), 0.1);
}

// --- settings that are refused -------------------------------------------------------------------

// Bullet's own methods take anything. What is no number is not used, and the joint says so.
TEST(ContractOfTheConeTwist, OfWhatIsNotANumberTheLastGoodOneStays) {
  struct Setting {
    const char* field;  ///< empty: nothing is made of it
    std::function<void(Ours&, btScalar)> call;
    bool negative_is_good, infinity_is_good;
  };
  const auto set = [](Ours& j, int i, btScalar value) {
    btScalar x[] = {scalar(0.4), scalar(0.5), scalar(0.3), scalar(0.9), scalar(0.4), scalar(0.8)};
    if (i >= 0) x[i] = value;
    j.setLimit(x[0], x[1], x[2], x[3], x[4], x[5]);
  };
  const Setting settings[] = {
      {"swing span 1", [=](Ours& j, btScalar v) { set(j, 0, v); }, true, true},
      {"swing span 2", [=](Ours& j, btScalar v) { set(j, 1, v); }, true, true},
      {"twist span", [=](Ours& j, btScalar v) { set(j, 2, v); }, true, true},
      {"softness", [=](Ours& j, btScalar v) { set(j, 3, v); }, false, false},
      {"bias", [=](Ours& j, btScalar v) { set(j, 4, v); }, false, false},
      {"relaxation", [=](Ours& j, btScalar v) { set(j, 5, v); }, true, false},
      {"twist span", [](Ours& j, btScalar v) { j.setLimit(3, v); }, true, true},
      {"swing span 2", [](Ours& j, btScalar v) { j.setLimit(4, v); }, true, true},
      {"swing span 1", [](Ours& j, btScalar v) { j.setLimit(5, v); }, true, true},
      {"fix threshold", [](Ours& j, btScalar v) { j.setFixThresh(v); }, true, false},
      {"", [](Ours& j, btScalar v) { j.setDamping(v); }, true, true},
      {"motor impulse", [](Ours& j, btScalar v) { j.setMaxMotorImpulse(v); }, true, true},
      {"motor impulse", [](Ours& j, btScalar v) { j.setMaxMotorImpulseNormalized(v); }, true, true},
      {"motor target",
       [](Ours& j, btScalar v) {
         j.setMotorTarget({0, v, 0, 1});
       },
       true, false},
      {"motor target",
       [](Ours& j, btScalar v) {
         j.setMotorTargetInConstraintSpace({v, 0, 0, 1});
       },
       true, false},
      {"ERP", [](Ours& j, btScalar v) { j.setParam(BT_CONSTRAINT_ERP, v, 0); }, false, false},
      {"bias", [](Ours& j, btScalar v) { j.setParam(BT_CONSTRAINT_STOP_ERP, v, 3); }, false, false},
      {"CFM", [](Ours& j, btScalar v) { j.setParam(BT_CONSTRAINT_CFM, v, 1); }, false, false},
      {"CFM", [](Ours& j, btScalar v) { j.setParam(BT_CONSTRAINT_STOP_CFM, v); }, false, false},
  };
  const auto a = support::body(1, vec(1, 2, 3), btTransform(rotation(0.5, 1, 0.4)));
  const auto b = support::body(1, vec(1, 2, 3), identity);
  const auto fresh = [&] {
    auto joint = std::make_unique<Ours>(*a, *b, identity, identity);
    set(*joint, -1, 0);
    joint->setMaxMotorImpulse(scalar(0.5));
    joint->setMotorTargetInConstraintSpace(rotation(0.2, 1, 0.1));
    joint->enableMotor(true);
    for (const int axis : {0, 3}) joint->setParam(BT_CONSTRAINT_CFM, scalar(0.01), axis);
    joint->setParam(BT_CONSTRAINT_ERP, scalar(0.3), 0);
    SolverRows::ofStep(*joint);
    return joint;
  };
  for (const Setting& setting : settings) {
    for (const btScalar value : {nan_value, infinite, scalar(-1), scalar(0.5)}) {
      SCOPED_TRACE(testing::Message() << setting.field << " = " << value);
      const auto joint = fresh(), twin = fresh();
      EXPECT_EQ(SolverRows::ofStep(*joint), SolverRows::ofStep(*twin));
      ASSERT_NO_THROW(setting.call(*joint, value));
      const SolverRows rows = SolverRows::ofStep(*joint);
      EXPECT_TRUE(rows.finite());
      const std::string why = joint->whyIgnored();
      const bool is_good =
          value > 0 ? value < 1 || setting.infinity_is_good : value < 0 && setting.negative_is_good;
      if (is_good || setting.field == std::string()) {
        EXPECT_EQ(why, "");
        continue;
      }
      EXPECT_NE(why.find("ConeTwistJoint"), std::string::npos) << why;
      EXPECT_NE(why.find(setting.field), std::string::npos) << why;
      if (value < 0) setting.call(*twin, 0);
      EXPECT_EQ(rows, SolverRows::ofStep(*twin)) << "as 0, or as before";
      setting.call(*joint, scalar(0.5));
      EXPECT_EQ(joint->whyIgnored(), "");
    }
  }
  const auto joint = fresh(), twin = fresh();
  joint->setMotorTargetInConstraintSpace({0, 0, 0, 0});
  EXPECT_NE(joint->whyIgnored().find("motor target"), std::string::npos);
  for (const int i : {0, 2, 6}) joint->setLimit(i, 1);  // Bullet has none
  joint->setFrames(identity, btTransform(btMatrix3x3::getIdentity(), vec(0, nan_value, 0)));
  EXPECT_NE(joint->whyIgnored().find("joint frames"), std::string::npos);
  EXPECT_EQ(SolverRows::ofStep(*joint), SolverRows::ofStep(*twin));
}

TEST(ContractOfTheConeTwist, RefusesBadSettingsAndStaysAsItWas) {
  struct Setting {
    const char* field;
    std::function<void(Ours&, btScalar)> call;
    bool negative_is_good, infinity_is_good;
  };
  const Setting settings[] = {
      {"swing 1 max", [](Ours& j, btScalar v) { j.setSwingLimits(0, v, 0, 1); }, false, true},
      {"swing 2 max", [](Ours& j, btScalar v) { j.setSwingLimits(0, 1, 0, v); }, false, true},
      {"swing 1 min", [](Ours& j, btScalar v) { j.setSwingLimits(-v, 1, 0, 1); }, false, true},
      {"swing 2 min", [](Ours& j, btScalar v) { j.setSwingLimits(0, 1, -v, 1); }, false, true},
      {"twist low", [](Ours& j, btScalar v) { j.setTwistLimit(v, 1); }, true, false},
      {"twist high", [](Ours& j, btScalar v) { j.setTwistLimit(0, v); }, true, false},
      {"frequency", [](Ours& j, btScalar v) { j.setSwingLimitSpring(v, 1); }, false, false},
      {"damping", [](Ours& j, btScalar v) { j.setTwistLimitSpring(1, v); }, false, false},
      {"torque", [](Ours& j, btScalar v) { j.setFriction(v); }, false, true},
      {"correction speed", [](Ours& j, btScalar v) { j.setMaxCorrectionSpeed(v); }, false, false},
  };
  const auto a = support::body(1, vec(1, 2, 3), btTransform(rotation(0.5, 1, 0.4)));
  const auto b = support::body(1, vec(1, 2, 3), identity);
  const auto fresh = [&] {
    auto joint = std::make_unique<Ours>(*a, *b, identity, identity);
    joint->setLimit(scalar(0.4), scalar(0.5), scalar(0.3), scalar(0.9), scalar(0.4), scalar(0.8));
    joint->setMaxMotorImpulse(scalar(0.5));
    joint->setMotorTargetInConstraintSpace(rotation(0.2, 1, 0.1));
    joint->enableMotor(true);
    return joint;
  };
  const auto message = [](const std::function<void()>& call) -> std::string {
    try {
      call();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  const auto expectBad = [&](const std::function<void(Ours&)>& call, const char* field) {
    const auto joint = fresh(), twin = fresh();
    const std::string said = message([&] { call(*joint); });
    EXPECT_NE(said.find("ConeTwistJoint"), std::string::npos) << field << ": " << said;
    EXPECT_NE(said.find(field), std::string::npos) << said;
    EXPECT_NE(said.find(" = "), std::string::npos) << said;
    EXPECT_EQ(SolverRows::ofStep(*joint), SolverRows::ofStep(*twin)) << field;
  };
  for (const Setting& setting : settings) {
    const auto with = [&](btScalar v) { return [&setting, v](Ours& j) { setting.call(j, v); }; };
    const auto expectGood = [&](btScalar v) {
      const auto joint = fresh();
      EXPECT_EQ(message([&] { setting.call(*joint, v); }), "accepted") << setting.field << ' ' << v;
      EXPECT_TRUE(SolverRows::ofStep(*joint).finite()) << setting.field << ' ' << v;
    };
    expectBad(with(nan_value), setting.field);
    setting.negative_is_good ? expectGood(-1) : expectBad(with(-1), setting.field);
    setting.infinity_is_good ? expectGood(infinite) : expectBad(with(infinite), setting.field);
    expectGood(scalar(0.5));
  }
  expectBad([](Ours& j) { j.setTwistLimit(7, 8); }, "twist low");
}

// --- drawing -------------------------------------------------------------------------------------

TEST(ConeTwistDrawing, DrawsWhatIsAskedFor) {
  Random random(18);
  for (const bool limited : {false, true}) {
    Limb<Ours> limb(random);
    if (limited) limb.joint->setLimit(scalar(0.5), scalar(0.9), scalar(0.4));
    const auto lines = [&](int mode) { return drawing::linesOf(*limb.joint, mode); };
    EXPECT_EQ(lines(0), 0);
    EXPECT_EQ(lines(btIDebugDraw::DBG_DrawConstraints), 6);
    const int limits = lines(btIDebugDraw::DBG_DrawConstraintLimits);
    EXPECT_GT(limits, limited ? 40 : 0);
  }
}

}  // namespace cone_twist_joint_test
