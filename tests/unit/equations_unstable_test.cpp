// The constraints that the document lists as unstable: their corrected rows are gradients, and it
// is these gradients that make them unstable.
#include <gtest/gtest.h>
#include <pintle/equations/unstable.h>
#include <pintle/precision.h>

#include <Eigen/LU>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;

template <class T>
class Unstable : public testing::Test {
 public:
  // About as many roundings lie between the poses and an entry.
  static constexpr double kTolerance = 20 * double(std::numeric_limits<T>::epsilon());
};
using Scalars = testing::Types<double, pintle::Scalar>;
TYPED_TEST_SUITE(Unstable, Scalars);

template <class T>
Vector3<T> axis(const Quaternion<T>& q, const Turn& frame) {
  return arm(equations::product(q, constant<T>(frame)), Vector::Unit(2));
}
template <class T>
Vector3<T> axes_crossed(const Hinge& hinge, const Bodies<T>& bodies) {
  return cross(axis(bodies.q_a, hinge.f_a), axis(bodies.q_b, hinge.f_b));
}

template <class T>
equations::AngularRow<T> cross_row(const Hinge& hinge) {
  return equations::cross_product_row<T>(hinge.axis_a(2).cast<T>(), hinge.axis_b(2).cast<T>());
}
template <class T>
equations::LinearRow<T> matrix_row(const Hinge& hinge, const Vector& u) {
  return equations::cross_product_matrix_row<T>(u.cast<T>(), hinge.axis_a(2).cast<T>(),
                                                hinge.axis_b(2).cast<T>());
}
template <class T>
equations::AngularRow<T> dot_row(const Hinge& hinge) {
  const Turn a = hinge.frame_a(), b = hinge.frame_b();
  return equations::quaternion_dot_row<T>({T(a.w), a.v.cast<T>()}, {T(b.w), b.v.cast<T>()});
}

TYPED_TEST(Unstable, CrossProductIsTheGradient) {
  for (const Hinge& hinge : hinges(kSwings, {0, 1})) {
    const auto C = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      const Vector3<S> x = axes_crossed(hinge, bodies);
      return S(x.dot(x) / 2);
    };
    const auto row = cross_row<TypeParam>(hinge);
    const Velocities J = angular_row(row.J_b);
    ASSERT_LE(std::abs(double(row.C) - C(hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(J, gradient(C, hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(J, difference(C, hinge.bodies)), this->kTolerance + difference_tolerance);
  }
}

TYPED_TEST(Unstable, CrossProductHasNoRowWhereItHolds) {
  for (const Hinge& hinge : hinges({0, 1e-3, 0.1, pi / 2, pi}, {0})) {
    const auto row = cross_row<TypeParam>(hinge);
    const double expected = std::abs(std::sin(2 * hinge.swing)) / 2;
    ASSERT_LE(std::abs(std::sqrt(double(row.J_b.dot(row.J_b))) - expected), this->kTolerance);
    ASSERT_LE(std::abs(double(row.C) - std::pow(std::sin(hinge.swing), 2) / 2), this->kTolerance);
  }
}

TYPED_TEST(Unstable, CrossProductMatrixIsTheGradientThoughNotOfOppositeParts) {
  Random random(1);
  double opposite = 0;
  for (const Hinge& hinge : hinges(kSwings, {0, 1})) {
    const Vector u = random.unit();
    const auto C = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      return S(constant<S>(u).dot(axes_crossed(hinge, bodies)));
    };
    const auto row = matrix_row<TypeParam>(hinge, u);
    const Velocities J = autodiff::row(row.J);
    ASSERT_LE(std::abs(double(row.C) - C(hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(J, gradient(C, hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(J, difference(C, hinge.bodies)), this->kTolerance + difference_tolerance);
    opposite = std::max(opposite, mismatch(J.segment<3>(3), -J.segment<3>(9)));
  }
  EXPECT_GT(opposite, 0.5);
}

template <class T>
Eigen::Matrix3d inverse_mass_of_matrix_rows(const Hinge& hinge,
                                            const equations::InverseMass<T>& M) {
  Eigen::Matrix3d K;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const auto J_i = matrix_row<T>(hinge, Vector::Unit(i)).J;
      const auto J_j = matrix_row<T>(hinge, Vector::Unit(j)).J;
      K(i, j) = double(equations::inverse_effective_mass(J_i, M, J_j));
    }
  }
  return K;
}

TYPED_TEST(Unstable, CrossProductMatrixIsSingularWhereItHolds) {
  using T = TypeParam;
  Random random(2);
  for (const Hinge& hinge : hinges({0, pi}, {0}, 50)) {
    const auto M = any_mass<T>(random);
    const Eigen::Matrix3d K = inverse_mass_of_matrix_rows(hinge, M);
    const Vector c = hinge.axis_a(2);
    ASSERT_LE((K * c).cwiseAbs().maxCoeff(), this->kTolerance * K.cwiseAbs().maxCoeff());
    ASSERT_LE(std::abs(K.determinant()), 10 * this->kTolerance * std::pow(K.trace(), 3));
  }
}

TYPED_TEST(Unstable, CrossProductMatrixIsRegularElsewhereButFor90Degrees) {
  // Of unit inertias K has the eigenvalues 1 - cos, 1 + cos and 2 cos^2 of the swing.
  using T = TypeParam;
  for (const Hinge& hinge : hinges({0, 0.5, 1, pi / 2, 2, 3, pi}, {0}, 50)) {
    const Matrix3<T> I = Matrix3<T>::Identity();
    const Eigen::Matrix3d K = inverse_mass_of_matrix_rows<T>(hinge, {1, 1, I, I});
    const double sine = std::sin(2 * hinge.swing);
    ASSERT_LE(std::abs(K.determinant() - sine * sine / 2), 4 * this->kTolerance);
  }
}

TYPED_TEST(Unstable, QuaternionDotIsTheGradient) {
  for (const Hinge& hinge : hinges(kSwings, {0, 1})) {
    const auto C = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      return S(turn(hinge, bodies).w - S(1));
    };
    const auto row = dot_row<TypeParam>(hinge);
    const Velocities J = angular_row(row.J_b);
    ASSERT_LE(std::abs(double(row.C) - C(hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(J, gradient(C, hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(J, difference(C, hinge.bodies)), this->kTolerance + difference_tolerance);
  }
}

TYPED_TEST(Unstable, QuaternionDotHasNoRowWhereItHolds) {
  // Half the sine of half the angle: nothing at the solution, and the error only its square.
  Random random(3);
  for (const double angle : {0.0, 1e-3, 0.1, 1.0, 3.0}) {
    const Turn q_a = random.turn();
    const Turn q_b = equations::product(equations::rotation<double>(random.unit(), angle), q_a);
    using T = TypeParam;
    const auto row =
        equations::quaternion_dot_row<T>({T(q_a.w), q_a.v.cast<T>()}, {T(q_b.w), q_b.v.cast<T>()});
    EXPECT_LE(std::abs(std::sqrt(double(row.J_b.dot(row.J_b))) - std::sin(angle / 2) / 2),
              this->kTolerance);
    EXPECT_LE(std::abs(double(row.C) + 2 * std::pow(std::sin(angle / 4), 2)), this->kTolerance);
  }
}

}  // namespace
