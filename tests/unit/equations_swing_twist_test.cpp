// Swing and twist: the decomposition, and the rows of the twist angle and of the swing's components
// against automatic differentiation and central differences, up to a swing of half a turn.
#include <gtest/gtest.h>
#include <pintle/equations/swing_twist.h>
#include <pintle/precision.h>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;

template <class T>
class SwingTwist : public testing::Test {
 public:
  static constexpr double kEpsilon = double(std::numeric_limits<T>::epsilon());
  // About as many roundings lie between the poses and an entry of a row.
  static constexpr double kTolerance = 20 * kEpsilon;

  static equations::Swing<T> swing(const Hinge& hinge) {
    return equations::swing<T>(hinge.axis_a(2).cast<T>(), hinge.axis_b(2).cast<T>());
  }
};
using Scalars = testing::Types<double, pintle::Scalar>;
TYPED_TEST_SUITE(SwingTwist, Scalars);

const std::vector<double> kSmoothSwings = {0, 1e-8, 1e-3, 3e-3, 4e-3, -pi, pi - 1e-4};
const std::vector<double> kSwingsNearHalfATurn = {0, 1e-8, 1e-3, -pi, pi - 1e-4, pi - 1e-8, pi};

// How much of the digits a direction normal to both axes keeps.
double loss(double swing) { return 1 + (swing > 1 ? swing / std::max(std::sin(swing), 1e-5) : 0); }

// The rotation vector of q = (w, v), w >= 0.
template <class T>
Vector3<T> logarithm(const Quaternion<T>& q) {
  using std::atan2;
  using std::sqrt;
  const T sine2 = q.v.dot(q.v);
  if (sine2 < T(1e-6)) {
    const T t2 = sine2 / (q.w * q.w);  // atan's series; the next term is 1e-19
    return q.v * T(T(2) / q.w * (T(1) - t2 / T(3) + t2 * t2 / T(5)));
  }
  const T sine = sqrt(sine2);
  return q.v * T(T(2) * atan2(sine, q.w) / sine);
}

template <class T>
equations::SwingTwist<T> parts(const Quaternion<T>& q) {
  return equations::swing_twist<T>(q, Vector3<T>(T(0), T(0), T(1)));
}

TYPED_TEST(SwingTwist, PartsAreASwingAfterATwistOfUnitLengthAtAnySwing) {
  using T = TypeParam;
  for (const Hinge& hinge : hinges(kSwingsNearHalfATurn, {0})) {
    const Turn exact = turn(hinge, hinge.bodies);
    const Quaternion<T> q{T(exact.w), exact.v.cast<T>()};
    const auto found = parts(q);
    const Quaternion<T> product = equations::product(found.swing, found.twist);
    ASSERT_LE(std::abs(double(product.w - q.w)), this->kTolerance);
    ASSERT_LE(mismatch(product.v, q.v), T(this->kTolerance));
    for (const auto& part : {found.swing, found.twist}) {
      ASSERT_LE(std::abs(double(part.w * part.w + part.v.dot(part.v)) - 1), this->kTolerance);
    }
    ASSERT_EQ(found.twist.v.x(), T(0));
    ASSERT_EQ(found.twist.v.y(), T(0));
    ASSERT_LE(std::abs(double(found.swing.v.z())), this->kTolerance);
    ASSERT_GE(double(found.swing.w), -this->kTolerance);
    // All of the axis's turn is the swing's.
    const Vector3<T> z = Vector3<T>::Unit(2);
    ASSERT_LE(mismatch(equations::rotate(found.swing, z), equations::rotate(q, z)),
              T(this->kTolerance));
    // The twist is that which the pose was made with, where there is one.
    const double cosine = std::cos(hinge.swing / 2);
    if (cosine < 1e-6) continue;
    const double sign = hinge.sign;
    EXPECT_LE(std::abs(double(found.twist.w) - sign * std::cos(hinge.th / 2)),
              this->kTolerance / cosine);
    EXPECT_LE(std::abs(double(found.twist.v.z()) - sign * std::sin(hinge.th / 2)),
              this->kTolerance / cosine);
  }
}

