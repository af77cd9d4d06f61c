// The angle that counts its turns, and the arc tangent that it is read by.
#include <gtest/gtest.h>
#include <pintle/arctangent.h>
#include <pintle/notation.h>
#include <pintle/rows/unwrapped_angle.h>

#include "autodiff.h"

namespace unwrapped_angle_test {

using autodiff::Random;
using pintle::pi;

using pintle::Scalar;
using pintle::UnwrappedAngle;

constexpr double kScalarEpsilon = double(std::numeric_limits<Scalar>::epsilon());

void look(UnwrappedAngle& angle, double th) {
  angle.update(Scalar(std::cos(th)), Scalar(std::sin(th)));
}

TEST(Arctangent, IsThatOfTheLibraryOverTheWholePlane) {
  const double tolerance = std::is_same_v<Scalar, float> ? 3e-7 : 0;
  double worst = 0;
  for (int i = -200000; i <= 200000; ++i) {
    const Scalar th = Scalar(pi * i / 200000), r = Scalar(std::pow(10, i % 7));
    const Scalar x = r * std::cos(th), y = r * std::sin(th);
    worst = std::max(worst,
                     std::abs(double(pintle::arctangent(y, x)) - std::atan2(double(y), double(x))));
  }
  EXPECT_LE(worst, tolerance);
  EXPECT_EQ(pintle::arctangent(Scalar(0), Scalar(0)), 0);
  EXPECT_EQ(pintle::arctangent(Scalar(0), Scalar(-1)), Scalar(pi));
}

TEST(UnwrappedAngle, RoughValueIsWithinItsError) {
  UnwrappedAngle angle;
  double worst = 0;
  for (double th = 0; th < 20; th += 1e-3) {
    look(angle, th);
    worst = std::max(worst, std::abs(double(angle.roughValue()) - th));
  }
  EXPECT_LE(worst, double(UnwrappedAngle::rough_error));
  EXPECT_GE(worst, 0.9 * double(UnwrappedAngle::rough_error));  // and no larger than it must be
}

// An angle is as good as its direction and its own last digit.
double tolerance(double th) { return 4 * kScalarEpsilon * (1 + std::abs(th)); }

TEST(UnwrappedAngle, FollowsRandomWalksOfStepsUpToJustUnderHalfATurn) {
  // Just under: half a turn to within 1e-3 counts as half a turn.
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    UnwrappedAngle angle;
    double th = 0;
    const double most = seed % 2 ? pi - 2e-3 : 0.7;
    for (int i = 0; i < 500; ++i) {
      th += i % 3 ? random.uniform(-most, most) : (random.uniform(-1, 1) < 0 ? -most : most);
      look(angle, th);
      ASSERT_LE(std::abs(double(angle.value()) - th), tolerance(th));
      ASSERT_LE(std::abs(double(angle.remainder())), pi + kScalarEpsilon * pi);
    }
  }
}

TEST(UnwrappedAngle, CountsThousandsOfTurns) {
  for (const double step : {3.0, -3.0, 0.9, -0.9}) {
    UnwrappedAngle angle;
    for (int i = 1; i <= 20000; ++i) {
      look(angle, step * i);
      ASSERT_LE(std::abs(double(angle.turns()) - step * i / (2 * pi)), 0.5 + 1e-6) << i;
    }
    EXPECT_LE(std::abs(double(angle.value()) - step * 20000), tolerance(step * 20000));
    EXPECT_GT(std::abs(double(angle.turns())), 2800);
  }
}

TEST(UnwrappedAngle, SpinOfHalfATurnAStepGoesOnTheSameWay) {
  for (const double way : {1.0, -1.0}) {
    for (const double start : {0.5, 0.0, 1.5, 3.1, pi / 2}) {
      // Exactly opposite, and opposite to rounding.
      UnwrappedAngle exact, rounded;
      look(exact, way * start - way * 0.1);
      look(rounded, way * start - way * 0.1);
      Scalar x = Scalar(std::cos(way * start)), y = Scalar(std::sin(way * start));
      for (int i = 0; i < 100; ++i) {
        const double th = way * (start + pi * i);
        exact.update(x, y);
        look(rounded, th);
        ASSERT_LE(std::abs(double(exact.value()) - th), tolerance(th));
        ASSERT_LE(std::abs(double(rounded.value()) - th), tolerance(th));
        x = -x;
        y = -y;
      }
    }
  }
}

TEST(UnwrappedAngle, TakingTheSameDirectionAgainChangesNothing) {
  Random random(3);
  UnwrappedAngle once, twice;
  double th = 0;
  for (int i = 0; i < 2000; ++i) {
    // Every tenth step by half a turn, whose way is that of the step before.
    th += i % 10 == 9 ? pi : random.uniform(-2, 2);
    look(once, th);
    for (int k = 0; k < 3; ++k) look(twice, th);
    ASSERT_EQ(once.value(), twice.value());
    ASSERT_EQ(once.turns(), twice.turns());
  }
}

TEST(UnwrappedAngle, SetIsFollowedByTheNearestTurn) {
  for (int i = -400; i <= 400; ++i) {
    // No odd multiple of pi among them.
    const double th = 0.1 * i;
    UnwrappedAngle angle;
    angle.set(Scalar(th));
    ASSERT_LE(std::abs(double(angle.value()) - th), tolerance(th));
    look(angle, th);
    ASSERT_LE(std::abs(double(angle.value()) - th), tolerance(th));
    for (const double on : {0.3, 3.0, -3.0}) {
      UnwrappedAngle next = angle;
      look(next, th + on);
      ASSERT_LE(std::abs(double(next.value()) - (th + on)), tolerance(th + on));
    }
  }
}

TEST(UnwrappedAngle, SetToOddMultiplesOfPiIsThatAngle) {
  // Within the turn they are pi or -pi, and which of them only rounding says: the turns must agree.
  for (int i = -9; i <= 9; ++i) {
    for (const Scalar off : {Scalar(0), Scalar(1e-6), Scalar(-1e-6)}) {
      const Scalar th = Scalar(i) * Scalar(pi) + off;
      UnwrappedAngle angle;
      angle.set(th);
      EXPECT_LE(std::abs(double(angle.value()) - double(th)), tolerance(double(th))) << i << " pi";
      look(angle, double(th) + 0.3);
      EXPECT_LE(std::abs(double(angle.value()) - (double(th) + 0.3)), tolerance(double(th)))
          << i << " pi";
    }
  }
}

TEST(UnwrappedAngle, MinusZeroIsZero) {
  UnwrappedAngle angle;
  angle.update(Scalar(-1), Scalar(-0.0));
  EXPECT_EQ(angle.value(), Scalar(pi));
  angle.update(Scalar(-1), Scalar(0.0));
  EXPECT_EQ(angle.value(), Scalar(pi));
  EXPECT_EQ(angle.turns(), 0);

  // From below it is the same half turn, reached the other way.
  UnwrappedAngle back;
  look(back, -3);
  back.update(Scalar(-1), Scalar(-0.0));
  EXPECT_LE(std::abs(double(back.value()) + pi), tolerance(pi));
  look(back, -3);
  EXPECT_LE(std::abs(double(back.value()) + 3), tolerance(pi));
}

}  // namespace unwrapped_angle_test
