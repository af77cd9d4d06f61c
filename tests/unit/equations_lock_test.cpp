// The lock. The document's rows, against automatic differentiation, with the singular values that
// they have; and the conditioned error: that it is the turn between the frames at any angle, and
// that unit rows with this error are the exact gradient times a matrix that keeps the error.
#include <gtest/gtest.h>
#include <pintle/equations/orientation_lock.h>
#include <pintle/precision.h>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;

template <class T>
class Lock : public testing::Test {
 public:
  static constexpr double kEpsilon = double(std::numeric_limits<T>::epsilon());
  // About as many roundings lie between the poses and an entry.
  static constexpr double kTolerance = 20 * kEpsilon;

  static Vector error(const Matrix3<double>& F_a, const Matrix3<double>& F_b) {
    return equations::orientation_error<T>(F_a.cast<T>(), F_b.cast<T>()).template cast<double>();
  }
};
using Scalars = testing::Types<double, pintle::Scalar>;
TYPED_TEST_SUITE(Lock, Scalars);

std::vector<Hinge> all_hinges() { return hinges({0, 1e-8, -pi, pi - 1e-8, pi}, {0, 1}); }

double length(const Vector& v) { return std::sqrt(v.dot(v)); }

// --- the document's ------------------------------------------------------------------------------

TYPED_TEST(Lock, DocumentsIsTheGradientAboutAnyAxis) {
  using T = TypeParam;
  Random random(1);
  for (const Hinge& hinge : all_hinges()) {
    const Vector u = random.unit();
    const auto C = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      return S(turn(hinge, bodies).v.dot(constant<S>(u)));
    };
    const Turn p = turn(hinge, hinge.bodies);
    const Matrix3<double> F = matrix(hinge.frame_a());
    const auto row =
        equations::quaternion_row<T>({T(p.w), p.v.cast<T>()}, F.cast<T>(), u.cast<T>());
    const Velocities J = angular_row(row.J_b);
    ASSERT_LE(std::abs(double(row.C) - C(hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(J, gradient(C, hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(J, difference(C, hinge.bodies)), this->kTolerance + difference_tolerance);
  }
}

TYPED_TEST(Lock, DocumentsIsHalfLongAcrossTheErrorAndVanishesAlongItAtPi) {
  using T = TypeParam;
  for (const Hinge& hinge : all_hinges()) {
    const Turn p = turn(hinge, hinge.bodies);
    const Matrix3<double> F = matrix(hinge.frame_a());
    const double sine = length(p.v);
    const Vector along = sine > 0 ? Vector(p.v / sine) : Vector(Vector::Unit(0));
    const Vector across = pintle::any_tangent(along);
    const auto J_b = [&](const Vector& u) {
      return Vector(equations::quaternion_row<T>({T(p.w), p.v.cast<T>()}, F.cast<T>(), u.cast<T>())
                        .J_b.template cast<double>());
    };
    ASSERT_LE(std::abs(length(J_b(along)) - std::abs(p.w) / 2), this->kTolerance);
    ASSERT_LE(std::abs(length(J_b(across)) - 0.5), this->kTolerance);
  }
}

// --- the conditioned one -------------------------------------------------------------------------

// Angles at which the code has a branch to take, from either side, and those that are exact.
const std::vector<double> kLockAngles = {
    0, 1e-20,  1e-12,  1e-8, 1e-4,      3.1e-3,    3.2e-3,    0.1,       1,         pi / 2,
    2, 2.0944, 2.0945, 3,    pi - 1e-2, pi - 1e-4, pi - 1e-6, pi - 1e-8, pi - 1e-15};

TYPED_TEST(Lock, ErrorTurnsTheFrameOfAIntoThatOfB) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const Turn q = seed % 5 ? random.turn() : Turn{1, Vector::Zero()};
    const Vector n = seed % 3 ? random.unit() : Vector(Vector::Unit(seed % 9 / 3));
    const Matrix3<double> F_a = matrix(q);
    for (const double angle : kLockAngles) {
      const Matrix3<double> F_b = matrix(equations::product(equations::rotation(n, angle), q));
      const Vector phi = this->error(F_a, F_b);
      ASSERT_LE(std::abs(length(phi) - angle), this->kTolerance) << angle;
      // Within rounding of pi it may be the same turn the other way round.
      const double sign = angle > pi - 1e-6 && phi.dot(n) < 0 ? -1 : 1;
      const double other = sign < 0 ? 2 * (pi - angle) : 0;
      ASSERT_LE(mismatch(sign * phi, angle * n), this->kTolerance + other) << angle;
    }
  }
}

TYPED_TEST(Lock, ErrorOfEqualFramesIsNothingAndOfHalfATurnDefinite) {
  using T = TypeParam;
  const Matrix3<T> one = Matrix3<T>::Identity();
  EXPECT_EQ(equations::orientation_error(one, one), Vector3<T>::Zero());
  for (int i = 0; i < 3; ++i) {
    Matrix3<T> half = -one;
    half(i, i) = 1;
    const Vector3<T> phi = equations::orientation_error(one, half);
    EXPECT_LE(mismatch(phi, Vector3<T>(T(pi) * Vector3<T>::Unit(i))), this->kTolerance);
    EXPECT_EQ(equations::orientation_error(one, half), phi);
  }
  // About (1, 1, 1)/sqrt(3): R = 2 n n^T - 1, where all three divisors are alike.
  const Matrix3<T> half = Matrix3<T>::Constant(T(2) / T(3)) - one;
  const Vector3<T> phi = equations::orientation_error(one, half);
  EXPECT_LE(mismatch(phi, Vector3<T>::Constant(T(pi / std::sqrt(3)))), this->kTolerance);
}

TYPED_TEST(Lock, ErrorIsANumberForAnyMatrices) {
  using T = TypeParam;
  Random random(2);
  const auto is_number = [](const Vector3<T>& v) { return v.allFinite(); };
  const Matrix3<T> zero = Matrix3<T>::Zero();
  EXPECT_TRUE(is_number(equations::orientation_error(zero, zero)));
  EXPECT_TRUE(is_number(equations::rotation_vector<T>({0, Vector3<T>::Zero()})));
  const T tiny = std::numeric_limits<T>::denorm_min();
  EXPECT_TRUE(is_number(equations::rotation_vector<T>({1, Vector3<T>(tiny, 0, 0)})));
  EXPECT_TRUE(is_number(equations::rotation_vector<T>({tiny, Vector3<T>(0, tiny, 0)})));
  for (int i = 0; i < 1000; ++i) {
    Matrix3<T> A, B;
    for (int k = 0; k < 9; ++k) {
      A(k / 3, k % 3) = T(random.uniform(-3, 3));
      B(k / 3, k % 3) = T(random.uniform(-3, 3));
    }
    ASSERT_TRUE(is_number(equations::orientation_error(A, B)));
  }
}

TYPED_TEST(Lock, RotationVectorIsBlindToTheSignOfTheQuaternion) {
  using T = TypeParam;
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Vector n = random.unit();
    const double angle = i % 2 ? random.uniform(0, 3.1) : kLockAngles[i / 2 % 12];
    const Turn q = equations::rotation(n, angle);
    const Vector3<T> phi = equations::rotation_vector<T>({T(q.w), q.v.cast<T>()});
    ASSERT_EQ(phi, equations::rotation_vector<T>({T(-q.w), -q.v.cast<T>()}));
    ASSERT_LE(mismatch(phi.template cast<double>(), angle * n), this->kTolerance);
  }
}