TYPED_TEST(SwingTwist, PartsAboutAnyAxisAreThoseAboutZInAnotherBasis) {
  using T = TypeParam;
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    const Vector axis = random.unit();
    const Turn q = random.turn();
    const auto found = equations::swing_twist<T>({T(q.w), q.v.cast<T>()}, axis.cast<T>());
    const Turn to_z = equations::shortest_rotation<double>(axis, Vector::Unit(2));
    const auto expected = parts(Turn{q.w, equations::rotate(to_z, q.v)});
    // A swing of nearly pi leaves less of the twist's digits.
    const double tolerance = this->kTolerance / std::max(1e-3, std::abs(expected.swing.w));
    ASSERT_LE(std::abs(double(found.twist.w) - expected.twist.w), tolerance);
    ASSERT_LE(mismatch(found.swing.v.template cast<double>(),
                       equations::rotate(equations::conjugate(to_z), expected.swing.v)),
              tolerance);
  }
}

TYPED_TEST(SwingTwist, SwingOfExactlyPiHasNoTwist) {
  using T = TypeParam;
  const auto found = parts(Quaternion<T>{T(0), Vector3<T>(T(0.6), T(-0.8), T(0))});
  EXPECT_EQ(found.twist.w, T(1));
  EXPECT_EQ(found.twist.v, Vector3<T>::Zero());
  EXPECT_EQ(found.swing.w, T(0));
  EXPECT_EQ(found.swing.v, Vector3<T>(T(0.6), T(-0.8), T(0)));
}

TYPED_TEST(SwingTwist, ShortestRotationIsTheSwing) {
  using T = TypeParam;
  for (const Hinge& hinge : hinges(kSmoothSwings, {0})) {
    const auto expected = parts(turn(hinge, hinge.bodies)).swing;
    const Vector z = Vector::Unit(2);
    const Vector c_b = equations::rotate(turn(hinge, hinge.bodies), z);
    const auto found = equations::shortest_rotation<T>(z.cast<T>(), c_b.cast<T>());
    const double tolerance = this->kTolerance * loss(hinge.swing);
    ASSERT_LE(std::abs(double(found.w) - expected.w), tolerance);
    ASSERT_LE(mismatch(found.v.template cast<double>(), expected.v), tolerance);
  }
  for (unsigned seed = 0; seed < 100; ++seed) {
    Random random(seed);
    const Vector3<T> a = random.unit().cast<T>(), b = -a;
    const auto half_turn = equations::shortest_rotation<T>(a, b);
    ASSERT_LE(mismatch(equations::rotate(half_turn, a), b), T(this->kTolerance));
    const auto none = equations::shortest_rotation<T>(a, a);
    ASSERT_LE(std::abs(double(none.w) - 1), this->kTolerance);
    ASSERT_LE(mismatch(none.v, Vector3<T>(Vector3<T>::Zero())), T(this->kEpsilon));
  }
}

TYPED_TEST(SwingTwist, TwistAngleIsTheQuaternionsAndInTheRange) {
  using T = TypeParam;
  for (const Hinge& hinge : hinges(kSmoothSwings, {0})) {
    const auto dot = [&](int i, int j) {
      return Vector3<T>(hinge.axis_a(i).cast<T>()).dot(Vector3<T>(hinge.axis_b(j).cast<T>()));
    };
    const auto twist = equations::twist<T>(dot(0, 0), dot(1, 1), dot(1, 0), dot(0, 1));
    const double found = double(equations::twist_angle(twist));
    ASSERT_LE(found, pi + this->kEpsilon);
    ASSERT_GE(found, -pi - this->kEpsilon);
    const double cosine = std::cos(hinge.swing / 2);
    ASSERT_LE(std::abs(std::remainder(found - hinge.th, 2 * pi)),
              this->kTolerance / (cosine * cosine));
    const auto q = parts(turn(hinge, hinge.bodies)).twist;
    ASSERT_LE(std::abs(std::remainder(found - 2 * std::atan2(q.v.z(), q.w), 2 * pi)),
              this->kTolerance / (cosine * cosine));
  }
  EXPECT_EQ(equations::twist_angle<T>({T(-1), T(-0.0)}), T(pi));
  EXPECT_EQ(equations::twist_angle<T>({T(-1), T(0)}), T(pi));
  EXPECT_EQ(equations::twist_angle<T>({T(0), T(0)}), T(0));
}

