// The rows of the hinge. The document's, against automatic differentiation and central differences,
// with the singular values that they have. The conditioned ones: that they are the gradient of
// sigma in Rz(th/2) exp(sigma) Rz(th/2) times an invertible matrix, and unit rows at any error.
#include <gtest/gtest.h>
#include <pintle/equations/quaternion_hinge.h>
#include <pintle/precision.h>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;

template <class T>
class HingeRows : public testing::Test {
 public:
  static constexpr double kEpsilon = double(std::numeric_limits<T>::epsilon());
  // About as many roundings lie between the poses and an entry of a row.
  static constexpr double kTolerance = 20 * kEpsilon;

  static equations::AngularRow<T> documents(const Hinge& hinge, int axis) {
    const Turn p = turn(hinge, hinge.bodies);
    const Matrix3<double> F = matrix(hinge.frame_a());
    return equations::quaternion_hinge_row<T>({T(p.w), p.v.cast<T>()}, F.cast<T>(),
                                              Vector3<T>::Unit(axis));
  }
  static equations::Swing<T> swing(const Vector& c_a, const Vector& c_b) {
    return equations::swing<T>(c_a.cast<T>(), c_b.cast<T>());
  }
};
using Scalars = testing::Types<double, pintle::Scalar>;
TYPED_TEST_SUITE(HingeRows, Scalars);

// --- the document's ------------------------------------------------------------------------------

TYPED_TEST(HingeRows, DocumentsIsTheGradientOnAndOffTheManifold) {
  for (const Hinge& hinge : hinges({0, 1e-8, -pi, pi - 1e-8, pi}, {0, 1})) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto C = [&](const auto& bodies) { return turn(hinge, bodies).v[axis]; };
      const auto row = this->documents(hinge, axis);
      const Velocities J = angular_row(row.J_b);
      ASSERT_LE(std::abs(double(row.C) - C(hinge.bodies)), this->kTolerance);
      ASSERT_LE(mismatch(J, gradient(C, hinge.bodies)), this->kTolerance);
      ASSERT_LE(mismatch(J, difference(C, hinge.bodies)), this->kTolerance + difference_tolerance);
    }
  }
}

TYPED_TEST(HingeRows, DocumentsHaveSingularValuesOneHalfAndCosOfHalfTheSwingOverTwo) {
  for (const Hinge& hinge : hinges({0, 1e-8, -pi, pi - 1e-8, pi}, {0})) {
    const Vector J_0 = this->documents(hinge, 0).J_b.template cast<double>();
    const Vector J_1 = this->documents(hinge, 1).J_b.template cast<double>();
    const double cosine = std::cos(hinge.swing / 2);
    const double trace = J_0.dot(J_0) + J_1.dot(J_1);
    const double determinant = J_0.dot(J_0) * J_1.dot(J_1) - J_0.dot(J_1) * J_0.dot(J_1);
    ASSERT_LE(std::abs(trace - (1 + cosine * cosine) / 4), this->kTolerance);
    ASSERT_LE(std::abs(determinant - cosine * cosine / 16), this->kTolerance);
    // The one that vanishes is along the error: at pi an impulse of these rows cannot correct it.
    const Vector n = hinge.halfway(hinge.m);
    const double along = std::hypot(J_0.dot(n), J_1.dot(n));
    ASSERT_LE(std::abs(along - std::abs(cosine) / 2), this->kTolerance);
  }
}

// --- the conditioned ones ------------------------------------------------------------------------

// sigma in the frame halfway along the twist: (x, y) of p = Rz(th/2) exp(sigma) Rz(th/2), whose
// parts are (cos(s/2) cos(th/2), sin(s/2) sigma/s + cos(s/2) sin(th/2) z).
template <class T>
Eigen::Matrix<T, 2, 1> halfway_swing(const Quaternion<T>& p) {
  using std::atan2;
  using std::sqrt;
  const T x = p.v.x(), y = p.v.y();
  const T sine2 = x * x + y * y, cosine = sqrt(p.w * p.w + p.v.z() * p.v.z());
  T ratio;
  if (sine2 < T(1e-6)) {
    const T t2 = sine2 / (cosine * cosine);  // atan's series; the next term is 1e-19
    ratio = T(2) / cosine * (T(1) - t2 / T(3) + t2 * t2 / T(5));
  } else {
    const T sine = sqrt(sine2), half = atan2(sine, cosine);
    ratio = T(2) * half / sine;
  }
  return {x * ratio, y * ratio};
}

