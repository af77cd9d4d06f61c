// The hinge by dot products and the hinge of two points: their rows against automatic
// differentiation, their ranks, and what the document says of their recovery.
#include <gtest/gtest.h>
#include <pintle/equations/dot_hinge.h>
#include <pintle/equations/quaternion_hinge.h>
#include <pintle/equations/two_point_hinge.h>
#include <pintle/precision.h>

#include <Eigen/SVD>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;

const std::vector<double> kSwingsWithARightAngle = {0, 1e-8, -pi, pi / 2, pi - 1e-8, pi};

template <class T>
class OtherHinges : public testing::Test {
 public:
  // About as many roundings lie between the poses and an entry.
  static constexpr double kTolerance = 20 * double(std::numeric_limits<T>::epsilon());
};
using Scalars = testing::Types<double, pintle::Scalar>;
TYPED_TEST_SUITE(OtherHinges, Scalars);

template <class T>
Vector3<T> axis(const Quaternion<T>& q, const Turn& frame, int i) {
  return arm(equations::product(q, constant<T>(frame)), Vector::Unit(i));
}

// --- dot products --------------------------------------------------------------------------------

template <class T>
equations::AngularRow<T> dot_row(const Hinge& hinge, int i) {
  return equations::dot_hinge_row<T>(hinge.axis_a(2).cast<T>(), hinge.axis_b(i).cast<T>());
}

TYPED_TEST(OtherHinges, DotIsTheGradientOnAndOffTheManifold) {
  for (const Hinge& hinge : hinges(kSwingsWithARightAngle, {0, 1})) {
    for (int i = 0; i < 2; ++i) {
      const auto C = [&](const auto& bodies) {
        const auto c = axis(bodies.q_a, hinge.f_a, 2).dot(axis(bodies.q_b, hinge.f_b, i));
        return std::decay_t<decltype(c)>(c);
      };
      const auto row = dot_row<TypeParam>(hinge, i);
      const Velocities J = angular_row(row.J_b);
      ASSERT_LE(std::abs(double(row.C) - C(hinge.bodies)), this->kTolerance);
      ASSERT_LE(mismatch(J, gradient(C, hinge.bodies)), this->kTolerance);
      ASSERT_LE(mismatch(J, difference(C, hinge.bodies)), this->kTolerance + difference_tolerance);
    }
  }
}

TYPED_TEST(OtherHinges, DotHasSingularValuesOneAndCosOfTheSwing) {
  for (const Hinge& hinge : hinges(kSwingsWithARightAngle, {0})) {
    const Vector J_0 = dot_row<TypeParam>(hinge, 0).J_b.template cast<double>();
    const Vector J_1 = dot_row<TypeParam>(hinge, 1).J_b.template cast<double>();
    const double cosine = std::cos(hinge.swing);
    const double trace = J_0.dot(J_0) + J_1.dot(J_1);
    const double determinant = J_0.dot(J_0) * J_1.dot(J_1) - J_0.dot(J_1) * J_0.dot(J_1);
    // Of rows up to twice as long as those of the quaternions, so four times their squares.
    ASSERT_LE(std::abs(trace - (1 + cosine * cosine)), 4 * this->kTolerance);
    ASSERT_LE(std::abs(determinant - cosine * cosine), 4 * this->kTolerance);
    // The one that vanishes is along the error.
    const Vector n = hinge.halfway(hinge.m);
    ASSERT_LE(std::abs(std::hypot(J_0.dot(n), J_1.dot(n)) - std::abs(cosine)), this->kTolerance);
  }
}

TYPED_TEST(OtherHinges, DotPullsTheAxesTo180DegreesFromBeyond90) {
  // The step of the rows along the error: C/J = tan(swing), backwards beyond 90 degrees.
  for (unsigned seed = 0; seed < 200; ++seed) {
    for (const double swing : {0.5, 1.5, 1.6, 3.0}) {
      const Hinge hinge = make_hinge(seed, 0.3, swing, 0, 1);
      const Vector n = hinge.halfway(hinge.m);
      double along = 0, square = 0;
      for (int i = 0; i < 2; ++i) {
        const auto row = dot_row<double>(hinge, i);
        along += row.J_b.dot(n) * row.C;
        square += row.J_b.dot(n) * row.J_b.dot(n);
      }
      ASSERT_LE(std::abs(along / square - std::tan(swing)), 1e-11 * std::abs(std::tan(swing)));
      ASSERT_EQ(along / square > 0, swing < pi / 2);
    }
  }
}

