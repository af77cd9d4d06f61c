// The errata of the document in the cone, the wedge, the angular limit, the universal and the
// constant velocity joint, and in the identities that they use: each test has the printed form,
// wrong by a stated amount, next to the form that the library uses, right to rounding.
#include <gtest/gtest.h>
#include <pintle/equations/angular_limit.h>
#include <pintle/equations/cone_twist.h>
#include <pintle/equations/constant_velocity.h>
#include <pintle/equations/universal.h>
#include <pintle/equations/wedge.h>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;

// {c_a, c_b} about w: c_a normal to it, c_b at psi and at `height` from w.
struct Directions {
  Vector w, c_a, c_b;
};
Directions directions(Random& random, double psi, double height) {
  const Turn q = random.turn();
  const Vector c_b(std::sin(height) * std::cos(psi), std::sin(height) * std::sin(psi),
                   std::cos(height));
  return {equations::rotate<double>(q, Vector::Unit(2)),
          equations::rotate<double>(q, Vector::Unit(0)), equations::rotate(q, c_b)};
}

// --- 3.2.6 ---------------------------------------------------------------------------------------

TEST(ErrataLimits, Equation3_39LosesItsLengthAtNoSwingAndAtHalfATurnAndTheUnitRowDoesNot) {
  for (const double swing : {0.0, 1e-8, 1e-3, 1.0, 3.0, pi - 1e-8, pi}) {
    const Hinge hinge = make_hinge(3, 0.2, swing, 0, 1);
    const Vector c_a = hinge.axis_a(2), c_b = hinge.axis_b(2);
    const auto printed = equations::cone_dot_row(c_a, c_b, 0.5);
    const auto used = equations::cone_row(equations::swing(c_a, c_b), c_a, 0.5);
    ASSERT_LE(std::abs(printed.J_b.norm() - std::sin(swing)), kRight);
    ASSERT_LE(std::abs(used.J_b.norm() - 1), kRight);
  }
}

// --- 3.2.7 ---------------------------------------------------------------------------------------

TEST(ErrataLimits, Equation3_44IsTheMaximumsNormalOnly) {
  // Both normals as printed: who is inside a wedge of less than half a turn is wrong in more than a
  // quarter of all poses; with the minimum's the other way round, none.
  Random random(1);
  int printed = 0, used = 0;
  const int count = 20000;
  for (int i = 0; i < count; ++i) {
    const double low = random.uniform(-pi / 2, 0), high = random.uniform(0, pi / 2);
    const double psi = random.uniform(-pi, pi);
    const bool inside = psi >= low && psi <= high;
    const Directions at = directions(random, psi, random.uniform(0.1, 3));
    const auto n = [&](double phi) {
      return equations::wedge_normal(equations::wedge_side(at.w, at.c_a, phi), at.w);
    };
    printed += (at.c_b.dot(n(low)) >= 0 && at.c_b.dot(n(high)) >= 0) != inside;
    const auto planes = equations::wedge(at.w, at.c_a, low, high);
    used += (equations::wedge_row(planes.n_min, at.c_b).C >= 0 &&
             equations::wedge_row(planes.n_max, at.c_b).C >= 0) != inside;
  }
  EXPECT_GT(printed, count / 4);
  EXPECT_EQ(used, 0);
}

TEST(ErrataLimits, Section3_2_7AsksByTheReferenceWhereItNeedsTheMiddle) {
  // A wedge of 190 to 300 degrees that c_a is anywhere in, or out of: which plane is the limit.
  // With c_a within both sides by less than half a turn the printed question is right too.
  Random random(2);
  int printed = 0, printed_within = 0, used = 0, within = 0, beyond = 0;
  const int count = 20000;
  for (int i = 0; i < count; ++i) {
    const double total = random.uniform(190, 300) * pi / 180;
    const double middle = random.uniform(-pi, pi), off = random.uniform(-pi, pi);
    const double low = middle - total / 2, high = middle + total / 2;
    const bool inside = std::abs(off) <= total / 2;
    const Directions at = directions(random, middle + off, random.uniform(0.1, 3));
    const auto planes = equations::wedge(at.w, at.c_a, low, high);
    const auto is_inside = [&](const Vector& n) { return equations::wedge_row(n, at.c_b).C >= 0; };
    const Vector& asked = cross(at.c_a, at.w).dot(at.c_b) < 0 ? planes.n_max : planes.n_min;
    const bool wrong = is_inside(asked) != inside;
    if (low > -pi && low < 0 && high > 0 && high < pi) {
      printed_within += wrong;
      ++within;
    } else {
      printed += wrong;
      ++beyond;
    }
    used += is_inside(equations::nearer_plane(planes, at.w, at.c_b)) != inside;
  }
  EXPECT_GT(within, count / 10);
  EXPECT_EQ(printed_within, 0);
  EXPECT_GT(printed, beyond / 5);
  EXPECT_EQ(used, 0);
}

