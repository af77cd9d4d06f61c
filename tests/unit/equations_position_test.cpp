// The position constraint's rows, against automatic differentiation and central differences of the
// constraint itself; what they do to momentum; and the inverse effective masses, against the dense
// product. T is double and Bullet's precision in turn.
#include <gtest/gtest.h>
#include <pintle/equations/position.h>
#include <pintle/precision.h>

#include <Eigen/Geometry>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;

template <class T>
class PositionRow : public testing::Test {
 public:
  // 20 epsilon: about as many roundings lie between the poses and an entry.
  static constexpr double kTolerance = 20 * double(std::numeric_limits<T>::epsilon());

  static Velocities documents(const Hinge& hinge, const Vector& u) {
    return row(
        equations::position_row<T>(u.cast<T>(), hinge.r_a().cast<T>(), hinge.r_b().cast<T>()));
  }
  static Velocities conserving(const Hinge& hinge, const Vector& u) {
    return row(equations::position_row_conserving<T>(u.cast<T>(), hinge.r_a().cast<T>(),
                                                     hinge.d().cast<T>(), hinge.r_b().cast<T>()));
  }
};
using Scalars = testing::Types<double, pintle::Scalar>;
TYPED_TEST_SUITE(PositionRow, Scalars);

TYPED_TEST(PositionRow, DocumentsIsTheGradientWithUFixedInTheWorld) {
  for (const Hinge& hinge : hinges(kSwings, kGaps)) {
    const Vector u = hinge.axis_a(0);
    const auto C = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      return S(constant<S>(u).dot(error(hinge, bodies)));
    };
    const Velocities J = this->documents(hinge, u);
    ASSERT_LE(mismatch(J, gradient(C, hinge.bodies)), this->kTolerance * size(hinge));
    ASSERT_LE(mismatch(J, difference(C, hinge.bodies)),
              this->kTolerance * size(hinge) + difference_tolerance * size(hinge));
  }
}

TYPED_TEST(PositionRow, OfAWorldAxisIsTheDocumentsAlongThatAxis) {
  using T = TypeParam;
  for (const Hinge& hinge : hinges(kSwings, kGaps)) {
    const Vector3<T> r_a = hinge.r_a().template cast<T>(), r_b = hinge.r_b().template cast<T>();
    ASSERT_EQ(row(equations::position_row_world<0>(r_a, r_b)),
              this->documents(hinge, Vector::Unit(0)));
    ASSERT_EQ(row(equations::position_row_world<1>(r_a, r_b)),
              this->documents(hinge, Vector::Unit(1)));
    ASSERT_EQ(row(equations::position_row_world<2>(r_a, r_b)),
              this->documents(hinge, Vector::Unit(2)));
  }
}

TYPED_TEST(PositionRow, ConservingIsTheGradientWithUFixedInBodyA) {
  for (const Hinge& hinge : hinges(kSwings, kGaps)) {
    const Vector u_l = hinge.m;
    const auto C = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      return S(arm(bodies.q_a, u_l).dot(error(hinge, bodies)));
    };
    const Velocities J = this->conserving(hinge, arm(hinge.bodies.q_a, u_l));
    ASSERT_LE(mismatch(J, gradient(C, hinge.bodies)), this->kTolerance * size(hinge));
    ASSERT_LE(mismatch(J, difference(C, hinge.bodies)),
              this->kTolerance * size(hinge) + difference_tolerance * size(hinge));
  }
}

TYPED_TEST(PositionRow, TheTwoAreOneWhileTheJointHolds) {
  for (const Hinge& hinge : hinges(kSwings, {0})) {
    const Vector u = hinge.axis_a(1);
    ASSERT_LE(mismatch(this->documents(hinge, u), this->conserving(hinge, u)),
              this->kTolerance * size(hinge));
  }
}

TYPED_TEST(PositionRow, ConservingAddsNoAngularMomentumAndTheDocumentsAddsDCrossU) {
  for (const Hinge& hinge : hinges(kSwings, kGaps)) {
    const Vector u = hinge.axis_a(0), d = hinge.d();
    // The centres of mass are up to 8 from the origin, too.
    const double tolerance = this->kTolerance * (size(hinge) + 10);
    ASSERT_LE(mismatch(added_momentum(hinge, this->conserving(hinge, u)), Vector::Zero()),
              tolerance);
    ASSERT_LE(mismatch(added_momentum(hinge, this->documents(hinge, u)), cross(d, u)), tolerance);
  }
}