// --- two points ----------------------------------------------------------------------------------

template <class T>
equations::LinearRow<T> point_row(const Hinge& hinge, const Vector& u, double s) {
  const Vector3<T> c_a = hinge.axis_a(2).cast<T>(), c_b = hinge.axis_b(2).cast<T>();
  return equations::contact_row_world<T>(
      u.cast<T>(), equations::point_on_axis<T>(anchors<T>(hinge), c_a, c_b, T(s)));
}

TYPED_TEST(OtherHinges, PointsAreTheGradientOnAndOffTheManifold) {
  Random random(1);
  for (const Hinge& hinge : hinges(kSwingsWithARightAngle, {0, 1})) {
    const double s = random.uniform(-2, 2);
    const Vector u = random.unit();
    const auto C = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      const Vector3<S> d = error(hinge, bodies) +
                           S(s) * (axis(bodies.q_b, hinge.f_b, 2) - axis(bodies.q_a, hinge.f_a, 2));
      return S(d.dot(constant<S>(u)));
    };
    const auto row = point_row<TypeParam>(hinge, u, s);
    const double scale = size(hinge) + 2;
    ASSERT_LE(std::abs(double(row.C) - C(hinge.bodies)), this->kTolerance * scale);
    ASSERT_LE(mismatch(autodiff::row(row.J), gradient(C, hinge.bodies)), this->kTolerance * scale);
    ASSERT_LE(mismatch(autodiff::row(row.J), difference(C, hinge.bodies)),
              (this->kTolerance + difference_tolerance) * scale);
  }
}

using Rows = Eigen::Matrix<double, Eigen::Dynamic, 12>;
using Errors = Eigen::Matrix<double, Eigen::Dynamic, 1>;
struct System {
  Rows J;
  Errors C;
};

struct Directions {
  Vector p, q, h;
};
Directions directions(const Hinge& hinge) {
  const Vector h = equations::swing<double>(hinge.axis_a(2), hinge.axis_b(2)).h;
  const Vector p = pintle::any_tangent(h);
  return {p, cross(h, p), h};
}

// All six rows; and the five: p and q of both points, h of the joint's own anchors.
System six_rows(const Hinge& hinge, const equations::TwoPoints<double>& points) {
  System system{Rows(6, 12), Errors(6)};
  const Directions to = directions(hinge);
  int i = 0;
  for (const double s : {points.s_1, points.s_2}) {
    for (const Vector& u : {to.p, to.q, to.h}) {
      const auto row = point_row<double>(hinge, u, s);
      system.J.row(i) = autodiff::row(row.J);
      system.C[i++] = row.C;
    }
  }
  return system;
}
System five_rows(const Hinge& hinge, const equations::TwoPoints<double>& points) {
  System system = six_rows(hinge, points);
  const auto h = point_row<double>(hinge, directions(hinge).h, 0);
  system.J.row(2) = autodiff::row(h.J);
  system.C[2] = h.C;
  system.J.conservativeResize(5, 12);
  system.C.conservativeResize(5);
  return system;
}
Errors singular_values(const Rows& J) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(J).singularValues();
}

const equations::TwoPoints<double> kPoints = equations::points_about_anchor(2.0);

TEST(TwoPointHinge, SixRowsHaveRankFiveOnTheManifoldAndFiveRowsHaveItToo) {
  for (const Hinge& hinge : hinges({0}, {0}, 50)) {
    const Errors six = singular_values(six_rows(hinge, kPoints).J);
    ASSERT_LE(six[5], 20 * epsilon * size(hinge));
    ASSERT_GE(six[4], 0.1);
    const Errors five = singular_values(five_rows(hinge, kPoints).J);
    ASSERT_GE(five[4], 0.1);
    // They span what the six span: what is left of any of the six beside them is nothing.
    const Rows J = five_rows(hinge, kPoints).J;
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::MatrixXd span = svd.matrixV();
    const Rows all = six_rows(hinge, kPoints).J;
    ASSERT_LE(mismatch(all * span * span.transpose(), all), 100 * epsilon * size(hinge));
  }
}

