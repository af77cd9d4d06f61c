// Purpose: an angle that counts its turns. Bullet's poses know an angle only up to a whole turn;
// this takes each new one as the nearest turn to the last, which is exact for any motion of less
// than half a turn between two looks (Bullet turns two bodies by at most a quarter).
#pragma once

#include <pintle/precision.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

class UnwrappedAngle {
 public:
  /// The angle (rad) is known from elsewhere, turns included.
  void set(Scalar angle) {
    m_turns = std::round(angle / Scalar(2 * pi));
    const Scalar rest = angle - Scalar(2 * pi) * m_turns;
    m_x = std::cos(rest);
    m_y = std::sin(rest);
    m_direction = 0;
  }

  /// The angle is atan2(y, x) now. Taking the same one again changes nothing.
  void update(Scalar x, Scalar y) {
    y += Scalar(0);  // -0 is +0: half a turn is +pi, as atan2 has it
    const Scalar sine = m_x * y - m_y * x, cosine = m_x * x + m_y * y;
    // At half a turn to within rounding both ways are as near: on as before.
    const bool tie = cosine < 0 && std::abs(sine) < Scalar(-1e-3) * cosine && m_direction != 0;
    const Scalar direction = tie ? m_direction : sine;
    if (direction > 0 && m_y >= 0 && y < 0) ++m_turns;
    if (direction < 0 && m_y < 0 && y >= 0) --m_turns;
    if (sine != 0) m_direction = direction > 0 ? Scalar(1) : Scalar(-1);
    m_x = x;
    m_y = y;
  }

  Scalar turns() const { return m_turns; }
  /// Within the turn, in [-pi, pi].
  Scalar remainder() const { return std::atan2(m_y, m_x); }
  /// rad, over any number of turns.
  Scalar value() const { return remainder() + Scalar(2 * pi) * m_turns; }

 private:
  Scalar m_x = 1, m_y = 0;
  Scalar m_turns = 0;
  Scalar m_direction = 0;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