TYPED_TEST(SwingTwist, TwistRowIsTheGradient) {
  for (const Hinge& hinge : hinges(kSmoothSwings, {0, 1})) {
    const auto C = [&](const auto& bodies) {
      using std::atan2;
      const auto p = turn(hinge, bodies);
      using S = std::decay_t<decltype(p.w)>;
      // Half a turn away from the cut of the arctangent.
      const S sign(hinge.sign * (hinge.th < 0 ? -1 : 1));
      return std::abs(hinge.th) < 2 ? S(S(2) * atan2(p.v.z() * S(hinge.sign), p.w * S(hinge.sign)))
                                    : S(S(-2) * atan2(p.w * sign, p.v.z() * sign));
    };
    const auto row = equations::twist_row(this->swing(hinge));
    const double tolerance = this->kTolerance * loss(hinge.swing) / std::cos(hinge.swing / 2);
    ASSERT_LE(mismatch(angular_row(row), gradient(C, hinge.bodies)), tolerance);
    if (hinge.swing < 2) {
      ASSERT_LE(mismatch(angular_row(row), difference(C, hinge.bodies)),
                tolerance + 3 * difference_tolerance);
    }
  }
}

TYPED_TEST(SwingTwist, SwingComponentsAndTheirRowsAreTheGradient) {
  using T = TypeParam;
  for (const Hinge& hinge : hinges(kSmoothSwings, {0, 1})) {
    for (const double direction : {0.0, pi / 2, 2.0}) {
      const double cosine = std::cos(direction), sine = std::sin(direction);
      const auto C = [&](const auto& bodies) {
        const auto sigma = logarithm(parts(turn(hinge, bodies)).swing);
        using S = std::decay_t<decltype(sigma[0])>;
        return S(S(cosine) * sigma[0] + S(sine) * sigma[1]);
      };
      const Vector e = cosine * hinge.axis_a(0) + sine * hinge.axis_a(1);
      const auto swing = this->swing(hinge);
      const auto row = equations::swing_row<T>(swing, hinge.axis_a(2).cast<T>(), e.cast<T>());
      const double lost = loss(hinge.swing);
      ASSERT_LE(std::abs(double(swing.sigma.dot(e.cast<T>())) - C(hinge.bodies)),
                this->kTolerance * lost);
      // The row is as long as the loss, and as much of its digits is lost.
      ASSERT_LE(mismatch(angular_row(row), gradient(C, hinge.bodies)),
                this->kTolerance * lost * lost)
          << hinge.swing;
      if (hinge.swing < 2) {
        ASSERT_LE(mismatch(angular_row(row), difference(C, hinge.bodies)),
                  this->kTolerance * lost * lost + 3 * difference_tolerance);
      }
    }
  }
}