TEST(TwoPointHinge, SixRowsHaveRankSixOffTheManifold) {
  // Which is worse: the sixth row pushes along the redundant direction, by sin(swing/2).
  for (const Hinge& hinge : hinges({0.1, 1}, {0, 1}, 50)) {
    const Errors six = singular_values(six_rows(hinge, kPoints).J);
    ASSERT_GE(six[5], 0.1 * std::sin(hinge.swing / 2));
    ASSERT_LE(six[5], 2 * std::sin(hinge.swing / 2));
    ASSERT_GE(singular_values(five_rows(hinge, kPoints).J)[4], 0.1);
  }
}

TYPED_TEST(OtherHinges, PointsHaveOneErrorAlongHAtAnyViolation) {
  Random random(2);
  for (const Hinge& hinge : hinges({0, 1e-8, -3, pi}, {0, 1})) {
    const Vector h = directions(hinge).h;
    const double none = double(point_row<TypeParam>(hinge, h, 0).C);
    for (int i = 0; i < 3; ++i) {
      const double s = random.uniform(-3, 3);
      ASSERT_LE(std::abs(double(point_row<TypeParam>(hinge, h, s).C) - none),
                this->kTolerance * (size(hinge) + 3));
    }
  }
}

TYPED_TEST(OtherHinges, PointsOfASatisfiedHingeHaveOneRowAlongTheAxis) {
  for (const Hinge& hinge : hinges({0}, {0})) {
    const Vector c = hinge.axis_a(2);
    const Velocities J = autodiff::row(point_row<TypeParam>(hinge, c, 0).J);
    ASSERT_LE(mismatch(autodiff::row(point_row<TypeParam>(hinge, c, 2).J), J),
              this->kTolerance * (size(hinge) + 2));
  }
}

TEST(TwoPointHinge, RecoversFromErrorsBeyond90DegreesButNotFrom180) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    for (const double swing : {0.5, 1.6, 2.5, 3.0, pi}) {
      const Hinge hinge = make_hinge(seed, 0.3, swing, 0, 1);
      for (const System& system : {six_rows(hinge, kPoints), five_rows(hinge, kPoints)}) {
        // The smallest velocities that satisfy the rows as well as can be.
        Eigen::JacobiSVD<Eigen::MatrixXd> svd(system.J, Eigen::ComputeThinU | Eigen::ComputeThinV);
        svd.setThreshold(1e-10);
        const Velocities v = svd.solve(-system.C);
        const Vector w = v.segment<3>(9) - v.segment<3>(3);
        const double closing = -w.dot(hinge.halfway(hinge.m));
        if (swing == pi) {
          ASSERT_LE(std::abs(closing), 1e-9) << seed;
          ASSERT_GT((system.J * v + system.C).norm(), 1);
        } else {
          ASSERT_GT(closing, 0.05 * swing) << seed << " " << swing;
          ASSERT_LT((system.J * v + system.C).norm(), 1e-9);
        }
      }
    }
  }
}

TYPED_TEST(OtherHinges, PointsAreWhereTheyAreSaidToBe) {
  using T = TypeParam;
  const auto about = equations::points_about_anchor(T(3));
  EXPECT_EQ(about.s_1, T(-1.5));
  EXPECT_EQ(about.s_2, T(1.5));
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Vector r = random.vector(3), c = random.unit();
    const auto points = equations::points_from_nearest<T>(r.cast<T>(), c.cast<T>(), T(2));
    EXPECT_LE(std::abs(double(points.s_1 - points.s_2) - 2), this->kTolerance);
    // The lever of the nearest point is normal to the axis.
    EXPECT_LE(std::abs((r + double(points.s_2) * c).dot(c)), this->kTolerance * 3);
  }
}

}  // namespace