TEST(ErrataLimits, Section3_2_7BothPlanesAreNoWedgeBeyondHalfATurn) {
  Random random(3);
  int both = 0, used = 0;
  const int count = 10000;
  for (int i = 0; i < count; ++i) {
    const double half = random.uniform(95, 170) * pi / 180, psi = random.uniform(-pi, pi);
    const Directions at = directions(random, psi, random.uniform(0.1, 3));
    const auto planes = equations::wedge(at.w, at.c_a, -half, half);
    const bool inside = std::abs(psi) <= half;
    const auto is_inside = [&](const Vector& n) { return equations::wedge_row(n, at.c_b).C >= 0; };
    both += (is_inside(planes.n_min) && is_inside(planes.n_max)) != inside;
    used += is_inside(equations::nearer_plane(planes, at.w, at.c_b)) != inside;
  }
  EXPECT_GT(both, count * 4 / 10);
  EXPECT_EQ(used, 0);
}

TEST(ErrataLimits, Section3_2_7HasTheExtraPlanesNormalForAWedgeAboutTheReferenceOnly) {
  // Acute wedges beside c_a, or with c_a at an angle to w. The extra plane may act on poses that
  // are behind both planes and must have none of those inside behind it.
  Random random(4);
  int printed_missed = 0, printed_inside = 0, missed = 0, pushed = 0, behind = 0, insides = 0;
  for (int i = 0; i < 40000; ++i) {
    const double low = random.uniform(-pi, pi), high = low + random.uniform(0.1, pi / 2);
    const double off = i % 2 ? random.uniform(0, (high - low) / 2) : random.uniform(0, pi);
    Directions at = directions(random, (low + high) / 2 + off, random.uniform(0.1, 3));
    const double tilt = random.uniform(-1, 1);
    at.c_a = std::cos(tilt) * at.c_a + std::sin(tilt) * at.w;
    const auto planes = equations::wedge(at.w, at.c_a, low, high);
    const bool min = equations::wedge_row(planes.n_min, at.c_b).C >= 0;
    const bool max = equations::wedge_row(planes.n_max, at.c_b).C >= 0;
    if (!min && !max) {
      ++behind;
      printed_missed += at.c_b.dot(at.c_a) >= 0;
      missed += equations::wedge_row(planes.middle, at.c_b).C >= 0;
    }
    if (min && max) {
      ++insides;
      printed_inside += at.c_b.dot(at.c_a) < 0;
      pushed += equations::wedge_row(planes.middle, at.c_b).C < 0;
    }
  }
  EXPECT_GT(printed_missed, behind / 4);
  EXPECT_GT(printed_inside, insides / 4);
  EXPECT_EQ(missed, 0);
  EXPECT_EQ(pushed, 0);
}

TEST(ErrataLimits, TheAngleOfAWedgeNeedsNoReferenceNormalToItsAxis) {
  // Both arguments of atan2 by the reference itself: right only where it is normal to the axis.
  Random random(5);
  double plain = 0, used = 0;
  for (int i = 0; i < 1000; ++i) {
    const double psi = random.uniform(-3, 3), tilt = random.uniform(0.5, 1);
    Directions at = directions(random, psi, random.uniform(0.5, 2.5));
    at.c_a = std::cos(tilt) * at.c_a + std::sin(tilt) * at.w;
    const double by_reference = std::atan2(at.c_b.dot(cross(at.w, at.c_a)), at.c_b.dot(at.c_a));
    plain = greatest(plain, std::abs(std::remainder(by_reference - psi, 2 * pi)));
    used = greatest(used, std::abs(equations::angle_about(at.w, at.c_a, at.c_b).angle() - psi));
  }
  EXPECT_GT(plain, 1);
  EXPECT_LT(used, 2 * kRight);
}

// --- 3.2.8 ---------------------------------------------------------------------------------------

