// Euler angles of all six orders: that they make the rotation, their rows against automatic differentiation and central differences,
// on both sides of the pole.
#include <gtest/gtest.h>
#include <pintle/equations/euler_angles.h>
#include <pintle/precision.h>

#include "autodiff.h"

namespace equations_euler_angles_test {
namespace {

using namespace autodiff;
namespace equations = pintle::equations;
using equations::EulerOrder;

constexpr EulerOrder orders[] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};

Turn about(int axis, double angle) {
  return equations::rotation<double>(Vector::Unit(axis), angle);
}

// Bodies whose joint frames are turned against each other by the triple.
Hinge make(unsigned seed, const EulerOrder& order, const Vector& t) {
  using equations::product;
  Hinge hinge = make_hinge(seed, 0, 0, 0, 1);
  const Turn p =
      product(product(about(order.last, t[order.last]), about(order.middle, t[order.middle])),
              about(order.first, t[order.first]));
  hinge.bodies.q_b = product(product(hinge.frame_a(), p), equations::conjugate(hinge.f_b));
  return hinge;
}

template <class T>
equations::EulerAxes<T> axesOf(const Hinge& hinge, const EulerOrder& order) {
  const auto a = [&](int n) -> Vector3<T> { return hinge.axis_a(n).template cast<T>(); };
  const auto b = [&](int n) -> Vector3<T> { return hinge.axis_b(n).template cast<T>(); };
  return {a(order.first),  a(order.middle), a(order.last),  b(order.first),
          b(order.middle), b(order.last),   T(order.sign())};
}

// The middle angles, each well inside of a side: how near to the pole says what rounding does.
constexpr double middles[] = {0, 1e-8, 0.7, -1.2, 1.5, -1.5, 1.7, pi - 0.2, 0.1 - pi, -2.5};

template <class T>
class EulerAngles : public testing::Test {};
using Scalars = testing::Types<double, pintle::Scalar>;
TYPED_TEST_SUITE(EulerAngles, Scalars);

template <class Function>
void forEach(const Function& function) {
  unsigned seed = 0;
  for (const EulerOrder& order : orders)
    for (const double middle : middles)
      for (int n = 0; n < 10; ++n) {
        Random random(++seed);
        Vector t(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3));
        t[order.middle] = middle;
        SCOPED_TRACE(testing::Message()
                     << order.first << order.middle << order.last << ", " << t.transpose());
        function(make(seed, order, t), order, t);
      }
}

TYPED_TEST(EulerAngles, AreThoseThatTheRotationIsMadeOf) {
  using T = TypeParam;
  forEach([](const Hinge& hinge, const EulerOrder& order, const Vector& t) {
    const T side = std::cos(t[order.middle]) < 0 ? T(-1) : T(1);
    const auto found = equations::euler_angles(axesOf<T>(hinge, order), side);
    const double tolerance =
        40 * double(std::numeric_limits<T>::epsilon()) / std::abs(std::cos(t[order.middle]));
    const auto expect = [&](T x, T y, double angle) {
      EXPECT_NEAR(std::remainder(std::atan2(double(y), double(x)) - angle, 2 * pi), 0, tolerance);
    };
    expect(found.x_i, found.y_i, t[order.first]);
    expect(found.x_j, found.y_j, t[order.middle]);
    expect(found.x_k, found.y_k, t[order.last]);
  });
}

TYPED_TEST(EulerAngles, RowsAreTheGradient) {
  using T = TypeParam;
  forEach([](const Hinge& hinge, const EulerOrder& order, const Vector& t) {
    const double side = std::cos(t[order.middle]) < 0 ? -1 : 1,
                 c = std::abs(std::cos(t[order.middle]));
    const auto rows = equations::euler_rows(axesOf<T>(hinge, order), T(side));
    for (int n = 0; n < 3; ++n) {
      const auto angle = [&](const auto& bodies) {
        using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
        const auto a = [&](int i) { return axis_a(hinge, bodies, i); };
        const auto b = [&](int i) { return axis_b(hinge, bodies, i); };
        const equations::EulerAxes<S> axes{a(order.first), a(order.middle), a(order.last),
                                           b(order.first), b(order.middle), b(order.last),
                                           S(order.sign())};
        const auto at = equations::euler_angles(axes, S(side));
        using std::atan2;
        return n == 0   ? S(atan2(at.y_i, at.x_i))
               : n == 1 ? S(atan2(at.y_j, at.x_j))
                        : S(atan2(at.y_k, at.x_k));
      };
      const Vector3<T> row = n == 0 ? rows.i : n == 1 ? rows.j : rows.k;
      const Velocities exact = gradient(angle, hinge.bodies);
      const double tolerance = 60 * double(std::numeric_limits<T>::epsilon()) / (c * c * c);
      EXPECT_LE(mismatch(angular_row(row), exact), tolerance) << n;
      if (c > 0.3) {
        const double close = tolerance + 300 * difference_tolerance;
        EXPECT_LE(mismatch(angular_row(row), difference(angle, hinge.bodies)), close) << n;
      }
    }
  });
}

}  // namespace
}  // namespace equations_euler_angles_test
