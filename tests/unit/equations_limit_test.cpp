// The angle of a hinge: the document's half-sine coordinate over any number of turns and its row,
// the twist in radians and its row, against automatic differentiation and central differences.
#include <gtest/gtest.h>
#include <pintle/equations/quaternion_hinge_limit.h>
#include <pintle/precision.h>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;

template <class T>
class HingeLimit : public testing::Test {
 public:
  static constexpr double kEpsilon = double(std::numeric_limits<T>::epsilon());
  // About as many roundings lie between the poses and an entry of a row.
  static constexpr double kTolerance = 20 * kEpsilon;

  static equations::AngularRow<T> limit_row(const Turn& p, const Hinge& hinge, double turns) {
    const Matrix3<double> F = matrix(hinge.frame_a());
    return equations::quaternion_hinge_limit_row<T>({T(p.w), p.v.cast<T>()}, F.cast<T>(),
                                                    Vector3<T>::Unit(2), T(turns));
  }
};
using Scalars = testing::Types<double, pintle::Scalar>;
TYPED_TEST_SUITE(HingeLimit, Scalars);

// --- the half-sine coordinate --------------------------------------------------------------------

TYPED_TEST(HingeLimit, HalfSineIsTheDocumentsWithinATurn) {
  using T = TypeParam;
  for (int i = -1000; i <= 1000; ++i) {
    const T angle = T(pi) * T(i) / T(1000);
    ASSERT_LE(std::abs(double(equations::half_sine(angle, T(0))) - std::sin(double(angle) / 2)),
              2 * this->kEpsilon);
  }
}

TYPED_TEST(HingeLimit, HalfSineIsMonotoneOverManyTurns) {
  using T = TypeParam;
  // Steps of 0.01 rad: where the slope is zero the coordinate still grows by 6e-6, twelve times the
  // spacing of float at the end of this range.
  double last = -100;
  for (int i = -2500; i <= 2500; ++i) {
    const double angle = 0.01 * i + 0.003, turns = std::round(angle / (2 * pi));
    const double l = double(equations::half_sine(T(angle - 2 * pi * turns), T(turns)));
    ASSERT_GT(l, last) << angle;
    last = l;
  }
}

TYPED_TEST(HingeLimit, HalfSineIsContinuousWhereTheTurnsChange) {
  using T = TypeParam;
  for (int turns = -20; turns < 20; ++turns) {
    const T below = equations::half_sine(T(pi), T(turns));
    const T above = equations::half_sine(T(-pi), T(turns + 1));
    ASSERT_LE(std::abs(double(below - above)), this->kEpsilon * (2 * std::abs(turns) + 2));
    ASSERT_LE(std::abs(double(below) - (2 * turns + 1)),
              this->kEpsilon * (2 * std::abs(turns) + 2));
  }
}

TEST(HalfSine, HasTheSlopeOfTheCosineAndNoneAtHalfATurn) {
  for (int i = -100; i <= 100; ++i) {
    const double angle = pi * i / 100;
    const Dual l = equations::half_sine(Dual(angle, Velocities::Unit(0)), Dual(3));
    const double slope =
        (equations::half_sine(angle + step, 3.0) - equations::half_sine(angle - step, 3.0)) /
        (2 * step);
    ASSERT_LE(std::abs(l.derivatives()[0] - std::cos(angle / 2) / 2), epsilon);
    ASSERT_LE(std::abs(slope - std::cos(angle / 2) / 2), difference_tolerance);
  }
}

// --- its row -------------------------------------------------------------------------------------

