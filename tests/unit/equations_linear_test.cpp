// The rows of a distance, a contact and a slider, against automatic differentiation and central
// differences of their constraints; their curvature, against second differences of the motion; and
// what they do to angular momentum. T is double and Bullet's precision in turn.
#include <gtest/gtest.h>
#include <pintle/equations/distance.h>
#include <pintle/equations/slider.h>
#include <pintle/precision.h>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;

template <class T>
class LinearRows : public testing::Test {
 public:
  static constexpr double kEpsilon = double(std::numeric_limits<T>::epsilon());
  // About as many roundings lie between the poses and an entry.
  static constexpr double kTolerance = 20 * kEpsilon;

  static void expect_gradient(const Hinge& hinge, const equations::LinearRow<T>& row,
                              const Velocities& automatic, const Velocities& central, double C,
                              double loss = 1) {
    ASSERT_LE(std::abs(double(row.C) - C), kTolerance * size(hinge));
    ASSERT_LE(mismatch(autodiff::row(row.J), automatic), kTolerance * size(hinge) * loss);
    ASSERT_LE(mismatch(autodiff::row(row.J), central),
              (kTolerance + difference_tolerance) * size(hinge) * loss);
  }
};
using Scalars = testing::Types<double, pintle::Scalar>;
TYPED_TEST_SUITE(LinearRows, Scalars);

// --- distance ------------------------------------------------------------------------------------

template <class T>
T length_of(const Vector3<T>& d) {
  using std::sqrt;
  const T length2 = d.dot(d);
  return sqrt(length2);
}

template <class T>
equations::Distance<T> distance_of(const Hinge& hinge) {
  return equations::distance<T>(hinge.d().cast<T>(), Vector3<T>::Unit(0));
}

TYPED_TEST(LinearRows, DistanceIsTheGradientOfTheLength) {
  using T = TypeParam;
  for (const Hinge& hinge : hinges(kSwings, {0.5, 4})) {
    const double l = hinge.th;
    const auto C = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      return S(length_of(error(hinge, bodies)) - l);
    };
    const auto at = anchors<T>(hinge);
    // The third derivatives are up to 3 size^3 / |d|^2 at the shorter distance.
    this->expect_gradient(
        hinge, equations::distance_row(distance_of<T>(hinge), T(l), at.r_a, at.r_b),
        gradient(C, hinge.bodies), difference(C, hinge.bodies), C(hinge.bodies), 20);
  }
}

TYPED_TEST(LinearRows, DistanceOfAlmostOnePointIsTheGradientToo) {
  // With the direction of the gap as it is: epsilon of the levers over 1e-8 of its digits are
  // right.
  for (const Hinge& hinge : hinges({0}, {1e-8})) {
    const auto C = [&](const auto& bodies) { return length_of(error(hinge, bodies)); };
    const auto at = anchors<double>(hinge);
    const auto row = equations::distance_row(distance_of<double>(hinge), 1.0, at.r_a, at.r_b);
    ASSERT_LE(mismatch(autodiff::row(row.J), gradient(C, hinge.bodies)),
              this->kTolerance * size(hinge) * size(hinge) / 1e-8);
  }
}

TYPED_TEST(LinearRows, DistanceIsScaledAndUnitAtAnySize) {
  using T = TypeParam;
  Random random(1);
  const double tiny = double(std::numeric_limits<T>::min()), huge = 0.2 / tiny;
  for (const double length : {tiny, 1e-8, 1.0, 1e10, huge}) {
    for (int i = 0; i < 100; ++i) {
      const Vector n = random.unit();
      // Entries of the smallest numbers have few digits.
      const double tolerance = length == tiny ? 1e-2 : this->kTolerance;
      if (length == tiny && n.cwiseAbs().minCoeff() < 0.1) continue;
      const Vector3<T> d = (length * n).template cast<T>();
      const auto to = equations::distance<T>(d, Vector3<T>::Unit(2));
      ASSERT_LE(mismatch(to.n.template cast<double>(), n), tolerance) << length;
      ASSERT_LE(std::abs(double(to.n.dot(to.n)) - 1), this->kTolerance);
      ASSERT_LE(std::abs(double(to.length) / length - 1), tolerance) << length;
    }
  }
}

TYPED_TEST(LinearRows, DistanceOfOnePointTakesTheDirectionThatItIsGiven) {
  using T = TypeParam;
  const Vector3<T> fallback(T(0.6), T(0), T(-0.8)), r_a(T(1), T(2), T(3)), r_b(T(3), T(2), T(1));
  const auto to = equations::distance<T>(Vector3<T>::Zero(), fallback);
  EXPECT_EQ(to.n, fallback);
  EXPECT_EQ(to.length, T(0));
  const auto row = equations::distance_row(to, T(2), r_a, r_b);
  EXPECT_EQ(row.C, T(-2));
  EXPECT_EQ(autodiff::row(row.J), autodiff::row(equations::position_row(fallback, r_a, r_b)));
}

