// The cones. The circular one in both forms against automatic differentiation; the distance from an
// ellipse against one found by bisection; the elliptic cone's row against the derivative of that;
// and who is inside, against the poses' own making and against Bullet's cone twist joint.
#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <gtest/gtest.h>
#include <pintle/equations/cone_twist.h>
#include <pintle/precision.h>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;

template <class T>
class Cone : public testing::Test {
 public:
  static constexpr double kEpsilon = double(std::numeric_limits<T>::epsilon());
  static constexpr double kTolerance = 20 * kEpsilon;

  static equations::Swing<T> swing(const Hinge& hinge) {
    return equations::swing<T>(hinge.axis_a(2).cast<T>(), hinge.axis_b(2).cast<T>());
  }
};
using Scalars = testing::Types<double, pintle::Scalar>;
TYPED_TEST_SUITE(Cone, Scalars);

double loss(double swing) { return 1 + (swing > 1 ? swing / std::max(std::sin(swing), 1e-5) : 0); }

// --- the circular cone ---------------------------------------------------------------------------

TYPED_TEST(Cone, DocumentsRowIsTheGradientAndTheSineOfTheSwingLong) {
  using T = TypeParam;
  for (const Hinge& hinge : hinges({0, 1e-8, -pi, pi - 1e-8, pi}, {0, 1})) {
    const double phi = 0.7;
    const auto C = [&](const auto& bodies) {
      const auto dot = axis_a(hinge, bodies, 2).dot(axis_b(hinge, bodies, 2));
      using S = std::decay_t<decltype(dot)>;
      return S(dot - S(std::cos(phi)));
    };
    const auto row =
        equations::cone_dot_row<T>(hinge.axis_a(2).cast<T>(), hinge.axis_b(2).cast<T>(), T(phi));
    const Velocities J = angular_row(row.J_b);
    ASSERT_LE(std::abs(double(row.C) - C(hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(J, gradient(C, hinge.bodies)), this->kTolerance);
    ASSERT_LE(mismatch(J, difference(C, hinge.bodies)), this->kTolerance + difference_tolerance);
    ASSERT_LE(std::abs(double(row.J_b.norm()) - std::abs(std::sin(hinge.swing))), this->kTolerance);
  }
}

TYPED_TEST(Cone, ConditionedRowIsTheGradientAndAUnitVectorAtAnySwing) {
  using T = TypeParam;
  for (const Hinge& hinge : hinges({0, 1e-8, 1e-3, -pi, 3, pi - 1e-4, pi - 1e-8, pi}, {0, 1})) {
    const double phi = 0.7;
    const auto C = [&](const auto& bodies) {
      using std::atan2;
      using std::sqrt;
      const auto u = axis_a(hinge, bodies, 2), v = axis_b(hinge, bodies, 2), x = cross(u, v);
      using S = std::decay_t<decltype(u[0])>;
      const S sine = sqrt(x.dot(x)), cosine = u.dot(v);
      return S(atan2(sine, cosine) - S(phi));
    };
    const Vector3<T> c_a = hinge.axis_a(2).cast<T>();
    const auto row = equations::cone_row(this->swing(hinge), c_a, T(phi));
    ASSERT_LE(std::abs(double(row.J_b.norm()) - 1), this->kTolerance);
    ASSERT_LE(std::abs(double(row.C) - (hinge.swing - phi)),
              this->kTolerance + (hinge.swing > pi - 1e-5 ? 1e-5 : 0));
    const double sine = std::sin(hinge.swing);
    if (sine < 1e-6) continue;
    // The direction keeps epsilon over the sine of its digits.
    const Velocities J = angular_row(row.J_b);
    ASSERT_LE(mismatch(J, gradient(C, hinge.bodies)), this->kTolerance / sine);
    if (sine > 0.3) {
      ASSERT_LE(mismatch(J, difference(C, hinge.bodies)),
                this->kTolerance / sine + 30 * difference_tolerance);
    }
  }
}

// --- the ellipse ---------------------------------------------------------------------------------

struct Nearest {
  double x, y, n_x, n_y, radius;  // point, outward normal, radius of curvature there
};

// Of the quarter with the semiaxes a, b, from s in it: where s - P is along the normal.
Nearest nearest(double s_x, double s_y, double a, double b) {
  double low = 0, high = pi / 2;
  for (int i = 0; i < 60; ++i) {
    const double t = (low + high) / 2, c = std::cos(t), s = std::sin(t);
    const double slope = a * s_x * s - b * s_y * c - (a * a - b * b) * s * c;
    (slope < 0 ? low : high) = t;
  }
  const double t = low, c = std::cos(t), s = std::sin(t), length = std::hypot(b * c, a * s);
  return {a * c, b * s, b * c / length, a * s / length, length * length * length / (a * b)};
}

TYPED_TEST(Cone, EllipseDistanceIsThatFromTheNearestPoint) {
  using T = TypeParam;
  Random random(1);
  double smallest = 1e9;
  for (int i = 0; i < 60000; ++i) {
    const double e_1 = 0.01 * std::exp(random.uniform(0, std::log(100 * pi)));
    const double stretch =
        i % 4 ? random.uniform(1, std::min(pi / e_1, 350.0)) : 1 + 1e-5 * (i % 3);
    const T b = T(e_1), a = T(e_1 * stretch);
    T x = T(random.uniform(0, pi)), y = T(random.uniform(0, pi));
    if (i % 3 == 0) {
      // On the boundary and near it.
      const double t = random.uniform(0, pi / 2), off = i % 2 ? 0 : random.uniform(-1e-3, 1e-2);
      x = T(double(a) * std::cos(t) * (1 + off));
      y = T(double(b) * std::sin(t) * (1 + off));
    }
    const Nearest P = nearest(double(x), double(y), double(a), double(b));
    const double g = P.n_x * (double(x) - P.x) + P.n_y * (double(y) - P.y);
    const auto found = equations::ellipse_distance(x, y, a, b);
    const double size = std::hypot(double(x), double(y)) + double(a);
    ASSERT_LE(std::abs(double(found.distance) - g), this->kTolerance * size)
        << a << " " << b << " " << x << " " << y;
    ASSERT_LE(std::abs(double(found.n_0 * found.n_0 + found.n_1 * found.n_1) - 1),
              this->kTolerance);
    // The normal turns by 1/(R + g) per unit of length. Where it has no direction nor has the row.
    const double bend = P.radius + g;
    smallest = std::min(smallest, bend);
    if (bend < 1e-4) continue;
    ASSERT_LE(std::abs(double(found.n_0) - P.n_x), this->kTolerance * (1 + size / bend))
        << a << " " << b << " " << x << " " << y;
    ASSERT_LE(std::abs(double(found.n_1) - P.n_y), this->kTolerance * (1 + size / bend));
  }
  EXPECT_LT(smallest, 1e-3);
}

TYPED_TEST(Cone, EllipseDistanceIsFiniteAndDefiniteOnTheAxes) {
  using T = TypeParam;
  for (const double a : {0.01, 0.05, 1.5, pi}) {
    for (const double b : {0.01, 0.05, 1.5, pi}) {
      if (b > a) continue;
      for (const double at : {0.0, 1e-30, 1e-8, 0.3, 0.999, 1.0, 1.001, 2.0, 300.0}) {
        const auto along = equations::ellipse_distance(T(at * a), T(0), T(a), T(b));
        const auto across = equations::ellipse_distance(T(0), T(at * b), T(a), T(b));
        for (const auto& found : {along, across}) {
          ASSERT_LE(std::abs(double(found.n_0 * found.n_0 + found.n_1 * found.n_1) - 1),
                    this->kTolerance);
        }
        const double tolerance = this->kTolerance * a * (1 + at);
        ASSERT_LE(std::abs(double(across.distance) - (at - 1) * b), tolerance);
        // Beyond the centre of curvature the vertex is nearest, before it both sides are.
        const double x = at * a, focus = (a * a - b * b) / a;
        const double g = x >= focus ? x - a : -b * std::sqrt(1 - x * x / (a * a - b * b));
        ASSERT_LE(std::abs(double(along.distance) - g), tolerance) << a << " " << b << " " << at;
      }
    }
  }
}

// --- the elliptic cone ---------------------------------------------------------------------------

template <class T>
Vector3<T> logarithm(const Quaternion<T>& q) {
  using std::atan2;
  using std::sqrt;
  const T sine2 = q.v.dot(q.v);
  if (sine2 < T(1e-6)) {
    const T t2 = sine2 / (q.w * q.w);
    return q.v * T(T(2) / q.w * (T(1) - t2 / T(3) + t2 * t2 / T(5)));
  }
  const T sine = sqrt(sine2);
  return q.v * T(T(2) * atan2(sine, q.w) / sine);
}

// sigma in the frame of body a.
template <class T>
Vector3<T> sigma(const Hinge& hinge, const Bodies<T>& bodies) {
  return logarithm(
      equations::swing_twist<T>(turn(hinge, bodies), Vector3<T>(T(0), T(0), T(1))).swing);
}

using Spans = equations::SwingSpans<double>;
const std::vector<Spans> kSpans = {
    {0.5, 0.5, 0.5, 0.5}, {0.05, 0.05, 1.5, 1.5}, {1.5, 1.5, 0.05, 0.05}, {0.3, 0.9, 1.2, 0.6},
    {0.01, pi, 2, 0.02},  {0.01, 0.01, pi, pi},   {pi, pi, pi, pi}};

double along(const Spans& spans, int axis, double s) {
  return axis == 0 ? (s < 0 ? spans.below_1 : spans.above_1)
                   : (s < 0 ? spans.below_2 : spans.above_2);
}

template <class T>
equations::AngularRow<T> elliptic(const Hinge& hinge, const Spans& spans) {
  const Vector3<T> c_a = hinge.axis_a(2).cast<T>(), c_b = hinge.axis_b(2).cast<T>();
  return equations::elliptic_cone_row<T>(
      equations::swing(c_a, c_b), c_a, hinge.axis_a(0).cast<T>(), hinge.axis_a(1).cast<T>(),
      {T(spans.above_1), T(spans.below_1), T(spans.above_2), T(spans.below_2)});
}

TYPED_TEST(Cone, EllipticRowIsTheGradientOfTheDistance) {
  using T = TypeParam;
  int checked = 0, i = 0;
  for (const Hinge& hinge : hinges({-0.1, -0.5, -1.6, -pi, pi - 1e-3}, {0, 1})) {
    const Spans& spans = kSpans[i++ % kSpans.size()];
    const Vector s = sigma(hinge, hinge.bodies);
    const double sign_x = s.x() < 0 ? -1 : 1, sign_y = s.y() < 0 ? -1 : 1;
    const double a = along(spans, 0, s.x()), b = along(spans, 1, s.y());
    const Nearest P = nearest(sign_x * s.x(), sign_y * s.y(), a, b);
    const double n_x = sign_x * P.n_x, n_y = sign_y * P.n_y;
    // By the envelope of the distances from all points: P stands still.
    const auto C = [&](const auto& bodies) {
      const auto v = sigma(hinge, bodies);
      using S = std::decay_t<decltype(v[0])>;
      return S(S(n_x) * (v[0] - S(sign_x * P.x)) + S(n_y) * (v[1] - S(sign_y * P.y)));
    };
    const auto row = elliptic<T>(hinge, spans);
    const double lost = loss(hinge.swing), g = C(hinge.bodies), size = hinge.swing + a + b;
    // As much again for the swing's own components.
    ASSERT_LE(std::abs(double(row.C) - g), 2 * this->kTolerance * size * lost);
    const double bend = P.radius + g;
    if (bend < 1e-3) continue;
    const double tolerance = this->kTolerance * lost * (lost + lost * size / bend);
    ASSERT_LE(mismatch(angular_row(row.J_b), gradient(C, hinge.bodies)), tolerance);
    // The distance itself, and not only its envelope.
    const auto distance = [&](const Bodies<double>& bodies) {
      const Vector v = sigma(hinge, bodies);
      const Nearest Q = nearest(sign_x * v.x(), sign_y * v.y(), a, b);
      return Q.n_x * (sign_x * v.x() - Q.x) + Q.n_y * (sign_y * v.y() - Q.y);
    };
    if (hinge.swing < 2.5 && bend > 0.1 && std::abs(s.x()) > 1e-3 && std::abs(s.y()) > 1e-3) {
      ASSERT_LE(mismatch(angular_row(row.J_b), difference(distance, hinge.bodies)),
                tolerance + 1e-7);
      ++checked;
    }
    const double length = double(row.J_b.norm());
    ASSERT_GE(length, 1 - tolerance);
    ASSERT_LE(length, hinge.swing / std::sin(hinge.swing) + tolerance);
  }
  EXPECT_GT(checked, 500);
}

TYPED_TEST(Cone, EllipticRowIsFiniteAndNotZeroAtNoSwingAndAtHalfATurn) {
  using T = TypeParam;
  for (const Spans& spans : kSpans) {
    for (const Hinge& hinge : hinges({0, 1e-30, 1e-12, pi - 1e-8, pi}, {0}, 40)) {
      const auto row = elliptic<T>(hinge, spans);
      ASSERT_TRUE(row.J_b.allFinite());
      ASSERT_TRUE(std::isfinite(row.C));
      if (hinge.swing < 1) {
        ASSERT_LE(std::abs(double(row.J_b.norm()) - 1), this->kTolerance);
      }
    }
  }
}

TYPED_TEST(Cone, EllipticCoordinateRisesOutwardsThroughTheBoundary) {
  using T = TypeParam;
  for (const Spans& spans : kSpans) {
    for (int k = 0; k < 40; ++k) {
      const double direction = 0.05 + 2 * pi * k / 40, x = std::cos(direction),
                   y = std::sin(direction);
      const double r = 1 / std::hypot(x / along(spans, 0, x), y / along(spans, 1, y));
      double last = -1e9;
      for (double at = 0.5; at < 1.5; at += 0.05) {
        if (r * at > 3.1) break;
        const auto swing = equations::swing<T>(
            Vector3<T>::Unit(2),
            equations::rotate(equations::rotation<T>(Vector3<T>(T(x), T(y), T(0)), T(r * at)),
                              Vector3<T>(Vector3<T>::Unit(2))));
        const auto row = equations::elliptic_cone_row<T>(
            swing, Vector3<T>::Unit(2), Vector3<T>::Unit(0), Vector3<T>::Unit(1),
            {T(spans.above_1), T(spans.below_1), T(spans.above_2), T(spans.below_2)});
        ASSERT_GT(double(row.C), last) << direction << " " << at;
        last = double(row.C);
      }
    }
  }
}

// --- who is inside -------------------------------------------------------------------------------

// A swing by `angle` about (x, y) of the frame of body a after a twist, anywhere in the world.
struct Pose {
  Turn q_a, q_b;
};
Pose pose(Random& random, double direction, double angle) {
  const Vector axis(std::cos(direction), std::sin(direction), 0), z = Vector::Unit(2);
  const Turn swing = equations::rotation<double>(axis, angle);
  const Turn twist = equations::rotation<double>(z, random.uniform(-pi, pi));
  Pose made;
  made.q_a = random.turn();
  made.q_b = equations::product(made.q_a, equations::product(swing, twist));
  return made;
}
template <class T>
Vector3<T> world(const Turn& at, int k) {
  return Vector3<T>(equations::rotate<double>(at, Vector::Unit(k)).template cast<T>());
}

TYPED_TEST(Cone, CircularClassificationHasNoErrors) {
  // Swings within 20 epsilon of the limit are left out; for the document's form, cosines.
  using T = TypeParam;
  Random random(21);
  int wrong = 0, wrong_document = 0, counted = 0;
  for (int i = 0; i < 100000; ++i) {
    const double phi = random.uniform(0.01, pi);
    const double angle = i % 2 ? random.uniform(0, pi) : phi + random.uniform(-1e-3, 1e-3);
    if (angle < 0 || angle > pi) continue;
    const Pose at = pose(random, random.uniform(-pi, pi), angle);
    const Vector3<T> c_a = world<T>(at.q_a, 2), c_b = world<T>(at.q_b, 2);
    const bool outside = angle > phi;
    if (std::abs(angle - phi) > this->kTolerance + (angle > pi - 1e-5 ? 1e-5 : 0)) {
      ++counted;
      wrong += (equations::cone_row(equations::swing(c_a, c_b), c_a, T(phi)).C > 0) != outside;
    }
    if (std::abs(std::cos(angle) - std::cos(phi)) > this->kTolerance) {
      wrong_document += (equations::cone_dot_row(c_a, c_b, T(phi)).C < 0) != outside;
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(wrong_document, 0);
  EXPECT_GT(counted, 90000);
}

TYPED_TEST(Cone, EllipticClassificationHasNoErrorsAgainstThePolarFormOfTheEllipse) {
  // A swing of a definite angle, about a definite axis: outside if the angle is beyond the
  // ellipse's radius in that direction. Left out: within 100 epsilon of it, over the cosine of the
  // incidence (radius over the smallest span) and of the direction's digits near half a turn.
  using T = TypeParam;
  Random random(22);
  int wrong = 0, counted = 0, outsides = 0;
  for (int i = 0; i < 100000; ++i) {
    const auto any = [&] { return 0.01 * std::exp(random.uniform(0, std::log(100 * pi))); };
    Spans spans{any(), any(), any(), any()};
    if (i % 4 == 0) spans.below_1 = spans.above_1, spans.below_2 = spans.above_2;
    const double direction = random.uniform(-pi, pi), x = std::cos(direction),
                 y = std::sin(direction);
    const double a = along(spans, 0, x), b = along(spans, 1, y);
    const double radius = 1 / std::hypot(x / a, y / b);
    const double angle = i % 2 ? random.uniform(0, pi) : radius * random.uniform(0.9, 1.1);
    if (angle > pi) continue;
    const Pose at = pose(random, direction, angle);
    const double margin =
        100 * this->kEpsilon * (1 + radius / std::min(a, b)) * loss(std::max(angle, radius));
    if (std::abs(angle - radius) < margin) continue;
    const Vector3<T> c_a = world<T>(at.q_a, 2);
    const auto row = equations::elliptic_cone_row<T>(
        equations::swing(c_a, world<T>(at.q_b, 2)), c_a, world<T>(at.q_a, 0), world<T>(at.q_a, 1),
        {T(spans.above_1), T(spans.below_1), T(spans.above_2), T(spans.below_2)});
    wrong += (row.C > 0) != (angle > radius);
    outsides += angle > radius;
    ++counted;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(counted, 85000);
  EXPECT_GT(outsides, counted / 4);
  EXPECT_LT(outsides, counted * 3 / 4);
}

// --- Bullet's ------------------------------------------------------------------------------------

btTransform bullet(const Turn& q) {
  return btTransform(
      btQuaternion(btScalar(q.v.x()), btScalar(q.v.y()), btScalar(q.v.z()), btScalar(q.w)));
}

TEST(ConeOfBullet, HasTheSameInsideForSwingAndTwist) {
  // Bullet takes its angles by an arccosine of a quaternion's w, which keeps sqrt(epsilon) of small
  // ones: left out are angles within four times that of the limit (1.4e-3 in single precision),
  // over the cosine of the incidence, and swings within 1e-2 of half a turn. Bullet's frame has the
  // twist about x, span 2 about y and span 1 about z, all in body b.
  using T = pintle::Scalar;
  const double lost = 4 * std::sqrt(double(std::numeric_limits<T>::epsilon()));
  btRigidBody a(1, nullptr, nullptr, btVector3(1, 1, 1)),
      b(1, nullptr, nullptr, btVector3(1, 1, 1));
  btConeTwistConstraint joint(a, b, btTransform::getIdentity(), btTransform::getIdentity());
  Random random(23);
  int swings = 0, wrong_swings = 0, twists = 0, wrong_twists = 0, outsides = 0;
  for (int i = 0; i < 100000; ++i) {
    const double span_1 = random.uniform(0.06, pi), span_2 = random.uniform(0.06, pi),
                 twist_span = random.uniform(0.06, pi);
    joint.setLimit(T(span_1), T(span_2), T(twist_span), 1);
    const Turn q_a = random.turn();
    const Turn swing = equations::rotation<double>(random.unit(), random.uniform(0, 2));
    const Turn q_b = i % 2 ? random.turn() : equations::product(q_a, swing);
    joint.calcAngleInfo2(bullet(q_a), bullet(q_b), btMatrix3x3::getIdentity(),
                         btMatrix3x3::getIdentity());

    const Vector3<T> c_b = world<T>(q_b, 0);
    const auto s = equations::swing(c_b, world<T>(q_a, 0));
    if (double(s.angle) > pi - 1e-2) continue;
    const auto row = equations::elliptic_cone_row<T>(s, c_b, world<T>(q_b, 1), world<T>(q_b, 2),
                                                     {T(span_2), T(span_2), T(span_1), T(span_1)});
    const double ratio = std::max(span_1, span_2) / std::min(span_1, span_2);
    if (std::abs(double(row.C)) > lost * (1 + ratio)) {
      ++swings;
      outsides += row.C > 0;
      wrong_swings += (row.C > 0) != bool(joint.getSolveSwingLimit());
    }
    const auto dot = [&](int e, int f) { return world<T>(q_a, e).dot(world<T>(q_b, f)); };
    const double th = double(
        equations::twist_angle(equations::twist<T>(dot(1, 1), dot(2, 2), dot(2, 1), dot(1, 2))));
    if (std::abs(std::abs(th) - twist_span) > lost / std::cos(double(s.angle) / 2)) {
      ++twists;
      wrong_twists += (std::abs(th) > twist_span) != bool(joint.getSolveTwistLimit());
    }
  }
  EXPECT_EQ(wrong_swings, 0);
  EXPECT_EQ(wrong_twists, 0);
  EXPECT_GT(swings, 95000);
  EXPECT_GT(twists, 95000);
  EXPECT_GT(outsides, 30000);
}

}  // namespace
