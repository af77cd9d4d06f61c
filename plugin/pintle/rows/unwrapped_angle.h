// Purpose: an angle that counts its turns. Bullet's poses know an angle only up to a whole turn;
// this takes each new one as the nearest turn to the last, which is exact for any motion of less
// than half a turn between two looks (Bullet turns two bodies by at most a quarter).
#pragma once

#include <pintle/arctangent.h>
#include <pintle/precision.h>

#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {

class UnwrappedAngle {
 public:
  /// The angle (rad) is known from elsewhere, turns included.
  void set(Scalar angle) {
    const Scalar rest = angle - SIMD_2_PI * std::round(angle / SIMD_2_PI);
    m_x = std::cos(rest);
    m_y = std::sin(rest);
    // Of the remainder as it came out: half a turn may have rounded to the other side.
    m_turns = std::round((angle - remainder()) / SIMD_2_PI);
    m_direction = 0;
  }

  /// The angle is atan2(y, x) now. Taking the same one again changes nothing.
  void update(Scalar x, Scalar y) {
    if (isAt(x, y)) return;
    y += Scalar(0);  // -0 is +0: half a turn is +pi, as atan2 has it
    const Scalar sine = m_x * y - m_y * x;
    // Both within a quarter of a turn of zero: the nearest way does not pass half a turn.
    if (x > Scalar(0.1) && m_x > Scalar(0.1)) {
      if (sine != 0) m_direction = sine;
      m_x = x;
      m_y = y;
      return;
    }
    const Scalar cosine = m_x * x + m_y * y;
    // At half a turn to within rounding both ways are as near: on as before.
    const bool tie = cosine < 0 && std::abs(sine) < Scalar(-1e-3) * cosine && m_direction != 0;
    const Scalar direction = tie ? m_direction : sine;
    // Whether the remainder has grown; it falls on the way up, and grows on the way down, only by a
    // turn. Within one half plane the sine says so, and between 0 and pi exactly, the cosine.
    const bool below = y < 0, was_below = m_y < 0;
    const Scalar growth = below != was_below ? Scalar(below ? -1 : 1) : sine != 0 ? sine : m_x - x;
    if (direction > 0 && growth < 0) ++m_turns;
    if (direction < 0 && growth > 0) --m_turns;
    if (sine != 0) m_direction = direction;
    m_x = x;
    m_y = y;
  }

  /// The same, where the angle has changed by about `change` since the last look, which may be more
  /// than half a turn.
  void update(Scalar x, Scalar y, Scalar change) {
    if (isAt(x, y)) return;  // looked already
    y += Scalar(0);
    const Scalar expected = value() + change, rest = arctangent(y, x);
    m_turns = std::round((expected - rest) / SIMD_2_PI);
    m_x = x;
    m_y = y;
    m_direction = change;
  }

  /// Whether (x, y) is what it was last given.
  bool isAt(Scalar x, Scalar y) const { return x == m_x && y == m_y; }
  /// Changes the turn to the one that brings the angle nearest to `middle`.
  void turnTowards(Scalar middle) { m_turns += std::round((middle - value()) / SIMD_2_PI); }

  Scalar turns() const { return m_turns; }
  /// Within the turn, in [-pi, pi].
  Scalar remainder() const { return arctangent(m_y, m_x); }
  /// rad, over any number of turns.
  Scalar value() const { return remainder() + SIMD_2_PI * m_turns; }
  /// The same to within rough_error, without an arc tangent.
  Scalar roughValue() const { return SIMD_HALF_PI * (quarters(m_x, m_y) + 4 * m_turns); }
  static constexpr Scalar rough_error = Scalar(0.072);

 private:
  static Scalar quarters(Scalar x, Scalar y) {
    const Scalar first = y / (std::abs(x) + std::abs(y));
    return x < 0 ? (y < 0 ? Scalar(-2) : Scalar(2)) - first : first;
  }

  Scalar m_x = 1, m_y = 0;
  Scalar m_turns = 0;
  Scalar m_direction = 0;  // its sign: which way the angle moved last; 0: it has not
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
