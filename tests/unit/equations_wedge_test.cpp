// The angle of a direction about an axis, the wedge's planes, and the angular limit: rows against
// automatic differentiation and central differences, and who is inside, for any total angle.
#include <gtest/gtest.h>
#include <pintle/equations/angular_limit.h>
#include <pintle/equations/wedge.h>
#include <pintle/precision.h>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;

template <class T>
class Wedge : public testing::Test {
 public:
  static constexpr double kEpsilon = double(std::numeric_limits<T>::epsilon());
  static constexpr double kTolerance = 20 * kEpsilon;
};
using Scalars = testing::Types<double, pintle::Scalar>;
TYPED_TEST_SUITE(Wedge, Scalars);

// The wedge's w is the z of frame a, c_a any direction of body a, c_b the x of frame b.
struct Case {
  Hinge hinge;
  Vector reference;  // of body a, in its joint frame
};

// An angle, whose row is a unit vector; it is made unit with `length`.
template <class T, class Function>
void expectUnitRow(const equations::AngularRow<T>& row, const Function& C,
                   const Bodies<double>& bodies, double tolerance, double length) {
  const Velocities J = angular_row(row.J_b);
  ASSERT_LE(std::abs(double(row.C) - C(bodies)), tolerance);
  ASSERT_LE(std::abs(double(row.J_b.norm()) - 1), Wedge<T>::kTolerance);
  ASSERT_LE(mismatch(J, gradient(C, bodies)), tolerance);
  ASSERT_LE(mismatch(J, difference(C, bodies)),
            tolerance + difference_tolerance / (length * length));
}
std::vector<Case> cases() {
  std::vector<Case> all;
  for (const Hinge& hinge : hinges({0, 1e-8, -1, -pi, pi - 1e-8, pi}, {0, 1})) {
    Random random(unsigned(all.size()));
    Vector reference = random.unit();
    if (all.size() % 3 == 0) reference = Vector::Unit(0);
    if (std::abs(reference.z()) > 0.95) reference = Vector(0.6, 0, 0.8);
    all.push_back({hinge, reference});
  }
  return all;
}
Vector world_reference(const Case& at) {
  return equations::rotate<double>(at.hinge.frame_a(), at.reference);
}

// The angle by its definition, without the code's vectors: the components in the frame of body a.
template <class T>
T angle(const Case& at, const Bodies<T>& bodies, double from = 0) {
  using std::atan2;
  const auto p = turn(at.hinge, bodies);
  const Vector3<T> v = equations::rotate(p, Vector3<T>(T(1), T(0), T(0)));
  const double zero = std::atan2(at.reference.y(), at.reference.x()) + from;
  const T c(std::cos(zero)), s(std::sin(zero));
  return T(atan2(c * v.y() - s * v.x(), c * v.x() + s * v.y()));
}

TYPED_TEST(Wedge, AngleAboutAnAxisAndItsRowAreTheGradient) {
  using T = TypeParam;
  int checked = 0;
  for (const Case& at : cases()) {
    const Hinge& hinge = at.hinge;
    const auto to = equations::angle_about<T>(
        hinge.axis_a(2).cast<T>(), world_reference(at).cast<T>(), hinge.axis_b(0).cast<T>());
    const double length = cross(hinge.axis_a(2), hinge.axis_b(0)).norm();
    ASSERT_LE(std::abs(double(to.length) - length), this->kTolerance);
    // J has three components in the plane of w and c_b: what is small keeps epsilon over |u|.
    const double tolerance = this->kTolerance / std::max(length, 1e-9);
    if (length < 1e-4) continue;
    const double expected = angle(at, hinge.bodies);
    ASSERT_LE(std::abs(double(to.unit.norm()) - 1), tolerance);
    ASSERT_LE(std::abs(std::remainder(double(to.angle()) - expected, 2 * pi)),
              tolerance / std::hypot(at.reference.x(), at.reference.y()));
    // Away from the cut.
    const auto C = [&](const auto& bodies) { return angle(at, bodies, expected); };
    const Velocities J = angular_row(to.J_b());
    ASSERT_LE(mismatch(J, gradient(C, hinge.bodies)), tolerance / length);
    if (length > 0.3) {
      ASSERT_LE(mismatch(J, difference(C, hinge.bodies)),
                tolerance / length + 100 * difference_tolerance);
      ++checked;
    }
  }
  EXPECT_GT(checked, 1000);
}

