// The looks from afar: never wrong about an angle that is near its limit, and not blind to one that is far.
#include <gtest/gtest.h>
#include <pintle/rows/far_limit.h>

#include <cmath>
#include <random>

#include "support.h"

namespace far_limit_test {

using pintle::CosineLimit;
using pintle::DirectionLimit;
using pintle::Scalar;

constexpr double pi = 3.14159265358979323846;

TEST(FarLimit, NeverTakesANearAngleForAFarOne) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  int far = 0;
  for (int i = 0; i < 200000; ++i) {
    const double width = std::pow(unit(random), 3) * pi, angle = unit(random) * pi;
    const double most = unit(random) < 0.5 ? unit(random) * 0.1 : unit(random) * 4;
    if (CosineLimit(Scalar(width)).isFarInside(Scalar(std::cos(angle)), Scalar(most))) {
      EXPECT_GT(width - angle, most) << width << " " << angle;
      ++far;
    }
  }
  EXPECT_GT(far, 10000) << "this test proves nothing";
}

// A tenth of the width, for what may move by less than that.
TEST(FarLimit, SeesAnAngleThatIsFar) {
  for (double width = 0.01; width < pi; width += 0.01) {
    const CosineLimit limit{Scalar(width)};
    for (const double most : {0.001 * width, 0.01 * width, 0.1 * width}) {
      const double angle = width < pi / 2 ? 0.85 * width - most : width - 2 * std::sqrt(most) - 1;
      if (angle < 0) continue;
      EXPECT_TRUE(limit.isFarInside(Scalar(std::cos(angle)), Scalar(most))) << width << " " << most;
    }
  }
}

TEST(FarLimit, OfNoLimitEverythingIsFarAndOfALockNothing) {
  EXPECT_TRUE(CosineLimit().isFarInside(-1, 100));
  EXPECT_TRUE(CosineLimit(Scalar(pi)).isFarInside(-1, 100));
  EXPECT_FALSE(CosineLimit(0).isFarInside(1, 0));
  EXPECT_FALSE(DirectionLimit(Scalar(0.3), Scalar(0.3))
                   .isFarInside(Scalar(std::cos(0.3)), Scalar(std::sin(0.3)), 1, 0));
}

TEST(FarLimit, ADirectionIsTakenFromTheMiddleOfItsRangeAtAnyLength) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  int far = 0;
  for (int i = 0; i < 200000; ++i) {
    const double low = (2 * unit(random) - 1) * 2 * pi, high = low + unit(random) * 2 * pi;
    const double angle = low + unit(random) * 2 * pi, length = 0.01 + 2 * unit(random);
    const double most = unit(random) * 0.1;
    const DirectionLimit limit{Scalar(low), Scalar(high)};
    if (!limit.isFarInside(Scalar(length * std::cos(angle)), Scalar(length * std::sin(angle)),
                           Scalar(length), Scalar(most)))
      continue;
    ++far;
    EXPECT_GT(std::min(angle - low, high - angle), most / length)
        << low << " " << high << " " << angle;
  }
  EXPECT_GT(far, 10000) << "this test proves nothing";
}

}  // namespace far_limit_test