TEST(SwingDecomposition, IsWhatTheHingesAreMadeOf) {
  for (const Hinge& hinge : hinges({0, 1e-8, -pi, pi - 1e-4}, {0})) {
    const auto sigma = halfway_swing(turn(hinge, hinge.bodies));
    const Vector expected = hinge.sign * hinge.swing * hinge.m;
    // Near pi the quaternion's x, y are flat in the swing: epsilon over the cosine.
    ASSERT_LE(mismatch(sigma, expected.head<2>()), 40 * epsilon / std::cos(hinge.swing / 2));
  }
}

// J = {n, (s/2)/sin(s/2) h x n} is the gradient of sigma, along itself and across. Up to 1e-4 from
// pi: sigma has no gradient at pi, and epsilon / cos(s/2) of its digits before.
const std::vector<double> kSmoothHingeSwings = {0, 1e-8, 1e-3, -pi, pi - 1e-4};

double half_over_sine(double swing) { return swing == 0 ? 1 : (swing / 2) / std::sin(swing / 2); }

struct SwingGradient {
  Velocities along, across;
};
SwingGradient swing_gradient(const Hinge& hinge) {
  const Vector m = hinge.m * hinge.sign, z_m = cross(Vector::Unit(2), m);
  const auto component = [&](const Vector& u) {
    return [&hinge, u](const auto& bodies) {
      const auto sigma = halfway_swing(turn(hinge, bodies));
      using S = std::decay_t<decltype(sigma[0])>;
      return S(sigma[0] * u.x() + sigma[1] * u.y());
    };
  };
  const SwingGradient exact = {gradient(component(m), hinge.bodies),
                               gradient(component(z_m), hinge.bodies)};
  // Central differences bear out the automatic ones, where the third derivatives are of order 1.
  if (hinge.swing < 2) {
    EXPECT_LE(mismatch(exact.along, difference(component(m), hinge.bodies)), difference_tolerance);
    EXPECT_LE(mismatch(exact.across, difference(component(z_m), hinge.bodies)),
              difference_tolerance);
  }
  return exact;
}

TYPED_TEST(HingeRows, NAndHCrossNAreTheGradientOfTheSymmetricSwing) {
  using T = TypeParam;
  for (const Hinge& hinge : hinges(kSmoothHingeSwings, {0, 1})) {
    const SwingGradient exact = swing_gradient(hinge);
    const Vector3<T> n = hinge.halfway(hinge.m).template cast<T>();
    const auto swing = this->swing(hinge.axis_a(2), hinge.axis_b(2));
    const double tolerance = this->kTolerance / std::cos(hinge.swing / 2);
    ASSERT_LE(mismatch(angular_row(n), exact.along), tolerance);
    const Vector3<T> across = T(half_over_sine(hinge.swing)) * cross(swing.h, n);
    ASSERT_LE(mismatch(angular_row(across), exact.across), tolerance);
    // C = {swing, 0} along n and across.
    const Vector sigma = swing.sigma.template cast<double>(), n_ = hinge.halfway(hinge.m);
    ASSERT_LE(mismatch(sigma, hinge.swing * n_), 4 * tolerance);
    ASSERT_LE(std::abs(double(swing.angle) - hinge.swing), this->kTolerance);
  }
}

TYPED_TEST(HingeRows, UnitRowsNormalToHAreThatGradientTimesAnInvertibleMatrix) {
  using T = TypeParam;
  Random random(5);
  for (const Hinge& hinge : hinges(kSmoothHingeSwings, {0, 1})) {
    const SwingGradient exact = swing_gradient(hinge);
    const auto swing = this->swing(hinge.axis_a(2), hinge.axis_b(2));
    const Vector n = hinge.halfway(hinge.m);
    const Vector h_n = cross(swing.h.template cast<double>(), n);
    const double k = half_over_sine(hinge.swing);
    const double tolerance = this->kTolerance / std::cos(hinge.swing / 2);
    // Two unit vectors normal to h, not normal to each other.
    const Vector3<T> t = pintle::any_tangent(swing.h), s = cross(swing.h, t);
    const double first = random.uniform(-pi, pi), second = first + random.uniform(0.3, pi - 0.3);
    Eigen::Matrix<double, 2, 2> B;
    int i = 0;
    for (const double angle : {first, second}) {
      const Vector3<T> u = T(std::cos(angle)) * t + T(std::sin(angle)) * s;
      const Vector u_ = u.template cast<double>();
      // One row of B: the components of u, those of the gradient taken out of it.
      B(i, 0) = u_.dot(n);
      B(i, 1) = u_.dot(h_n) / k;
      ASSERT_LE(mismatch(angular_row(u), B(i, 0) * exact.along + B(i, 1) * exact.across),
                2 * tolerance);
      // The same row of B takes {swing, 0} to sigma.u.
      ASSERT_LE(std::abs(double(swing.sigma.dot(u)) - B(i, 0) * hinge.swing), 4 * tolerance);
      ++i;
    }
    // det B = sin(second - first) / k, and k is at most pi/2.
    const double determinant = B(0, 0) * B(1, 1) - B(0, 1) * B(1, 0);
    ASSERT_GE(std::abs(determinant), std::sin(0.3) / (pi / 2) - tolerance);
  }
}