TYPED_TEST(PositionRow, ErrorKeepsItsDigitsFarFromTheOrigin) {
  using T = TypeParam;
  // Positions that are whole numbers of the type's digits, so that the true error is known: the
  // anchors' sum would lose it below the spacing of 1e5.
  const Vector3<T> x_a(T(100000), T(-100000), T(100000)), r_a(T(0.25), T(0.125), T(-0.5));
  const Vector3<T> x_b = x_a + Vector3<T>(T(1), T(-1), T(0.5));
  const Vector3<T> d(T(1e-6), T(-2e-6), T(3e-6));
  const Vector3<T> r_b = r_a - (x_b - x_a) + d;
  const Vector3<T> error = equations::position_error(x_a, r_a, x_b, r_b);
  EXPECT_LE(mismatch(error, d), 2 * double(std::numeric_limits<T>::epsilon()));
}

// --- curvature -----------------------------------------------------------------------------------

TYPED_TEST(PositionRow, CurvatureIsTheSecondDerivativeOfTheGap) {
  using T = TypeParam;
  Random random(1);
  for (const Hinge& hinge : hinges(kSwings, kGaps)) {
    const Velocities v = random.velocities();
    const auto d = [&](double t) { return error(hinge, moved(hinge.bodies, v, t)); };
    const Vector3<T> curvature =
        equations::position_curvature<T>(v.segment<3>(3).cast<T>(), hinge.r_a().cast<T>(),
                                         v.segment<3>(9).cast<T>(), hinge.r_b().cast<T>());
    // Three products of factors up to |w| = 1.7: |w|^2 r.
    ASSERT_LE(mismatch(curvature.template cast<double>(), second_difference(d, kCurvatureStep)),
              3 * this->kTolerance * size(hinge) + kCurvatureTolerance);
  }
}

TYPED_TEST(PositionRow, ChordIsTheWayOfALeverThatTurns) {
  using T = TypeParam;
  Random random(5);
  for (const double dt : {1. / 15, 1. / 60, 1. / 240}) {
    for (const double turn : {1e-3, 0.05, 0.3, 0.78}) {
      const Vector r = random.unit(), w = turn / dt * random.unit();
      const Vector way = Eigen::AngleAxisd(turn, w.normalized()) * r - r - dt * w.cross(r);
      const Vector3<T> chord =
          equations::chord_curvature<T>(w.cast<T>(), r.cast<T>(), static_cast<T>(dt));
      const double scale = 2 / (dt * dt);
      // The series leaves out turn^9 / 9!; and the rest of numbers near 1 has their rounding.
      EXPECT_LE((chord.template cast<double>() - scale * way).norm(),
                scale * (std::pow(turn, 9) / 362880 +
                         4 * (turn * turn * double(std::numeric_limits<T>::epsilon()) + 2.3e-16)))
          << turn << ' ' << dt;
      const Vector3<T> parabola = equations::position_curvature<T>(
          Vector3<T>::Zero(), Vector3<T>::Zero(), w.cast<T>(), r.cast<T>());
      EXPECT_LE((chord - parabola).norm(), static_cast<T>(0.4 * turn * w.squaredNorm()));
    }
  }
}

TYPED_TEST(PositionRow, CurvatureOfTheConservingLeversIsThatOfASatisfiedVelocity) {
  // With the gap at rest in body a (J v = 0 for all u), the second derivative of u.d for u fixed in
  // body a is that of the levers r_a + d and r_b.
  using T = TypeParam;
  Random random(2);
  for (const Hinge& hinge : hinges(kSwings, kGaps)) {
    Velocities v = random.velocities();
    const Vector v_a = v.segment<3>(0), w_a = v.segment<3>(3), w_b = v.segment<3>(9);
    v.segment<3>(6) = v_a + cross(w_a, hinge.r_a() + hinge.d()) - cross(w_b, hinge.r_b());
    const Vector u_l = hinge.m;
    const auto C = [&](double t) {
      const Bodies<double> then = moved(hinge.bodies, v, t);
      return arm(then.q_a, u_l).dot(error(hinge, then));
    };
    const Vector3<T> curvature = equations::position_curvature<T>(
        w_a.cast<T>(), (hinge.r_a() + hinge.d()).cast<T>(), w_b.cast<T>(), hinge.r_b().cast<T>());
    const double along = arm(hinge.bodies.q_a, u_l).dot(curvature.template cast<double>());
    // Four times what the levers alone have: the gap itself turns with body a.
    ASSERT_LE(std::abs(along - second_difference(C, kCurvatureStep)),
              5 * this->kTolerance * size(hinge) + 4 * kCurvatureTolerance);
  }
}