TYPED_TEST(LinearRows, PassingCurvatureIsThatOfPointsOnStraightLines) {
  using T = TypeParam;
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const Vector d = random.vector(4), v = random.vector(2);
    if (d.norm() < 1) continue;
    const auto C = [&](double t) { return Vector(d + t * v).norm(); };
    const auto to = equations::distance<T>(d.cast<T>(), Vector3<T>::Unit(0));
    const double curvature = double(equations::passing_curvature<T>(to, v.cast<T>()));
    ASSERT_LE(std::abs(curvature - second_difference(C, kCurvatureStep)),
              20 * this->kTolerance * 12 + 1e-5);
  }
  const equations::Distance<T> nothing{Vector3<T>::Unit(0), T(0)};
  EXPECT_EQ(equations::passing_curvature<T>(nothing, Vector3<T>(T(1), T(2), T(3))), T(0));
}

TYPED_TEST(LinearRows, DistanceConservesAngularMomentumAtAnyError) {
  using T = TypeParam;
  for (const Hinge& hinge : hinges(kSwings, {0.5, 4})) {
    const auto at = anchors<T>(hinge);
    const auto J = equations::distance_row(distance_of<T>(hinge), T(1), at.r_a, at.r_b).J;
    ASSERT_LE(mismatch(added_momentum(hinge, row(J)), Vector::Zero()),
              this->kTolerance * (size(hinge) + 10) * 10);
  }
}

TYPED_TEST(LinearRows, DistanceCurvatureIsTheSecondDerivativeOfTheLength) {
  using T = TypeParam;
  Random random(3);
  double passing = 0;
  for (const Hinge& hinge : hinges(kSwings, {1, 4})) {
    const Velocities v = random.velocities();
    const auto C = [&](double t) { return length_of(error(hinge, moved(hinge.bodies, v, t))); };
    const auto at = anchors<T>(hinge);
    const auto to = distance_of<T>(hinge);
    const auto v_t = velocity<T>(v);
    const double centripetal =
        double(to.n.dot(equations::position_curvature(v_t.w_a, at.r_a, v_t.w_b, at.r_b)));
    const double curvature =
        centripetal +
        double(equations::passing_curvature(to, equations::relative_velocity(v_t, at.r_a, at.r_b)));
    const double exact = second_difference(C, kCurvatureStep);
    // Squares of velocities up to 10; the step's error is the sixth derivative, by up to (v/|d|)^6.
    ASSERT_LE(std::abs(curvature - exact), 20 * this->kTolerance * size(hinge) + 1e-4);
    passing = std::max(passing, std::abs(exact - centripetal));
  }
  // What the centripetal part alone would miss.
  EXPECT_GT(passing, 10);
}

// --- contact -------------------------------------------------------------------------------------

TYPED_TEST(LinearRows, ContactIsTheGradientWithItsNormalFixedInBodyA) {
  using T = TypeParam;
  for (const Hinge& hinge : hinges(kSwings, kGaps)) {
    const Vector n_l = hinge.m, n = arm(hinge.bodies.q_a, n_l);
    const auto C = [&](const auto& bodies) {
      const auto c = arm(bodies.q_a, n_l).dot(error(hinge, bodies));
      return std::decay_t<decltype(c)>(c);
    };
    this->expect_gradient(hinge, equations::contact_row<T>(n.cast<T>(), anchors<T>(hinge)),
                          gradient(C, hinge.bodies), difference(C, hinge.bodies), C(hinge.bodies));
  }
}

TYPED_TEST(LinearRows, ContactOfTheWorldIsTheGradientWithItsNormalFixedThere) {
  using T = TypeParam;
  for (const Hinge& hinge : hinges(kSwings, kGaps)) {
    const Vector n = hinge.axis_a(1);
    const auto C = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      return S(constant<S>(n).dot(error(hinge, bodies)));
    };
    this->expect_gradient(hinge, equations::contact_row_world<T>(n.cast<T>(), anchors<T>(hinge)),
                          gradient(C, hinge.bodies), difference(C, hinge.bodies), C(hinge.bodies));
  }
}

// --- slider --------------------------------------------------------------------------------------