// Errors at which the code has a branch to take, from either side, and those that are exact.
const std::vector<double> kSwingsOfAllBranches = {
    0, 1e-12, 1e-8,      1e-4,      3.1e-3,    3.2e-3,    0.1,       1,         pi / 2,
    2, 3,     pi - 1e-2, pi - 1e-3, pi - 1e-4, pi - 2e-5, pi - 5e-6, pi - 1e-8, pi};

TYPED_TEST(HingeRows, SwingTurnsOneAxisIntoTheOtherAtAnyError) {
  using T = TypeParam;
  for (unsigned seed = 0; seed < 200; ++seed) {
    for (const double angle : kSwingsOfAllBranches) {
      const Hinge hinge = make_hinge(seed, 0.7, angle, 0, 1);
      const Vector c_a = hinge.axis_a(2);
      const Vector c_b = angle == pi ? Vector(-c_a) : hinge.axis_b(2);
      const auto swing = this->swing(c_a, c_b);
      // Without a direction left (1e-5 from pi) any shortest turn will do.
      const bool opposite = angle > pi - 1e-5;
      ASSERT_LE(std::abs(double(swing.angle) - angle), this->kTolerance + (opposite ? 1e-5 : 0));
      const Vector sigma = swing.sigma.template cast<double>();
      // The direction of sigma is as good as c_a x c_b; epsilon over the sine.
      const double loss = opposite ? 1 : 1 + angle / std::max(std::sin(angle), 1e-5);
      const double length = std::sqrt(sigma.dot(sigma));
      ASSERT_LE(std::abs(length - double(swing.angle)), this->kTolerance);
      const Vector turned =
          length == 0 ? c_a
                      : equations::rotate(equations::rotation<double>(sigma / length, length), c_a);
      ASSERT_LE(mismatch(turned, c_b), this->kTolerance * loss + (opposite ? 1e-5 : 0));
      // sigma is normal to both axes and to h.
      ASSERT_LE(std::abs(sigma.dot(c_a)), this->kTolerance * loss);
      ASSERT_LE(std::abs(sigma.dot(swing.h.template cast<double>())), this->kTolerance * loss);
      if (angle == 0) {
        ASSERT_EQ(this->swing(c_a, c_a).sigma, Vector3<T>::Zero());
        ASSERT_EQ(this->swing(c_a, c_a).angle, 0);
      }
    }
  }
}

TYPED_TEST(HingeRows, RowsNormalToHAreUnitAndIndependentAtAnyErrorExactlyPiToo) {
  using T = TypeParam;
  for (unsigned seed = 0; seed < 200; ++seed) {
    for (const double angle : kSwingsOfAllBranches) {
      const Hinge hinge = make_hinge(seed, -2, angle, 0, 1);
      const Vector c_a = hinge.axis_a(2);
      const Vector c_b = angle == pi ? Vector(-c_a) : hinge.axis_b(2);
      const auto swing = this->swing(c_a, c_b);
      ASSERT_LE(std::abs(double(swing.h.dot(swing.h)) - 1), this->kTolerance);
      const Vector3<T> p = pintle::any_tangent(swing.h), q = cross(swing.h, p);
      ASSERT_LE(std::abs(double(p.dot(p)) - 1), this->kTolerance);
      ASSERT_LE(std::abs(double(q.dot(q)) - 1), this->kTolerance);
      ASSERT_LE(std::abs(double(p.dot(q))), this->kTolerance);
      // They see all of the error, at pi too, where the document's see none of it.
      const double seen = std::hypot(double(swing.sigma.dot(p)), double(swing.sigma.dot(q)));
      const double loss = angle > pi - 1e-5 ? 1 : 1 + angle / std::max(std::sin(angle), 1e-5);
      ASSERT_LE(std::abs(seen - double(swing.angle)), this->kTolerance * loss);
      // 1 / cos^2(swing/2), while that is a number: c_a + c_b has lost epsilon over its length.
      if (angle < pi - 1e-3) {
        const double cosine = std::cos(angle / 2);
        ASSERT_LE(std::abs(double(swing.h_scale) * cosine * cosine - 1), this->kTolerance / cosine);
      }
      ASSERT_LE(double(swing.h_scale), 4e10 * (1 + this->kTolerance));
    }
  }
}