TYPED_TEST(Lock, ErrorKeepsTheDigitsOfSmallAngles) {
  // Frames whose product is exact: the error is relative, on both sides of the series' end.
  using T = TypeParam;
  for (const double angle : {1e-12, 1e-9, 1e-6, 1e-4, 1e-3, 2e-3, 3.1e-3}) {
    Matrix3<double> F_b = Matrix3<double>::Identity();
    F_b(0, 0) = F_b(1, 1) = std::cos(angle);
    F_b(1, 0) = std::sin(angle);
    F_b(0, 1) = -F_b(1, 0);
    const Vector phi = this->error(Matrix3<double>::Identity(), F_b);
    EXPECT_LE(std::abs(phi.z() / angle - 1), 4 * this->kEpsilon) << angle;
    EXPECT_EQ(phi.x(), T(0));
    EXPECT_EQ(phi.y(), T(0));
  }
}

TYPED_TEST(Lock, ErrorIsContinuousWhereItsSeriesTakesOver) {
  // sin^2 = 1e-5, from below and above by a few digits.
  const double threshold = std::asin(std::sqrt(1e-5));
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const Vector n = random.unit();
    for (const double factor : {0.9, 1 - 1e-4, 1.0, 1 + 1e-4, 1.1}) {
      const double angle = threshold * factor;
      const Vector phi =
          this->error(Matrix3<double>::Identity(), matrix(equations::rotation(n, angle)));
      ASSERT_LE(mismatch(phi, angle * n), 6 * this->kEpsilon);
    }
  }
}