TYPED_TEST(LinearRows, SliderIsTheGradientOfAllThreeCoordinates) {
  using T = TypeParam;
  for (const Hinge& hinge : hinges(kSwings, kGaps)) {
    for (int i = 0; i < 3; ++i) {
      const auto C = [&](const auto& bodies) {
        using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
        const auto frame = equations::product(bodies.q_a, constant<S>(hinge.f_a));
        return S(arm(frame, Vector::Unit(i)).dot(error(hinge, bodies)));
      };
      const Vector3<T> u = hinge.axis_a(i).template cast<T>();
      const auto row = equations::contact_row<T>(u, anchors<T>(hinge));
      this->expect_gradient(hinge, row, gradient(C, hinge.bodies), difference(C, hinge.bodies),
                            C(hinge.bodies));
      ASSERT_LE(mismatch(added_momentum(hinge, autodiff::row(row.J)), Vector::Zero()),
                this->kTolerance * (size(hinge) + 10));
    }
  }
}

TYPED_TEST(LinearRows, SliderMiddleHasTheErrorsAcrossTheAxisAndNoneAlongIt) {
  using T = TypeParam;
  for (const Hinge& hinge : hinges(kSwings, kGaps)) {
    const Vector a = hinge.axis_a(0), c = hinge.axis_a(2), d = hinge.d();
    const auto at = anchors<T>(hinge);
    const Vector3<T> c_T = c.cast<T>(), a_T = a.cast<T>();
    const auto middle = equations::slider_middle<T>(c_T, at);
    const double tolerance = this->kTolerance * size(hinge);
    ASSERT_LE(mismatch(middle.d.template cast<double>(), d - c.dot(d) * c), tolerance);
    // m_a and m_b are on the lines through the anchors, as far along as their middle.
    const Vector m_a = hinge.bodies.x_a + middle.r_a.template cast<double>();
    const Vector m_b = hinge.bodies.x_b + middle.r_b.template cast<double>();
    const Vector p_a = hinge.bodies.x_a + hinge.r_a(), p_b = hinge.bodies.x_b + hinge.r_b();
    ASSERT_LE(mismatch(cross(m_a - p_a, c), Vector::Zero()), tolerance);
    ASSERT_LE(mismatch(cross(m_b - p_b, c), Vector::Zero()), tolerance);
    ASSERT_LE(std::abs(c.dot(m_a - (p_a + p_b) / 2)), tolerance);
    ASSERT_LE(std::abs(c.dot(m_b - (p_a + p_b) / 2)), tolerance);
    const auto row = equations::slider_row_middle<T>(a_T, c_T, at);
    ASSERT_LE(std::abs(double(row.C) - a.dot(d)), tolerance);
  }
}

TYPED_TEST(LinearRows, SliderMiddleHasTheVelocityOfTheErrorIfBothBodiesTurnAlike) {
  using T = TypeParam;
  Random random(4);
  double alone = 0;
  for (const Hinge& hinge : hinges(kSwings, kGaps)) {
    const Vector a = hinge.axis_a(0), c = hinge.axis_a(2);
    const auto at = anchors<T>(hinge);
    // On the slide: the errors across the axis are zero.
    equations::Anchors<T> on = at;
    const double along = random.uniform(-3, 3);
    on.d = (along * c).template cast<T>();
    const Vector3<T> a_T = a.cast<T>(), c_T = c.cast<T>();
    const Velocities J = autodiff::row(equations::slider_row_middle<T>(a_T, c_T, on).J);
    const Velocities exact = autodiff::row(equations::contact_row<T>(a_T, on).J);
    Velocities v = random.velocities();
    alone = std::max(alone, std::abs((J - exact).dot(v)));
    v.segment<3>(9) = v.segment<3>(3);
    ASSERT_LE(std::abs((J - exact).dot(v)), 4 * this->kTolerance * size(hinge));
  }
  EXPECT_GT(alone, 1);
}

TYPED_TEST(LinearRows, ContactAndSliderCurvatureHasTheCoriolisPart) {
  // A bead that flies straight on, at s of a bar that turns at w about z, and outwards at s': seen
  // from the bar it is accelerated by the centrifugal w^2 s along it and the Coriolis -2 w s'
  // across.
  using T = TypeParam;
  const T w = 3, s = 2, rate = 5;
  const equations::Anchors<T> at{Vector3<T>::Zero(), Vector3<T>::Zero(), Vector3<T>(s, 0, 0)};
  equations::Velocity<T> v;
  v.v_a = Vector3<T>::Zero();
  v.w_a = v.w_b = Vector3<T>(0, 0, w);
  v.v_b = Vector3<T>(rate, w * s, 0);
  const Vector3<T> curvature = equations::position_curvature_conserving(at, v);
  EXPECT_EQ(curvature, Vector3<T>(w * w * s, -2 * w * rate, 0));
}

}  // namespace