TEST(ErrataLimits, Equation3_47IsTheGradientOnlyWithoutTilt) {
  // Its error is the tangent of the tilt of a_b, and the exact row has none.
  for (const double tilt : {0.0, 10.0, 45.0, 80.0}) {
    for (unsigned seed = 0; seed < 50; ++seed) {
      // The x of b tilts against the xy plane of a: a swing about y.
      Hinge hinge = make_hinge(seed, 0, 0, 0, 1);
      const Turn p = equations::rotation<double>(Vector::Unit(1), tilt * pi / 180);
      hinge.bodies.q_b = equations::product(equations::product(hinge.frame_a(), p),
                                            equations::conjugate(hinge.f_b));
      const auto C = [&](const auto& bodies) {
        using std::atan2;
        const auto a_b = axis_b(hinge, bodies, 0);
        using S = std::decay_t<decltype(a_b[0])>;
        return S(atan2(S(axis_a(hinge, bodies, 1).dot(a_b)), S(axis_a(hinge, bodies, 0).dot(a_b))));
      };
      const Velocities exact = gradient(C, hinge.bodies);
      const Vector a_b = hinge.axis_b(0);
      const auto printed = equations::angular_limit_row<double>(
          {hinge.axis_a(0), hinge.axis_a(1), hinge.axis_a(2)}, a_b, 0);
      const auto used = equations::angle_about(hinge.axis_a(2), hinge.axis_a(0), a_b);
      const Vector error = printed.J_b - Vector(exact.segment<3>(9));
      ASSERT_LE(std::abs(error.norm() - std::tan(tilt * pi / 180)), 40 * kRight);
      ASSERT_LE(mismatch(angular_row(used.J_b()), exact), 40 * kRight);
    }
  }
}

// --- 3.2.9 ---------------------------------------------------------------------------------------

TEST(ErrataLimits, Section3_2_9IsSatisfiedByHalfATurnOfTwistToo) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    Hinge hinge = make_hinge(seed, 0, 0, 0, 1);
    const Turn p = equations::rotation<double>(Vector::Unit(0), pi);
    hinge.bodies.q_b =
        equations::product(equations::product(hinge.frame_a(), p), equations::conjugate(hinge.f_b));
    const auto printed = equations::universal_dot_row(hinge.axis_a(2), hinge.axis_b(1));
    const auto used =
        equations::universal_gamma_row(hinge.axis_a(2), hinge.axis_b(0), hinge.axis_b(2));
    ASSERT_LE(std::abs(printed.C), kRight);
    ASSERT_LE(std::abs(std::abs(used.C) - pi), 3 * kRight);
  }
}

TEST(ErrataLimits, Section3_2_9LosesTheLengthOfItsRowWithItsHingesTogether) {
  for (const double gamma : {0.0, 1.0, 1.5, pi / 2 - 1e-6}) {
    const Hinge hinge = make_hinge(1, 0, 0, 0, 1);
    const Vector z = hinge.axis_a(2);
    const Vector y = std::cos(gamma) * hinge.axis_a(1) + std::sin(gamma) * z;
    ASSERT_LE(std::abs(equations::universal_dot_row(z, y).J_b.norm() - std::cos(gamma)), kRight);
    ASSERT_LE(std::abs(equations::universal_row(z, y).J_b.norm() - 1), kRight);
  }
}

// --- 3.2.10 --------------------------------------------------------------------------------------

// Steps along the row, a tenth of the error each; how much of twist and of the real part is left.
template <class Row>
Turn settle(Hinge hinge, const Row& row_of) {
  for (int i = 0; i < 300; ++i) {
    const equations::AngularRow<double> row = row_of(hinge);
    Velocities v = Velocities::Zero();
    v.segment<3>(9) = -0.1 * row.C * row.J_b;
    hinge.bodies = moved(hinge.bodies, v, 1);
  }
  return turn(hinge, hinge.bodies);
}

TEST(ErrataLimits, Equation3_48IsZeroWhereTheRealPartIsAndHasPosesStickThere) {
  Random random(6);
  int stuck = 0, used_stuck = 0;
  const int count = 200;
  for (int i = 0; i < count; ++i) {
    Hinge hinge = make_hinge(unsigned(i), 0, 0, 0, 1);
    hinge.bodies.q_b = random.turn();
    const Turn printed = settle(hinge, [](const Hinge& at) {
      return equations::constant_velocity_dot_row<double>({at.axis_a(1), at.axis_a(2)},
                                                          {at.axis_b(1), at.axis_b(2)});
    });
    const Turn used = settle(hinge, [](const Hinge& at) {
      return equations::constant_velocity_row<double>(turn(at, at.bodies), matrix(at.frame_a()),
                                                      Vector::Unit(0));
    });
    stuck += std::abs(printed.v.x()) > 0.1;
    used_stuck += std::abs(used.v.x()) > 1e-9;
  }
  EXPECT_GT(stuck, count * 4 / 10);
  EXPECT_EQ(used_stuck, 0);
}