TYPED_TEST(SwingTwist, SwingRowIsContinuousWhereItsSeriesTakesOver) {
  using T = TypeParam;
  const double threshold = std::sqrt(1e-5);
  for (const double factor : {0.999, 1.001}) {
    const Hinge hinge = make_hinge(3, 0.4, threshold * factor, 0, 1);
    const auto swing = this->swing(hinge);
    const Vector n = hinge.halfway(hinge.m), e = hinge.axis_a(0), c = hinge.axis_a(2);
    const Vector m = cross(n, c);
    const double angle = hinge.swing;
    const Vector expected = n.dot(e) * n + m.dot(e) * (angle / std::tan(angle) * m - angle * c);
    const auto row = equations::swing_row<T>(swing, c.cast<T>(), e.cast<T>());
    // n is only known to epsilon over the angle here; what it multiplies is angle^2/3.
    EXPECT_LE(mismatch(row.template cast<double>(), expected), this->kTolerance);
  }
}

TYPED_TEST(SwingTwist, AllIsFiniteAndDefiniteAtHalfATurnAndForZeroVectors) {
  using T = TypeParam;
  const Vector3<T> zero = Vector3<T>::Zero();
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const Vector3<T> a = random.unit().cast<T>(), e = pintle::any_tangent(a);
    for (const Vector3<T>& b : {Vector3<T>(-a), a, zero}) {
      const auto swing = equations::swing<T>(a, b);
      const auto row = equations::swing_row<T>(swing, a, e);
      const auto axis = equations::swing_axis(swing, a);
      ASSERT_TRUE(row.allFinite());
      ASSERT_TRUE(equations::twist_row(swing).allFinite());
      ASSERT_LE(std::abs(double(axis.dot(axis)) - 1), this->kTolerance);
      ASSERT_LE(std::abs(double(axis.dot(a))), this->kTolerance);
    }
    // Exactly opposite: of unit length along the swing, nothing across.
    const auto swing = equations::swing<T>(a, Vector3<T>(-a));
    const auto n = equations::swing_axis(swing, a);
    ASSERT_LE(mismatch(equations::swing_row<T>(swing, a, n), n), T(this->kTolerance));
    ASSERT_LE(equations::swing_row<T>(swing, a, cross(a, n)).norm(), T(this->kTolerance));
  }
  const auto swing = equations::swing<T>(zero, zero);
  EXPECT_TRUE(equations::swing_row<T>(swing, zero, zero).allFinite());
  EXPECT_TRUE(equations::swing_axis(swing, zero).allFinite());
  EXPECT_TRUE(equations::twist_row(swing).allFinite());
  const auto q = parts(Quaternion<T>{T(0), zero});
  EXPECT_TRUE(q.swing.v.allFinite() && q.twist.w == T(1));
}

TYPED_TEST(SwingTwist, TwistAgainstALimitIsClassifiedWithoutError) {
  // Poses within 100 epsilon of the limit are left out, and swings within a degree of half a turn.
  using T = TypeParam;
  Random random(11);
  int wrong = 0, counted = 0;
  for (int i = 0; i < 100000; ++i) {
    const double th = random.uniform(-pi, pi), limit = random.uniform(0, pi);
    const double swing = random.uniform(0, 179 * pi / 180), direction = random.uniform(-pi, pi);
    const Vector axis(std::cos(direction), std::sin(direction), 0), z = Vector::Unit(2);
    const Turn q = equations::product(equations::rotation<double>(axis, swing),
                                      equations::rotation<double>(z, th));
    const Turn q_a = random.turn(), q_b = equations::product(q_a, q);
    const auto world = [](const Turn& at, int k) {
      return Vector3<T>(equations::rotate<double>(at, Vector::Unit(k)).template cast<T>());
    };
    const double cosine = std::cos(swing / 2);
    if (std::abs(std::abs(th) - limit) < 100 * this->kEpsilon / (cosine * cosine)) continue;
    const auto dot = [&](int e, int f) { return world(q_a, e).dot(world(q_b, f)); };
    const auto twist = equations::twist<T>(dot(0, 0), dot(1, 1), dot(1, 0), dot(0, 1));
    wrong += (std::abs(equations::twist_angle(twist)) > T(limit)) != (std::abs(th) > limit);
    ++counted;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(counted, 95000);
}

}  // namespace