TYPED_TEST(Lock, UnitRowsAreTheGradientTimesAMatrixThatKeepsTheError) {
  // With J the gradient of phi: J phi = phi, so that inverse(J) J = 1 has the error
  // inverse(J) phi = phi; and det J = ((angle/2) / sin(angle/2))^2, so that there is an inverse.
  for (const Hinge& hinge : all_hinges()) {
    const Matrix3<double> F_a = matrix(hinge.frame_a());
    const Vector phi = this->error(F_a, matrix(hinge.frame_b()));
    const Turn p = turn(hinge, hinge.bodies);
    const Vector local = equations::rotation_vector(p);
    // At half a turn phi and -phi are one.
    const double sign = (F_a * local).dot(phi) < 0 ? -1 : 1;
    Matrix3<double> J;
    for (int i = 0; i < 3; ++i) {
      const auto C = [&](const auto& bodies) {
        return equations::rotation_vector(turn(hinge, bodies))[i];
      };
      const Velocities exact = gradient(C, hinge.bodies);
      const Vector J_b = exact.segment<3>(9);
      J.row(i) = J_b.transpose();
      ASSERT_LE(mismatch(angular_row(J_b), exact), 20 * epsilon);
      if (std::abs(p.w) > 1e-3) {  // where a step does not pass half a turn
        ASSERT_LE(mismatch(exact, difference(C, hinge.bodies)), 10 * difference_tolerance);
      }
    }
    ASSERT_LE(mismatch(J * phi, sign * local), 10 * this->kTolerance);
    const double half = length(local) / 2, ratio = half == 0 ? 1 : half / std::sin(half);
    const Vector J_0 = J.row(0), J_1 = J.row(1), J_2 = J.row(2);
    ASSERT_LE(std::abs(cross(J_0, J_1).dot(J_2) - ratio * ratio), 100 * epsilon);
  }
}

// So a torque of -k phi by unit rows, that of a pose drive, has the potential k phi^2 / 2.
TYPED_TEST(Lock, ErrorIsTheGradientOfHalfItsSquare) {
  for (const Hinge& hinge : all_hinges()) {
    const Turn p = turn(hinge, hinge.bodies);
    if (!(std::abs(p.w) > 1e-3)) continue;  // at half a turn the potential has a ridge
    const auto potential = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      const auto phi = equations::rotation_vector(turn(hinge, bodies));
      return S(phi.dot(phi) / 2);
    };
    const Vector phi = this->error(matrix(hinge.frame_a()), matrix(hinge.frame_b()));
    ASSERT_LE(mismatch(angular_row(phi), gradient(potential, hinge.bodies)), 10 * this->kTolerance);
    ASSERT_LE(mismatch(angular_row(phi), difference(potential, hinge.bodies)),
              10 * (this->kTolerance + difference_tolerance));
  }
}

TYPED_TEST(Lock, OneFullStepOfUnitRowsTakesAnyErrorAway) {
  for (const Hinge& hinge : all_hinges()) {
    const Matrix3<double> F_a = matrix(hinge.frame_a());
    Velocities v = Velocities::Zero();
    v.segment<3>(9) = -this->error(F_a, matrix(hinge.frame_b()));
    Hinge then = hinge;
    then.bodies = moved(hinge.bodies, v, 1);
    ASSERT_LE(length(this->error(F_a, matrix(then.frame_b()))), 2 * this->kTolerance);
  }
}

TYPED_TEST(Lock, CurvatureIsThatOfTheErrorAtConstantVelocities) {
  using T = TypeParam;
  Random random(5);
  double most = 0;
  for (const Hinge& hinge : hinges({0}, {0, 1})) {
    if (hinge.th != 0) continue;
    const Velocities v = 2 * random.velocities();
    const auto phi = [&](double t) {
      Hinge then = hinge;
      then.bodies = moved(hinge.bodies, v, t);
      return Vector(
          equations::orientation_error<double>(matrix(then.frame_a()), matrix(then.frame_b())));
    };
    const Vector expected = second_difference(phi, kCurvatureStep);
    const Vector curvature =
        equations::orientation_curvature<T>(v.segment<3>(3).cast<T>(), v.segment<3>(9).cast<T>())
            .template cast<double>();
    // |w|^2 is up to 24.
    ASSERT_LE(mismatch(curvature, expected), kCurvatureTolerance + 24 * this->kTolerance);
    most = std::max(most, length(curvature));
  }
  EXPECT_GT(most, 2);
}

}  // namespace
