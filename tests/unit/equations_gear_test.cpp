// The rotation of a body about an axis of its own, as a gear counts it: how it changes with the velocity of the body, against automatic
// differentiation and central differences, and what becomes of it where the axis goes round.
#include <gtest/gtest.h>
#include <pintle/equations/gear.h>

#include <cmath>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;

// Body b, its axis n and a direction v across that, in its frame; and where its count stands: x across the axis, in the world.
struct Counted {
  Bodies<double> bodies;
  Vector n, v, n_last, x;

  // The angle at other poses of the body.
  template <class T>
  T angle(const Bodies<T>& at) const {
    const Vector3<T> now = equations::rotate(at.q_b, constant<T>(n));
    const Vector3<T> carried = equations::carried<T>(constant<T>(x), constant<T>(n_last), now);
    return equations::angle_against<T>(carried, now, equations::rotate(at.q_b, constant<T>(v)));
  }
};

// After the axis has gone by `swing` from where it was counted last, at the angle `th`.
Counted make(Random& random, double swing, double th) {
  Counted of;
  of.bodies = {random.vector(), random.turn(), random.vector(), random.turn()};
  of.n = random.unit();
  of.v = pintle::any_tangent(of.n);
  const Vector n = equations::rotate(of.bodies.q_b, of.n),
               v = equations::rotate(of.bodies.q_b, of.v);
  const Vector across = equations::rotate(equations::rotation<double>(n, random.uniform(-3, 3)), v);
  of.n_last = equations::rotate(equations::rotation<double>(across, swing), n);
  // v is at th from x, where x is carried to n.
  const Vector x = equations::rotate(equations::rotation<double>(n, -th), v);
  of.x = equations::carried<double>(x, n, of.n_last);
  return of;
}

TEST(GearEquations, TheCountGoesWithTheVelocityAboutTheAxis) {
  Random random(1);
  for (const double th : {0., 1e-8, 1., -2., 3.1}) {
    const Counted of = make(random, 0, th);
    EXPECT_NEAR(of.angle(of.bodies), th, kRight);
    Velocities expected = Velocities::Zero();
    expected.segment<3>(9) = equations::rotate(of.bodies.q_b, of.n);
    const auto C = [&](const auto& bodies) { return of.angle(bodies); };
    EXPECT_LT((gradient(C, of.bodies) - expected).norm(), kRight) << th;
    EXPECT_LT((difference(C, of.bodies) - expected).norm(), difference_tolerance) << th;
  }
}

TEST(GearEquations, ADirectionIsCarriedWithoutARotationAboutTheAxis) {
  Random random(2);
  for (const double swing : {0., 1e-8, 0.5, 2., 3.1})
    for (int i = 0; i < 20; ++i) {
      const Vector n = random.unit(), x = pintle::any_tangent(n);
      const Vector about =
          equations::rotate(equations::rotation<double>(n, random.uniform(-3, 3)), x);
      const Turn turn = equations::rotation<double>(about, swing);
      const Vector to = equations::rotate(turn, n);
      EXPECT_LT((equations::carried<double>(x, n, to) - equations::rotate(turn, x)).norm(),
                20 * kRight * 2 / (1 + std::cos(swing)))
          << swing;
    }
}

// An axis that turns over has no smallest way: any direction across it will do, if it is one.
TEST(GearEquations, AnAxisThatTurnsOverLeavesAUnitVectorAcrossIt) {
  const Vector n(0, 0, 1), x(1, 0, 0);
  const Vector carried = equations::carried<double>(x, n, -n);
  EXPECT_NEAR(carried.norm(), 1, kRight);
  EXPECT_NEAR(carried.dot(n), 0, kRight);
}

// An axis that is taken round a cone of half angle h comes back with what Bullet's rates add up to: the solid angle, 2 pi (1 - cos h).
TEST(GearEquations, AnAxisThatGoesRoundAConeCountsItsSolidAngle) {
  const double half = 0.7;
  const int steps = 2000;
  const auto axis = [&](int i) {
    const double phi = 2 * pi * i / steps;
    return Vector(std::sin(half) * std::cos(phi), std::sin(half) * std::sin(phi), std::cos(half));
  };
  const Vector start = pintle::any_tangent(axis(0));
  Vector x = start;
  for (int i = 0; i < steps; ++i) x = equations::carried<double>(x, axis(i), axis(i + 1));
  const double angle = equations::angle_against<double>(start, axis(0), x);
  // Chords are shorter than the circle by (2 pi / steps)^2.
  EXPECT_NEAR(std::remainder(angle - 2 * pi * (1 - std::cos(half)), 2 * pi), 0, 1e-5);
}

}  // namespace