TYPED_TEST(HingeLimit, DocumentsRowIsTheGradientOnAndOffTheManifoldOfBothSigns) {
  for (const Hinge& hinge : hinges({0, 1e-8, -pi, pi - 1e-8, pi}, {0, 1})) {
    const Turn p = turn(hinge, hinge.bodies);
    const double turns = int(hinge.sign * 2);
    const auto row = this->limit_row(p, hinge, turns);
    const double sign = p.w < 0 ? -1 : 1;
    const auto C = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      return S(S(sign) * turn(hinge, bodies).v.z() + S(2 * turns));
    };
    ASSERT_LE(std::abs(double(row.C) - C(hinge.bodies)), this->kTolerance);
    const Velocities J = angular_row(row.J_b);
    ASSERT_LE(mismatch(J, gradient(C, hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(J, difference(C, hinge.bodies)), this->kTolerance + difference_tolerance);
    if (p.w != 0) {
      const auto opposite = this->limit_row({-p.w, -p.v}, hinge, turns);
      ASSERT_EQ(row.C, opposite.C);
      ASSERT_EQ(row.J_b, opposite.J_b);
    }
  }
}

TYPED_TEST(HingeLimit, DocumentsRowIsHalfTheRealPartLongAndVanishesAtPi) {
  for (const Hinge& hinge : hinges({0}, {0})) {
    const auto row = this->limit_row(turn(hinge, hinge.bodies), hinge, 0);
    const double length = std::sqrt(double(row.J_b.dot(row.J_b)));
    ASSERT_LE(std::abs(length - std::abs(std::cos(hinge.th / 2)) / 2), this->kTolerance);
    // It pushes along the hinge's axis, forwards, at any angle and of either sign of p.
    ASSERT_GE(double(row.J_b.dot(hinge.axis_a(2).template cast<TypeParam>())), -this->kTolerance);
  }
}

TYPED_TEST(HingeLimit, DocumentsCoordinateIsTheHalfSineOfTheAngleOverManyTurns) {
  // Up to 1e-8 from half a turn, where the real part still has a sign.
  for (int half = -9; half <= 9; ++half) {
    for (const double off : {-1.5, -1.0, -1e-3, -1e-8, 1e-8, 1e-3, 1.0, 1.5}) {
      const double th = half * pi + off, turns = std::round(th / (2 * pi));
      for (const double sign : {1.0, -1.0}) {
        const Hinge hinge = make_hinge(unsigned(half + 20), th, 0, 0, sign);
        const auto row = this->limit_row(turn(hinge, hinge.bodies), hinge, turns);
        const double expected = equations::half_sine(th - 2 * pi * turns, turns);
        ASSERT_LE(std::abs(double(row.C) - expected), this->kTolerance);
      }
    }
  }
}

TYPED_TEST(HingeLimit, DocumentsCoordinateDoesNotJumpAcrossHalfATurn) {
  for (int odd = -7; odd <= 7; odd += 2) {
    double C[2];
    for (int side = 0; side < 2; ++side) {
      const double th = odd * pi + (side ? 1e-8 : -1e-8), turns = std::round(th / (2 * pi));
      const Hinge hinge = make_hinge(3, th, 0, 0, 1);
      C[side] = double(this->limit_row(turn(hinge, hinge.bodies), hinge, turns).C);
    }
    // The slope is zero there: what is left is rounding.
    ASSERT_LE(std::abs(C[1] - C[0]), this->kTolerance);
  }
}

// --- the twist -----------------------------------------------------------------------------------

template <class T>
equations::Twist<T> twist(const Hinge& hinge, const Bodies<T>& bodies) {
  const auto axis = [](const Quaternion<T>& q, const Turn& f, int i) {
    return equations::rotate(equations::product(q, constant<T>(f)), constant<T>(Vector::Unit(i)));
  };
  const auto a_a = axis(bodies.q_a, hinge.f_a, 0), b_a = axis(bodies.q_a, hinge.f_a, 1);
  const auto a_b = axis(bodies.q_b, hinge.f_b, 0), b_b = axis(bodies.q_b, hinge.f_b, 1);
  return equations::twist<T>(a_a.dot(a_b), b_a.dot(b_b), b_a.dot(a_b), a_a.dot(b_b));
}

TYPED_TEST(HingeLimit, TwistIsTwiceTheQuaternionsAngleAndItsLengthOnePlusCosSwing) {
  using T = TypeParam;
  for (const Hinge& hinge : hinges({0, 1e-8, -pi, pi - 1e-8, pi}, {0})) {
    const auto a = [&](int i) { return Vector3<T>(hinge.axis_a(i).cast<T>()); };
    const auto b = [&](int i) { return Vector3<T>(hinge.axis_b(i).cast<T>()); };
    const auto found =
        equations::twist<T>(a(0).dot(b(0)), a(1).dot(b(1)), a(1).dot(b(0)), a(0).dot(b(1)));
    const double length = 1 + std::cos(hinge.swing);
    // Of numbers up to 2.
    ASSERT_LE(std::abs(double(found.x) - length * std::cos(hinge.th)), 2 * this->kTolerance);
    ASSERT_LE(std::abs(double(found.y) - length * std::sin(hinge.th)), 2 * this->kTolerance);
    if (hinge.swing < 3) {
      const Turn p = turn(hinge, hinge.bodies);
      const double angle = 2 * std::atan2(p.v.z(), p.w);
      const double between =
          std::remainder(std::atan2(double(found.y), double(found.x)) - angle, 2 * pi);
      // Rounding over the length of both.
      ASSERT_LE(std::abs(between), 2 * this->kTolerance / length);
    }
  }
}

// The twist has no gradient at a swing of pi, and secant^3 of half of it times epsilon before: of
// C's, 1 / (w^2 + (v.c)^2), and of the row's own, 1 / cos(swing/2), each times its roundings.
double conditioning(const Hinge& hinge) { return std::pow(std::cos(hinge.swing / 2), -3); }

TYPED_TEST(HingeLimit, TwistRowIsTheGradientOnAndOffTheManifold) {
  using T = TypeParam;
  for (const Hinge& hinge : hinges({0, 1e-8, -3, 2.5, -1.5}, {0, 1})) {
    const auto C = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      using std::atan2;
      const auto p = turn(hinge, bodies);
      const S half = atan2(p.v.z(), p.w);
      return S(S(2) * half);
    };
    const auto by_axes = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      using std::atan2;
      const auto direction = twist(hinge, bodies);
      return S(atan2(direction.y, direction.x));
    };
    const Velocities J = angular_row(equations::twist_row(equations::swing<T>(
        hinge.axis_a(2).template cast<T>(), hinge.axis_b(2).template cast<T>())));
    const double tolerance = this->kTolerance * conditioning(hinge);
    ASSERT_LE(mismatch(J, gradient(C, hinge.bodies)), tolerance);
    ASSERT_LE(mismatch(J, gradient(by_axes, hinge.bodies)), tolerance);
    // Away from the jump of atan2, and where the third derivatives are of order 1.
    if (std::abs(hinge.th) < 3 && hinge.swing < 1.5) {
      ASSERT_LE(mismatch(J, difference(by_axes, hinge.bodies)), tolerance + difference_tolerance);
    }
    const double length = std::sqrt(J.segment<3>(9).squaredNorm());
    ASSERT_LE(std::abs(length - 1 / std::cos(hinge.swing / 2)), tolerance);
  }
}

TYPED_TEST(HingeLimit, TwistRowIsTheAxisItselfWhileTheHingeHolds) {
  using T = TypeParam;
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Vector3<T> c = random.unit().cast<T>();
    const Vector3<T> row = equations::twist_row(equations::swing(c, c));
    // c is a unit vector to within two epsilon, and so are the two factors.
    ASSERT_LE(mismatch(row, c), 4 * this->kEpsilon);
  }
}

}  // namespace
