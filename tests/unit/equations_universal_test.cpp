// The universal and the constant velocity joint: rows and curvatures against automatic
// differentiation and central differences, the universal joint's angles, and where their constraints
// are satisfied.
#include <gtest/gtest.h>
#include <pintle/equations/cone_twist.h>
#include <pintle/equations/constant_velocity.h>
#include <pintle/equations/universal.h>
#include <pintle/precision.h>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;

template <class T>
class Shafts : public testing::Test {
 public:
  static constexpr double kEpsilon = double(std::numeric_limits<T>::epsilon());
  static constexpr double kTolerance = 20 * kEpsilon;

  static equations::CrossAxes<T> axes_a(const Hinge& hinge) {
    return {hinge.axis_a(1).cast<T>(), hinge.axis_a(2).cast<T>()};
  }
  static equations::CrossAxes<T> axes_b(const Hinge& hinge) {
    return {hinge.axis_b(1).cast<T>(), hinge.axis_b(2).cast<T>()};
  }
  static equations::AngularRow<T> velocity_row(const Hinge& hinge) {
    const Turn p = turn(hinge, hinge.bodies);
    const Matrix3<double> F = matrix(hinge.frame_a());
    return equations::constant_velocity_row<T>({T(p.w), p.v.cast<T>()}, F.cast<T>(),
                                               Vector3<T>::Unit(0));
  }
};
using Scalars = testing::Types<double, pintle::Scalar>;
TYPED_TEST_SUITE(Shafts, Scalars);

// Bodies whose joint frames are turned against each other by p.
Hinge make(unsigned seed, const Turn& p, double sign = 1) {
  using equations::product;
  Hinge hinge = make_hinge(seed, 0, 0, 0, 1);
  const Turn q_b = product(product(hinge.frame_a(), p), equations::conjugate(hinge.f_b));
  hinge.bodies.q_b = {sign * q_b.w, sign * q_b.v};
  return hinge;
}
Turn about(int axis, double angle) {
  return equations::rotation<double>(Vector::Unit(axis), angle);
}
// Rz(alpha) Ry(beta) Rx(gamma)
Turn euler(double alpha, double beta, double gamma) {
  return equations::product(equations::product(about(2, alpha), about(1, beta)), about(0, gamma));
}
// A bend about an axis normal to x, after a twist about x.
Turn bent(double direction, double bend, double twist) {
  const Vector axis(0, std::cos(direction), std::sin(direction));
  return equations::product(equations::rotation(axis, bend), about(0, twist));
}

std::vector<Hinge> satisfied_universals() {
  std::vector<Hinge> all;
  for (unsigned seed = 0; seed < 300; ++seed) {
    Random random(seed);
    const double alpha = seed % 4 ? random.uniform(-pi, pi) : 0;
    const double beta = seed % 3 ? random.uniform(-pi, pi) : 1e-8;
    all.push_back(make(seed, euler(alpha, beta, 0), seed % 2 ? 1 : -1));
  }
  return all;
}

// --- universal -----------------------------------------------------------------------------------

