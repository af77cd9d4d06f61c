// Purpose: a faster atan2 for every step. In single precision it takes a third of the C library's instructions, and
// gives up the last digit.
#pragma once

#include <cmath>

namespace pintle {

inline double arctangent(double y, double x) { return std::atan2(y, x); }

/// atan2(y, x) to within 3e-7 rad; 0 for x = y = 0.
inline float arctangent(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float large = ax > ay ? ax : ay, small = ax > ay ? ay : ax;
  if (large == 0) return 0;
  // atan(t) = pi/4 + atan((t - 1)/(t + 1)) leaves |t| < tan(pi/8).
  const bool above = small > 0.41421356f * large;
  const float t = (above ? small - large : small) / (above ? small + large : large), z = t * t;
  float angle =
      (((8.0537445e-2f * z - 1.3877686e-1f) * z + 1.9977711e-1f) * z - 3.3332949e-1f) * z * t + t;
  if (above) angle += 0.78539816f;
  if (ay > ax) angle = 1.57079633f - angle;
  if (x < 0) angle = 3.14159265f - angle;
  return std::copysign(angle, y);
}

}  // namespace pintle