TYPED_TEST(HingeRows, SwingIsContinuousWhereItsSeriesTakesOver) {
  // sin^2 = 1e-5, from below and above by a few digits: the same angle to rounding.
  const double threshold = std::asin(std::sqrt(1e-5));
  Random random(6);
  for (int i = 0; i < 200; ++i) {
    const Vector c_a = random.unit(), n = pintle::any_tangent(c_a);
    for (const double factor : {0.9, 1 - 1e-4, 1.0, 1 + 1e-4, 1.1}) {
      const double angle = threshold * factor;
      const Vector c_b = equations::rotate(equations::rotation(n, angle), c_a);
      const auto swing = this->swing(c_a, c_b);
      // Six roundings of entries up to 1.
      ASSERT_LE(std::abs(double(swing.angle) - angle), 6 * this->kEpsilon);
      ASSERT_LE(mismatch(swing.sigma.template cast<double>(), angle * n), 6 * this->kEpsilon);
    }
  }
}

TYPED_TEST(HingeRows, SwingKeepsTheDigitsOfSmallAngles) {
  // Axes whose cross product is exact: the error is relative, on both sides of the series' end.
  using T = TypeParam;
  for (const double angle : {1e-12, 1e-9, 1e-6, 1e-4, 1e-3, 2e-3, 3.1e-3, 3.2e-3, 1e-2}) {
    const Vector c_b(std::cos(angle), std::sin(angle), 0);
    const auto swing = this->swing(Vector::Unit(0), c_b);
    EXPECT_LE(std::abs(double(swing.angle) / angle - 1), 4 * this->kEpsilon) << angle;
    EXPECT_LE(std::abs(double(swing.sigma.z()) / angle - 1), 4 * this->kEpsilon) << angle;
    EXPECT_EQ(swing.sigma.x(), T(0));
    EXPECT_EQ(swing.sigma.y(), T(0));
  }
}

TYPED_TEST(HingeRows, SwingAngleStepsByNoMoreThanItsThresholdNearPi) {
  // |c_a + c_b|^2 = 1e-10 is 1e-5 rad from pi. Beyond, the angle is pi; before, the true one.
  Random random(7);
  for (int i = 0; i < 200; ++i) {
    const Vector c_a = random.unit(), n = pintle::any_tangent(c_a);
    for (const double short_of : {1.2e-5, 8e-6}) {
      const Vector c_b = equations::rotate(equations::rotation(n, pi - short_of), c_a);
      const auto swing = this->swing(c_a, c_b);
      const double expected = short_of > 1e-5 ? pi - short_of : pi;
      ASSERT_LE(std::abs(double(swing.angle) - expected), 4 * this->kEpsilon);
    }
  }
}

TYPED_TEST(HingeRows, SwingCurvatureIsTheSecondDerivativeOfTheErrorOfASatisfiedHinge) {
  using T = TypeParam;
  Random random(8);
  for (const Hinge& hinge : hinges({0}, {0})) {
    Velocities v = random.velocities();
    const Vector c = hinge.axis_a(2), w_a = v.segment<3>(3);
    const double rate = random.uniform(-2, 2);
    v.segment<3>(9) = w_a + rate * c;
    const auto sigma = [&](double t) {
      const Bodies<double> then = moved(hinge.bodies, v, t);
      const Vector z = Vector::Unit(2);
      return equations::swing<double>(equations::rotate(equations::product(then.q_a, hinge.f_a), z),
                                      equations::rotate(equations::product(then.q_b, hinge.f_b), z))
          .sigma;
    };
    const auto swing = this->swing(c, hinge.axis_b(2));
    const Vector3<T> p = pintle::any_tangent(swing.h), q = cross(swing.h, p);
    const Vector3<T> w_a_T = w_a.cast<T>(), w_b_T = v.segment<3>(9).cast<T>();
    const auto curvature = equations::swing_curvature<T>(swing, p, q, w_a_T, w_b_T);
    const Vector expected = second_difference(sigma, 5e-3);
    // h = 5e-3 and speeds up to 4: h^4/90 w^6 is 3e-8 at most; the terms are rate |w_a + w_b| / 2.
    const double tolerance = 10 * this->kTolerance + 3e-8;
    ASSERT_LE(std::abs(double(curvature[0]) - expected.dot(p.template cast<double>())), tolerance);
    ASSERT_LE(std::abs(double(curvature[1]) - expected.dot(q.template cast<double>())), tolerance);
    // There is none along h.
    ASSERT_LE(std::abs(expected.dot(c)), 3e-8);
  }
}

}  // namespace