TYPED_TEST(PositionRow, CurvatureSeenFromBodyAIsTheSecondDerivativeAtAnyVelocity) {
  using T = TypeParam;
  Random random(9);
  for (const Hinge& hinge : hinges(kSwings, kGaps)) {
    const Velocities v = random.velocities();
    const Vector u_l = hinge.m;
    const auto C = [&](double t) {
      const Bodies<double> then = moved(hinge.bodies, v, t);
      return arm(then.q_a, u_l).dot(error(hinge, then));
    };
    const auto curvature =
        equations::position_curvature_conserving<T>(anchors<T>(hinge), velocity<T>(v));
    const double along = arm(hinge.bodies.q_a, u_l).dot(curvature.template cast<double>());
    ASSERT_LE(std::abs(along - second_difference(C, kCurvatureStep)),
              10 * this->kTolerance * size(hinge) + 4 * kCurvatureTolerance);
  }
}

TYPED_TEST(PositionRow, RelativeVelocityIsTheRateOfTheGap) {
  using T = TypeParam;
  Random random(10);
  for (const Hinge& hinge : hinges(kSwings, kGaps)) {
    const Velocities v = random.velocities();
    const auto at = anchors<T>(hinge);
    const Vector3<T> rate = equations::relative_velocity(velocity<T>(v), at.r_a, at.r_b);
    const Vector expected =
        (error(hinge, moved(hinge.bodies, v, step)) - error(hinge, moved(hinge.bodies, v, -step))) /
        (2 * step);
    ASSERT_LE(mismatch(rate.template cast<double>(), expected),
              2 * this->kTolerance * size(hinge) + difference_tolerance * size(hinge));
  }
}

// --- inverse effective mass ----------------------------------------------------------------------

TYPED_TEST(PositionRow, InverseEffectiveMassIsTheDenseProduct) {
  using T = TypeParam;
  Random random(3);
  const auto any_row = [&] {
    const Vector L = random.vector(), A_a = random.vector(3), A_b = random.vector(3);
    return equations::Jacobian<T>{L.cast<T>(), A_a.cast<T>(), A_b.cast<T>()};
  };
  for (int i = 0; i < 200; ++i) {
    const auto M = any_mass<T>(random);
    const auto J = any_row(), K = any_row();
    const double entry = row(J).dot(dense(M) * row(K));
    const double terms = row(J).cwiseAbs().dot(dense(M).cwiseAbs() * row(K).cwiseAbs());
    EXPECT_LE(std::abs(double(equations::inverse_effective_mass(J, M, K)) - entry),
              this->kTolerance * terms);
    EXPECT_GT(double(equations::inverse_effective_mass(J, M, J)), 0);
  }
}

TYPED_TEST(PositionRow, AngularInverseEffectiveMassIsThatOfARowWithoutALinearPart) {
  using T = TypeParam;
  Random random(11);
  for (int i = 0; i < 200; ++i) {
    const auto M = any_mass<T>(random);
    const Vector3<T> x = random.vector(3).cast<T>();
    const equations::Jacobian<T> J{Vector3<T>::Zero(), x, x};
    const double exact = double(equations::inverse_effective_mass(J, M, J));
    EXPECT_LE(std::abs(double(equations::angular_inverse_effective_mass(M, x)) - exact),
              this->kTolerance * exact);
  }
}

TYPED_TEST(PositionRow, PositionInverseMassIsThatOfItsThreeRows) {
  using T = TypeParam;
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const auto M = any_mass<T>(random);
    const Vector r_a = random.vector(3), r_b = random.vector(3);
    Eigen::Matrix<double, 3, 12> J;
    for (int k = 0; k < 3; ++k) {
      J.row(k) = row(equations::position_row<T>(Vector3<T>::Unit(k), r_a.cast<T>(), r_b.cast<T>()));
    }
    const Matrix3<double> product = J * dense(M) * J.transpose();
    const Matrix3<double> terms = J.cwiseAbs() * dense(M).cwiseAbs() * J.cwiseAbs().transpose();
    const Matrix3<T> block = equations::position_inverse_mass<T>(M, r_a.cast<T>(), r_b.cast<T>());
    EXPECT_LE(mismatch(block.template cast<double>(), product),
              this->kTolerance * terms.maxCoeff());
  }
}

}  // namespace