TYPED_TEST(Shafts, UniversalRowsAreTheGradientOnAndOffTheManifold) {
  using T = TypeParam;
  std::vector<Hinge> all = hinges({0, 1e-8, -1, -pi, pi}, {0, 1});
  for (const Hinge& hinge : satisfied_universals()) all.push_back(hinge);
  for (const Hinge& hinge : all) {
    const Vector3<T> z = hinge.axis_a(2).cast<T>(), y = hinge.axis_b(1).cast<T>();
    const auto dot = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      return S(axis_a(hinge, bodies, 2).dot(axis_b(hinge, bodies, 1)));
    };
    const auto document = equations::universal_dot_row(z, y);
    ASSERT_LE(std::abs(double(document.C) - dot(hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(angular_row(document.J_b), gradient(dot, hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(angular_row(document.J_b), difference(dot, hinge.bodies)),
              this->kTolerance + difference_tolerance);

    const auto angle = [&](const auto& bodies) {
      using std::atan2;
      using std::sqrt;
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      const auto u = axis_a(hinge, bodies, 2), v = axis_b(hinge, bodies, 1), n = cross(u, v);
      return S(atan2(S(u.dot(v)), S(sqrt(n.dot(n)))));
    };
    const auto row = equations::universal_row(z, y);
    const double length = double(document.J_b.norm());
    ASSERT_LE(std::abs(double(row.J_b.norm()) - 1), this->kTolerance);
    if (length < 1e-3) continue;
    ASSERT_LE(std::abs(double(row.C) - angle(hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(angular_row(row.J_b), gradient(angle, hinge.bodies)),
              this->kTolerance / length);
    if (length > 0.3) {
      ASSERT_LE(mismatch(angular_row(row.J_b), difference(angle, hinge.bodies)),
                this->kTolerance / length + 30 * difference_tolerance);
    }
  }
}

TYPED_TEST(Shafts, UniversalIsSatisfiedByTwoTurnsAndDefiniteWithItsHingesTogether) {
  using T = TypeParam;
  for (const Hinge& hinge : satisfied_universals()) {
    const Vector3<T> z = hinge.axis_a(2).cast<T>(), y = hinge.axis_b(1).cast<T>();
    ASSERT_LE(std::abs(double(equations::universal_dot_row(z, y).C)), this->kTolerance);
    ASSERT_LE(std::abs(double(equations::universal_row(z, y).C)), this->kTolerance);
    const auto together = equations::universal_row<T>(z, z);
    ASSERT_LE(std::abs(double(together.C) - pi / 2), 1e-3);
    ASSERT_LE(std::abs(double(together.J_b.norm()) - 1), this->kTolerance);
    ASSERT_LE(std::abs(double(equations::universal_row<T>(z, Vector3<T>(-z)).C) + pi / 2), 1e-3);
  }
  const Vector3<T> zero = Vector3<T>::Zero();
  EXPECT_TRUE(equations::universal_row(zero, zero).J_b.allFinite());
}

template <class T>
equations::AngularRow<T> gamma_row(const Hinge& hinge) {
  return equations::universal_gamma_row<T>(hinge.axis_a(2).cast<T>(), hinge.axis_b(0).cast<T>(),
                                           hinge.axis_b(2).cast<T>());
}

TYPED_TEST(Shafts, UniversalGammaRowIsTheGradientOfGammaTimesTheCosineOfBeta) {
  using T = TypeParam;
  for (unsigned seed = 0; seed < 300; ++seed) {
    Random random(seed);
    const double beta = random.uniform(-1.5, 1.5), cosine = std::cos(beta);
    const double gamma = seed % 3 ? random.uniform(-pi, pi) : seed % 2 ? 0 : 1e-8;
    const Hinge hinge = make(seed, euler(random.uniform(-pi, pi), beta, gamma));
    const auto row = gamma_row<T>(hinge);
    // Angles up to pi: three times as many.
    ASSERT_LE(std::abs(double(row.C) - cosine * gamma), 3 * this->kTolerance);
    ASSERT_LE(std::abs(double(row.J_b.norm()) - 1), 2 * this->kTolerance);
    const auto C = [&](const auto& bodies) {
      using std::atan2;
      // z_a as body b sees it, away from the cut.
      const auto p = equations::conjugate(turn(hinge, bodies));
      using S = std::decay_t<decltype(p.w)>;
      const auto v = equations::rotate(p, Vector3<S>(S(0), S(0), S(1)));
      const S c(std::cos(gamma)), s(std::sin(gamma));
      return S(atan2(c * v.y() - s * v.z(), c * v.z() + s * v.y()));
    };
    // The definition is turned by gamma here, in as many roundings again.
    const double tolerance = 2 * this->kTolerance / cosine;
    ASSERT_LE(mismatch(angular_row(row.J_b), cosine * gradient(C, hinge.bodies)), tolerance);
    if (cosine > 0.3) {
      ASSERT_LE(mismatch(angular_row(row.J_b), cosine * difference(C, hinge.bodies)),
                tolerance + 100 * difference_tolerance);
    }
    if (std::abs(gamma) < 1e-7) {
      const auto other =
          equations::universal_row<T>(hinge.axis_a(2).cast<T>(), hinge.axis_b(1).cast<T>());
      // They part with gamma.
      ASSERT_LE(mismatch(row.J_b, other.J_b), T(tolerance + 1e-8));
    }
  }
}

TYPED_TEST(Shafts, UniversalGammaRowHasOneAttractorAndTheOthersTwo) {
  // Steps along the row, a tenth of the error each, from any gamma.
  const auto settle = [](Hinge hinge, const auto& row_of) {
    for (int i = 0; i < 300; ++i) {
      const auto row = row_of(hinge);
      Velocities v = Velocities::Zero();
      v.segment<3>(9) = -0.1 * double(row.C) * row.J_b.template cast<double>();
      hinge.bodies = moved(hinge.bodies, v, 1);
    }
    return hinge.axis_a(2).dot(hinge.axis_b(2));
  };
  using T = TypeParam;
  int upside_down = 0, count = 0;
  for (const double beta : {0.0, 0.5, -1.2}) {
    for (int i = -17; i <= 18; ++i) {
      const Hinge hinge = make(unsigned(i + 180), euler(0.7, beta, i * pi / 18));
      ASSERT_GT(settle(hinge, gamma_row<T>), 0.1) << i << " " << beta;
      const auto either = [](const Hinge& at) {
        return equations::universal_row<T>(at.axis_a(2).cast<T>(), at.axis_b(1).cast<T>());
      };
      upside_down += settle(hinge, either) < 0;
      ++count;
    }
  }
  EXPECT_GT(upside_down, count * 4 / 10);
  EXPECT_LT(upside_down, count * 6 / 10);
}

TYPED_TEST(Shafts, UniversalGammaRowIsDefiniteAtTheEndsOfBetaAndGentleBeyond) {
  for (const double beta : {pi / 2, -pi / 2}) {
    const auto row = gamma_row<TypeParam>(make(3, euler(0.4, beta, 0)));
    EXPECT_LE(std::abs(double(row.C)), 1e-6);
    EXPECT_LE(std::abs(double(row.J_b.norm()) - 1), this->kTolerance);
    const double over = 1e-2 * (beta < 0 ? -1 : 1);
    const auto beyond = gamma_row<TypeParam>(make(4, euler(0.4, beta + over, 0)));
    EXPECT_LE(std::abs(double(beyond.C)), pi * 1e-2);
  }
  const Vector3<TypeParam> zero = Vector3<TypeParam>::Zero();
  EXPECT_TRUE(equations::universal_gamma_row(zero, zero, zero).J_b.allFinite());
}

TYPED_TEST(Shafts, UniversalCurvatureIsTheSecondDerivativeOfAllForms) {
  using T = TypeParam;
  Random random(7);
  for (const Hinge& hinge : satisfied_universals()) {
    const Velocities v = random.velocities();
    const auto axes = [&](double t) {
      const Bodies<double> then = moved(hinge.bodies, v, t);
      return std::make_pair(axis_a(hinge, then, 2), axis_b(hinge, then, 1));
    };
    const double dot = second_difference(
        [&](double t) { return equations::universal_dot_row(axes(t).first, axes(t).second).C; },
        5e-3);
    const double angle = second_difference(
        [&](double t) { return equations::universal_row(axes(t).first, axes(t).second).C; }, 5e-3);
    const double found = double(
        equations::universal_curvature<T>(hinge.axis_a(2).cast<T>(), hinge.axis_b(1).cast<T>(),
                                          v.segment<3>(3).cast<T>(), v.segment<3>(9).cast<T>()));
    // h^4/90 w^6 at speeds up to 3.5, and epsilon/h^2.
    ASSERT_LE(std::abs(found - dot), 10 * this->kTolerance + 3e-8);
    ASSERT_LE(std::abs(found - angle), 10 * this->kTolerance + 3e-8);
    // cos(beta) gamma, where that is smooth: its sixth derivative grows as 1/cos(beta) does.
    const double cosine = hinge.axis_a(2).dot(hinge.axis_b(2));
    if (cosine < 0.5) continue;
    const double gamma = second_difference(
        [&](double t) {
          Hinge then = hinge;
          then.bodies = moved(hinge.bodies, v, t);
          return gamma_row<double>(then).C;
        },
        5e-3);
    ASSERT_LE(std::abs(found - gamma), 10 * this->kTolerance + 1e-6);
  }
}

TYPED_TEST(Shafts, SpiderAnglesAreTheHingesAtAnyBendAndTheirRowsTheirAxes) {
  using T = TypeParam;
  for (unsigned seed = 0; seed < 300; ++seed) {
    Random random(seed);
    // Half of them beyond a quarter of a turn, some exactly there, where x_b is along z.
    const double alpha = random.uniform(-3, 3);
    const double beta = seed % 5 ? random.uniform(-3, 3) : (seed % 2 ? pi / 2 : -pi / 2);
    const Hinge hinge = make(seed, euler(alpha, beta, 0), seed % 3 ? 1 : -1);
    const auto to_of = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      const auto a = [&](int i) { return axis_a(hinge, bodies, i); };
      const auto b = [&](int i) { return axis_b(hinge, bodies, i); };
      return equations::spider_angles<S>(a(0).dot(b(1)), a(1).dot(b(1)), a(2).dot(b(0)),
                                         a(2).dot(b(2)));
    };
    const auto alpha_of = [&](const auto& bodies) {
      using std::atan2;
      const auto to = to_of(bodies);
      return decltype(to.alpha_x)(atan2(to.alpha_y, to.alpha_x));
    };
    const auto beta_of = [&](const auto& bodies) {
      using std::atan2;
      const auto to = to_of(bodies);
      return decltype(to.beta_x)(atan2(to.beta_y, to.beta_x));
    };
    ASSERT_LE(std::abs(alpha_of(hinge.bodies) - alpha), this->kTolerance);
    ASSERT_LE(std::abs(beta_of(hinge.bodies) - beta), this->kTolerance);
    const Vector3<T> z = hinge.axis_a(2).cast<T>(), y = hinge.axis_b(1).cast<T>();
    ASSERT_LE(mismatch(angular_row(z), gradient(alpha_of, hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(angular_row(y), gradient(beta_of, hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(angular_row(z), difference(alpha_of, hinge.bodies)),
              this->kTolerance + 30 * difference_tolerance);
    ASSERT_LE(mismatch(angular_row(y), difference(beta_of, hinge.bodies)),
              this->kTolerance + 30 * difference_tolerance);
  }
}

// --- constant velocity ---------------------------------------------------------------------------

std::vector<Hinge> satisfied_constant_velocities() {
  std::vector<Hinge> all;
  for (unsigned seed = 0; seed < 300; ++seed) {
    Random random(seed);
    const double bend = seed % 4 ? random.uniform(0, 179 * pi / 180) : seed % 8 ? 1e-8 : 0;
    all.push_back(make(seed, bent(random.uniform(-pi, pi), bend, 0), seed % 2 ? 1 : -1));
  }
  return all;
}

TYPED_TEST(Shafts, ConstantVelocityRowsAreTheGradientOnAndOffTheManifold) {
  std::vector<Hinge> all = hinges({0, 1e-8, -1, -pi, pi}, {0, 1});
  for (const Hinge& hinge : satisfied_constant_velocities()) all.push_back(hinge);
  for (const Hinge& hinge : all) {
    const auto dot = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      const auto axis = [&](int i) { return axis_a(hinge, bodies, i); };
      const auto axis_of_b = [&](int i) { return axis_b(hinge, bodies, i); };
      return S(axis(1).dot(axis_of_b(2)) - axis(2).dot(axis_of_b(1)));
    };
    const auto document =
        equations::constant_velocity_dot_row(this->axes_a(hinge), this->axes_b(hinge));
    ASSERT_LE(std::abs(double(document.C) - dot(hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(angular_row(document.J_b), gradient(dot, hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(angular_row(document.J_b), difference(dot, hinge.bodies)),
              this->kTolerance + 2 * difference_tolerance);
    const Turn p = turn(hinge, hinge.bodies);
    ASSERT_LE(std::abs(double(document.C) + 4 * p.w * p.v.x()), this->kTolerance);

    const auto angle = [&](const auto& bodies) {
      using std::atan2;
      using std::sqrt;
      const auto q = turn(hinge, bodies);
      using S = std::decay_t<decltype(q.w)>;
      return S(S(2) * atan2(q.v.x(), S(sqrt(q.w * q.w + q.v.y() * q.v.y() + q.v.z() * q.v.z()))));
    };
    const auto row = this->velocity_row(hinge);
    ASSERT_LE(std::abs(double(row.J_b.norm()) - 1), this->kTolerance);
    const double length = std::sqrt(1 - p.v.x() * p.v.x());
    if (!(length > 1e-3)) continue;
    ASSERT_LE(std::abs(double(row.C) - angle(hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(angular_row(row.J_b), gradient(angle, hinge.bodies)),
              this->kTolerance / length);
    if (length > 0.3) {
      ASSERT_LE(mismatch(angular_row(row.J_b), difference(angle, hinge.bodies)),
                this->kTolerance / length + 30 * difference_tolerance);
    }
  }
}

TYPED_TEST(Shafts, ConstantVelocityRowIsTheBisectingAxisAtAnyBend) {
  using T = TypeParam;
  for (const Hinge& hinge : satisfied_constant_velocities()) {
    const auto row = this->velocity_row(hinge);
    ASSERT_LE(std::abs(double(row.C)), this->kTolerance);
    const Vector sum = hinge.axis_a(0) + hinge.axis_b(0);
    const double sign = turn(hinge, hinge.bodies).w < 0 ? -1 : 1;
    ASSERT_LE(mismatch(row.J_b.template cast<double>(), Vector(sign * sum / sum.norm())),
              this->kTolerance / (sum.norm() / 2));
    // The document's is 2 cos(bend/2) long.
    const auto document =
        equations::constant_velocity_dot_row(this->axes_a(hinge), this->axes_b(hinge));
    ASSERT_LE(std::abs(double(document.J_b.norm()) - sum.norm()), this->kTolerance);
    // Its bend: the cone's.
    const Vector3<T> x_a = hinge.axis_a(0).cast<T>(), x_b = hinge.axis_b(0).cast<T>();
    const auto bend = equations::cone_row(equations::swing(x_a, x_b), x_a, T(0));
    ASSERT_LE(std::abs(double(bend.C) - std::atan2(cross(hinge.axis_a(0), hinge.axis_b(0)).norm(),
                                                   hinge.axis_a(0).dot(hinge.axis_b(0)))),
              this->kTolerance);
    // Normal to it.
    ASSERT_LE(
        std::abs(double(bend.J_b.dot(row.J_b))),
        this->kTolerance / std::max(0.01, std::sin(double(bend.C))) + (bend.C < 1e-3 ? 1 : 0));
  }
}

TYPED_TEST(Shafts, ConstantVelocityErrorIsTheTwistAndIsDefiniteAtHalfATurn) {
  using T = TypeParam;
  for (unsigned seed = 0; seed < 300; ++seed) {
    Random random(seed);
    const double twist = random.uniform(-pi, pi), bend = random.uniform(0, 3);
    const Hinge straight = make(seed, about(0, twist));
    ASSERT_LE(std::abs(double(this->velocity_row(straight).C) - twist), this->kTolerance);
    // A shortest turn that satisfies the joint: C about the row does.
    const Hinge any = make(seed, bent(1, bend, twist));
    const auto row = this->velocity_row(any);
    Velocities v = Velocities::Zero();
    v.template segment<3>(9) = -double(row.C) * row.J_b.template cast<double>();
    Hinge then = any;
    then.bodies = moved(any.bodies, v, 1);
    ASSERT_LE(std::abs(turn(then, then.bodies).v.x()), 2 * this->kTolerance);
  }
  const Matrix3<T> F = Matrix3<T>::Identity();
  const Vector3<T> x = Vector3<T>::Unit(0), zero = Vector3<T>::Zero();
  const auto half_turn = equations::constant_velocity_row<T>({T(0), x}, F, x);
  EXPECT_EQ(half_turn.C, T(pi));
  EXPECT_EQ(half_turn.J_b, x);
  EXPECT_TRUE(equations::constant_velocity_row<T>({T(0), zero}, F, x).J_b.allFinite());
}

TYPED_TEST(Shafts, ConstantVelocityCurvatureIsTheSecondDerivative) {
  using T = TypeParam;
  Random random(8);
  for (const Hinge& hinge : satisfied_constant_velocities()) {
    const Velocities v = random.velocities();
    const Vector w_a = v.segment<3>(3), w_b = v.segment<3>(9);
    const auto then = [&](double t) {
      Hinge moved_hinge = hinge;
      moved_hinge.bodies = moved(hinge.bodies, v, t);
      return moved_hinge;
    };
    const double angle =
        second_difference([&](double t) { return Shafts<double>::velocity_row(then(t)).C; }, 5e-3);
    const auto row = this->velocity_row(hinge);
    const double found =
        double(equations::constant_velocity_curvature<T>(row.J_b, w_a.cast<T>(), w_b.cast<T>()));
    // h^4/90 w^6 at speeds up to 3.5, and epsilon/h^2.
    ASSERT_LE(std::abs(found - angle), 10 * this->kTolerance + 3e-8);
  }
}

TYPED_TEST(Shafts, ShaftAngleGrowsWithTheShaftAndItsRowIsTheGradient) {
  using T = TypeParam;
  for (const Hinge& hinge : satisfied_constant_velocities()) {
    const Vector x_a = hinge.axis_a(0), x_b = hinge.axis_b(0);
    const double sine = cross(x_a, x_b).norm();
    const auto shaft =
        equations::shaft_angle<T>(x_a.cast<T>(), hinge.axis_a(1).cast<T>(), x_b.cast<T>());
    ASSERT_LE(std::abs(double(shaft.unit.norm()) - 1), this->kTolerance);
    if (sine < 1e-3) continue;
    const Vector J = shaft.J_b().template cast<double>();
    // Both at 2 rad/s along their own shafts.
    ASSERT_LE(std::abs(J.dot(2 * (x_b - x_a)) - 2), 2 * this->kTolerance / (sine * sine));
    const double now = double(shaft.angle());
    const auto C = [&](const auto& bodies) {
      using std::atan2;
      const auto p = turn(hinge, bodies);
      using S = std::decay_t<decltype(p.w)>;
      const auto v = equations::rotate(p, Vector3<S>(S(1), S(0), S(0)));
      const S c(std::cos(now)), s(std::sin(now));
      return S(atan2(-c * v.z() - s * v.y(), c * v.y() - s * v.z()));
    };
    ASSERT_LE(std::abs(C(hinge.bodies)), this->kTolerance / sine);
    ASSERT_LE(mismatch(angular_row(J), gradient(C, hinge.bodies)),
              this->kTolerance / (sine * sine));
  }
}

}  // namespace