TYPED_TEST(Wedge, AngleIsDefiniteAndItsRowAUnitVectorAlongTheAxis) {
  using T = TypeParam;
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const Vector3<T> w = random.unit().cast<T>(), reference = random.unit().cast<T>();
    const Vector3<T> zero = Vector3<T>::Zero();
    for (const T sign : {T(1), T(-1)}) {
      const auto to = equations::angle_about<T>(w, reference, Vector3<T>(sign * w));
      ASSERT_EQ(to.length, T(0));
      ASSERT_EQ(to.angle(), T(0));
      ASSERT_LE(std::abs(double(to.unit.norm()) - 1), this->kTolerance);
      ASSERT_LE(std::abs(double(to.unit.dot(w))), this->kTolerance);
      // Just off the axis, on the side of the reference, it is the same row.
      const Vector3<T> side = cross(cross(w, reference), w) / cross(w, reference).norm();
      const auto near = equations::angle_about<T>(
          w, reference, Vector3<T>(sign * w + T(10) * std::sqrt(T(this->kEpsilon)) * side));
      ASSERT_LE(mismatch(near.unit, to.unit), T(50) * std::sqrt(T(this->kEpsilon)));
    }
    ASSERT_TRUE(equations::angle_about<T>(w, w, w).unit.allFinite());
    ASSERT_TRUE(equations::angle_about<T>(w, w, reference).unit.allFinite());
    ASSERT_EQ(equations::angle_about<T>(w, zero, reference).angle(), T(0));
    ASSERT_TRUE(equations::angle_about<T>(zero, reference, w).unit.allFinite());
    ASSERT_TRUE(equations::angle_about<T>(zero, zero, zero).unit.allFinite());
  }
  // Half a turn is +pi, whatever the sign of its zero.
  const Vector3<T> z = Vector3<T>::Unit(2), x = Vector3<T>::Unit(0);
  EXPECT_EQ(equations::angle_about<T>(z, x, Vector3<T>(T(-1), T(-0.0), T(0))).angle(), T(pi));
  EXPECT_EQ(equations::angle_about<T>(z, x, Vector3<T>(T(-1), T(0.0), T(0))).angle(), T(pi));
}

// --- planes --------------------------------------------------------------------------------------

TYPED_TEST(Wedge, PlaneRowIsTheGradientWithTheNormalFixedInBodyA) {
  using T = TypeParam;
  for (const Case& at : cases()) {
    const Vector local = equations::wedge<double>(Vector::Unit(2), at.reference, -0.4, 1.1).n_max;
    const auto C = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      const auto frame = equations::product(bodies.q_a, constant<S>(at.hinge.f_a));
      const auto n = equations::rotate(frame, constant<S>(local));
      return S(n.dot(axis_b(at.hinge, bodies, 0)));
    };
    const auto planes = equations::wedge<T>(at.hinge.axis_a(2).cast<T>(),
                                            world_reference(at).cast<T>(), T(-0.4), T(1.1));
    const auto row = equations::wedge_row<T>(planes.n_max, at.hinge.axis_b(0).cast<T>());
    // c_a is within 18 degrees of w at worst: its side of w keeps a third of the digits' length.
    const double tolerance = this->kTolerance / std::hypot(at.reference.x(), at.reference.y());
    const Velocities J = angular_row(row.J_b);
    ASSERT_LE(std::abs(double(row.C) - C(at.hinge.bodies)), tolerance);
    ASSERT_LE(mismatch(J, gradient(C, at.hinge.bodies)), tolerance);
    ASSERT_LE(mismatch(J, difference(C, at.hinge.bodies)), tolerance + difference_tolerance);
  }
}

TYPED_TEST(Wedge, PlaneDistanceIsTheShortestTurnAndItsRowTheGradient) {
  using T = TypeParam;
  for (const Case& at : cases()) {
    const Vector local = equations::wedge<double>(Vector::Unit(2), at.reference, -0.4, 1.1).n_max;
    const auto C = [&](const auto& bodies) {
      using std::atan2;
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      // By the components in the plane and across: what is left of c_b without that along n.
      const auto frame = equations::product(bodies.q_a, constant<S>(at.hinge.f_a));
      const Vector3<S> n = equations::rotate(frame, constant<S>(local));
      const Vector3<S> c_b = axis_b(at.hinge, bodies, 0);
      const S up = n.dot(c_b);
      const Vector3<S> flat = c_b - up * n;
      using std::sqrt;
      return S(atan2(up, S(sqrt(flat.dot(flat)))));
    };
    const auto planes = equations::wedge<T>(at.hinge.axis_a(2).cast<T>(),
                                            world_reference(at).cast<T>(), T(-0.4), T(1.1));
    const Vector3<T> c_b = at.hinge.axis_b(0).cast<T>(), w = at.hinge.axis_a(2).cast<T>();
    const auto row = equations::plane_distance<T>(equations::wedge_row<T>(planes.n_max, c_b), w);
    const double length = double(cross(c_b, planes.n_max).norm());
    if (length < 0.01) continue;
    // As the plane's row, and over the length of what it is made unit with.
    const double tolerance =
        this->kTolerance / std::hypot(at.reference.x(), at.reference.y()) / length;
    ASSERT_NO_FATAL_FAILURE(expectUnitRow(row, C, at.hinge.bodies, tolerance, length));
  }
  // Along the normal every way is as short.
  const Vector3<T> x = Vector3<T>::Unit(0), z = Vector3<T>::Unit(2);
  for (const T sign : {T(1), T(-1)}) {
    const auto row =
        equations::plane_distance<T>(equations::wedge_row<T>(x, Vector3<T>(sign * x)), z);
    EXPECT_EQ(row.C, sign * T(pi / 2));
    EXPECT_EQ(row.J_b, z);
  }
}