TEST(ErrataLimits, Equation3_49LosesItsLengthAsTheShaftBends) {
  for (const double degrees : {0.0, 90.0, 170.0, 179.0}) {
    const double bend = degrees * pi / 180;
    Hinge hinge = make_hinge(2, 0, 0, 0, 1);
    const Turn p = equations::rotation<double>(Vector::Unit(1), bend);
    hinge.bodies.q_b =
        equations::product(equations::product(hinge.frame_a(), p), equations::conjugate(hinge.f_b));
    const auto printed = equations::constant_velocity_dot_row<double>(
        {hinge.axis_a(1), hinge.axis_a(2)}, {hinge.axis_b(1), hinge.axis_b(2)});
    const auto used = equations::constant_velocity_row<double>(
        turn(hinge, hinge.bodies), matrix(hinge.frame_a()), Vector::Unit(0));
    ASSERT_LE(std::abs(printed.J_b.norm() - 2 * std::cos(bend / 2)), kRight);
    ASSERT_LE(std::abs(used.J_b.norm() - 1), kRight);
  }
}

// --- A -------------------------------------------------------------------------------------------

TEST(ErrataLimits, EquationA_6HasTheSignOfALeftHandedBasisInTheAngleAboutAnAxis) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const double th = random.uniform(0.2, 3);
    // {x, y, z} right-handed, and v turned about y.
    const Vector y = random.unit(), x = pintle::any_tangent(y), z = cross(x, y);
    const Vector v = equations::rotate(equations::rotation(y, th), x);
    const double printed = std::atan2(z.dot(v), x.dot(v));
    ASSERT_GT(std::abs(printed - th), 0.3);
    ASSERT_LT(std::abs(equations::angle_about(y, x, v).angle() - th), kRight);
  }
}

TEST(ErrataLimits, EquationA_22NeedsAThresholdAndNotZero) {
  double printed = 0, used = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const Vector a = random.unit(), n = pintle::any_tangent(a);
    const Vector b = equations::rotate(equations::rotation(n, pi - 1e-15), a);
    const Vector sum = a + b;
    const double length = sum.norm();
    const Vector h = length != 0 ? Vector(sum / length) : n;
    printed = greatest(printed, mismatch(equations::rotate(Turn{a.dot(h), cross(a, h)}, a), b));
    used = greatest(used, mismatch(equations::rotate(equations::shortest_rotation(a, b), a), b));
  }
  EXPECT_GT(printed, 0.5);
  EXPECT_LT(used, kRight);
}

TEST(ErrataLimits, EquationA_25LeavesOutTheAxisAndHalfATurnOfSwing) {
  // Without the vector v the imaginary part is a number; as the only component there is, the first.
  double printed = 0, used = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const Vector v = random.unit();
    const Turn q = random.turn();
    const double s = q.v.dot(v), norm = std::hypot(q.w, s);
    const Turn form{q.w / norm, Vector(s / norm, 0, 0)};
    // What is left has no turn about v: its axis is normal to it.
    const auto rest = [&](const Turn& twist) {
      return std::abs(equations::product(q, equations::conjugate(twist)).v.dot(v));
    };
    printed = greatest(printed, rest(form));
    used = greatest(used, rest(equations::swing_twist(q, v).twist));
  }
  EXPECT_GT(printed, 0.9);
  EXPECT_LT(used, kRight);
  // 0/0 as printed.
  const Turn half_turn{0, Vector::Unit(0)};
  EXPECT_EQ(equations::twist_part<double>(half_turn, Vector::Unit(2)).w, 1);
}

TEST(ErrataLimits, EquationA_24SwingsBeforeItTwists) {
  // The parts of a swing after a twist, multiplied as printed, are another rotation.
  double printed = 0, used = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const Turn q = random.turn();
    const auto parts = equations::swing_twist<double>(q, Vector::Unit(2));
    const auto error = [&](const Turn& p) { return mismatch(p.v, q.v); };
    printed = greatest(printed, error(equations::product(parts.twist, parts.swing)));
    used = greatest(used, error(equations::product(parts.swing, parts.twist)));
  }
  EXPECT_GT(printed, 0.5);
  EXPECT_LT(used, kRight);
}

}  // namespace
