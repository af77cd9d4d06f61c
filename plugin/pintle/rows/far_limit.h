// Purpose: to see that a limit of an angle is far, from the angle's cosine or direction: without an arc
// tangent, for a joint that is well inside.
//   cos(width - turn) <= cos(width) + slope turn,
// slope the largest sine from `width` to 0; all are divided by it.
#pragma once

#include <pintle/precision.h>

#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A limit at `width` (rad, >= 0) to either side of a middle; by default, and from pi on, none.
class CosineLimit {
 public:
  CosineLimit() = default;
  explicit CosineLimit(Scalar width) {
    if (!(width < SIMD_PI)) return;
    const Scalar slope = width < SIMD_HALF_PI ? std::sin(width) : Scalar(1);
    const bool too_narrow = slope <= rounding;  // to be told from its middle
    m_scale = too_narrow ? Scalar(0) : 1 / slope;
    m_edge = too_narrow ? infinity : (std::cos(width) + rounding) / slope;
  }

  /// Whether an angle of this cosine (from the middle) is more than `turn` (rad) inside. False says
  /// nothing.
  bool isFarInside(Scalar cosine, Scalar turn) const { return m_scale * cosine > m_edge + turn; }

 private:
  friend class DirectionLimit;
  static constexpr Scalar rounding = 8 * SIMD_EPSILON;

  Scalar m_scale = 0, m_edge = -infinity;
};

/// The limits low <= atan2(y, x) <= high (rad, less than a turn apart).
class DirectionLimit {
 public:
  DirectionLimit() = default;
  DirectionLimit(Scalar low, Scalar high) : DirectionLimit(low, high, (high - low) / 2) {}
  /// With limits that are nearer to their middle.
  DirectionLimit(Scalar low, Scalar high, Scalar width) {
    const Scalar middle = (low + high) / 2;
    const CosineLimit limit(width);
    m_x = limit.m_scale * std::cos(middle);
    m_y = limit.m_scale * std::sin(middle);
    m_edge = limit.m_edge;
  }

  /// Whether (x, y), of this length, is more than `turn` / length (rad) inside. False says nothing.
  bool isFarInside(Scalar x, Scalar y, Scalar length, Scalar turn) const {
    return m_x * x + m_y * y > m_edge * length + turn;
  }

 private:
  Scalar m_x = 0, m_y = 0, m_edge = -infinity;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