TYPED_TEST(Wedge, EdgeDistanceIsTheTurnToItsNearerEndAndItsRowTheGradient) {
  using T = TypeParam;
  for (const Case& at : cases()) {
    const auto C = [&](const auto& bodies) {
      using std::atan2;
      using std::sqrt;
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      const S along = axis_a(at.hinge, bodies, 2).dot(axis_b(at.hinge, bodies, 0));
      const S across = sqrt(S(1) - along * along);
      return along < S(0) ? S(-atan2(across, S(-along))) : S(-atan2(across, along));
    };
    const Vector3<T> c_b = at.hinge.axis_b(0).cast<T>(), w = at.hinge.axis_a(2).cast<T>();
    const auto row = equations::edge_distance<T>(w, c_b);
    const double length = double(cross(c_b, w).norm()), along = std::abs(double(c_b.dot(w)));
    if (length < 0.01 || along < 0.01) continue;
    const double tolerance = this->kTolerance / (length * length);
    ASSERT_NO_FATAL_FAILURE(expectUnitRow(row, C, at.hinge.bodies, tolerance, length));
  }
}

TYPED_TEST(Wedge, BehindTheEdgeIsWhatIsAQuarterTurnFromBothSides) {
  using T = TypeParam;
  const Vector3<T> w = Vector3<T>::Unit(2);
  const auto wedge = equations::wedge<T>(w, Vector3<T>::Unit(0), T(-0.4), T(1.1));
  for (double angle = -pi; angle < pi; angle += 0.01) {
    const Vector3<T> c_b(T(std::cos(angle)), T(std::sin(angle)), T(0.3));
    const bool behind = std::cos(angle + 0.4) < 0 && std::cos(angle - 1.1) < 0;
    EXPECT_EQ(equations::behind_edge<T>(wedge, w, c_b), behind) << angle;
  }
}

TYPED_TEST(Wedge, NormalsAreUnitNormalToTheAxisAndAtTheLimits) {
  using T = TypeParam;
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const Vector w = random.unit();
    Vector c_a = random.unit();
    const Vector across = c_a - c_a.dot(w) * w;
    if (across.norm() < 0.2) continue;
    const double low = random.uniform(-pi, pi), high = low + random.uniform(0, 2 * pi);
    const auto planes = equations::wedge<T>(w.cast<T>(), c_a.cast<T>(), T(low), T(high));
    const Vector u = across / across.norm(), v = cross(w, u);
    const auto at = [&](double psi) { return Vector(std::cos(psi) * u + std::sin(psi) * v); };
    const double tolerance = this->kTolerance / across.norm();
    ASSERT_LE(mismatch(planes.n_min.template cast<double>(), at(low + pi / 2)), tolerance);
    ASSERT_LE(mismatch(planes.n_max.template cast<double>(), at(high - pi / 2)), tolerance);
    ASSERT_LE(mismatch(planes.middle.template cast<double>(), at((low + high) / 2)), tolerance);
    // The document's extra plane in general.
    const Vector sum = (planes.n_min + planes.n_max).template cast<double>();
    if (sum.norm() > 0.1) {
      ASSERT_LE(mismatch(planes.middle.template cast<double>(), Vector(sum / sum.norm())),
                20 * tolerance);
    }
  }
  const Vector3<T> z = Vector3<T>::Unit(2), zero = Vector3<T>::Zero();
  for (const Vector3<T>& c_a : {z, zero}) {
    const auto planes = equations::wedge<T>(z, c_a, T(-1), T(2));
    EXPECT_TRUE(planes.n_min.allFinite() && planes.n_max.allFinite() && planes.middle.allFinite());
  }
}

// --- who is inside -------------------------------------------------------------------------------

TYPED_TEST(Wedge, ClassificationHasNoErrorsByPlanesNorByTheAngle) {
  // c_b at psi about w and at any height over it; limits at any place, 0 between them or not. Left
  // out: within 100 epsilon of a side as a distance on the sphere, over what c_a has across w.
  using T = TypeParam;
  Random random(4);
  int wrong_planes = 0, wrong_nearer = 0, wrong_angle = 0, counted = 0, acute = 0, obtuse = 0;
  int insides = 0;
  for (int i = 0; i < 100000; ++i) {
    const double total = i % 3 ? random.uniform(0, 2 * pi) : random.uniform(0, pi / 2);
    const double low = random.uniform(-2 * pi, pi), high = low + total;
    const double tilt = random.uniform(0.3, pi - 0.3), zero = random.uniform(-pi, pi);
    const double psi = random.uniform(-pi, pi), height = random.uniform(0, pi);
    const Turn q_a = random.turn();
    const auto direction = [&](double about, double from_w) {
      const Vector local(std::sin(from_w) * std::cos(about), std::sin(from_w) * std::sin(about),
                         std::cos(from_w));
      return Vector3<T>(equations::rotate(q_a, local).template cast<T>());
    };
    const Vector3<T> w = direction(0, 0), c_a = direction(zero, tilt),
                     c_b = direction(zero + psi, height);
    // From the middle of the wedge.
    const double off = std::abs(std::remainder(psi - (low + high) / 2, 2 * pi));
    const bool inside = off <= total / 2;
    const double margin = 100 * this->kEpsilon / std::sin(tilt);
    if (std::abs(off - total / 2) * std::sin(height) < margin) continue;
    if (off > pi - 1e-3) continue;  // opposite the middle both planes are as near
    if (std::abs(off - (pi - total / 2)) * std::sin(height) < margin) continue;
    if (off * std::sin(height) < margin) continue;
    ++counted;
    insides += inside;
    acute += total < pi / 2;
    obtuse += total > pi;
    const auto planes = equations::wedge<T>(w, c_a, T(low), T(high));
    const bool min = equations::wedge_row(planes.n_min, c_b).C >= 0;
    const bool max = equations::wedge_row(planes.n_max, c_b).C >= 0;
    if (total <= pi) wrong_planes += (min && max) != inside;
    const auto& nearer = equations::nearer_plane(planes, w, c_b);
    wrong_nearer += (equations::wedge_row(nearer, c_b).C >= 0) != inside;
    const auto to = equations::angle_about<T>(w, planes.middle, c_b);
    wrong_angle += (std::abs(to.angle()) <= T(total / 2)) != inside;
    // Behind both planes is behind the extra one.
    if (total < pi && !min && !max) {
      ASSERT_LT(double(equations::wedge_row(planes.middle, c_b).C), 0);
    }
  }
  EXPECT_EQ(wrong_planes, 0);
  EXPECT_EQ(wrong_nearer, 0);
  EXPECT_EQ(wrong_angle, 0);
  EXPECT_GT(counted, 95000);
  EXPECT_GT(acute, 30000);
  EXPECT_GT(obtuse, 30000);
  EXPECT_GT(insides, 30000);
}

// --- the angular limit ---------------------------------------------------------------------------

TYPED_TEST(Wedge, AngularLimitIsTheDocumentsAndExactWithoutTilt) {
  using T = TypeParam;
  for (const Hinge& hinge : hinges({0, 1e-8, -1}, {0, 1})) {
    const double phi = 0.3;
    const equations::Basis<T> frame{hinge.axis_a(0).cast<T>(), hinge.axis_a(1).cast<T>(),
                                    hinge.axis_a(2).cast<T>()};
    const Vector3<T> a_b = hinge.axis_b(0).cast<T>();
    const auto row = equations::angular_limit_row<T>(frame, a_b, T(phi));
    const Case at{hinge, Vector::Unit(0)};
    const double theta = angle(at, hinge.bodies);
    ASSERT_LE(std::abs(std::remainder(double(row.C) + phi - theta, 2 * pi)),
              this->kTolerance / cross(hinge.axis_a(2), hinge.axis_b(0)).norm());
    ASSERT_EQ(row.J_b, frame.c);
    if (hinge.swing == 0) {
      const auto C = [&](const auto& bodies) { return angle(at, bodies, theta); };
      ASSERT_LE(mismatch(angular_row(row.J_b), gradient(C, hinge.bodies)), this->kTolerance);
      ASSERT_LE(mismatch(angular_row(row.J_b), difference(C, hinge.bodies)),
                this->kTolerance + difference_tolerance);
    }
  }
}

}  // namespace
