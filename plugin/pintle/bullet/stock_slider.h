// Purpose: the settings of a slider of Bullet's, as they were read last.
#pragma once

#include <pintle/precision.h>

class btSliderConstraint;

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The bits of a slider's settings but for its frames, by which it shows that a client has written one.
class StockSliderBits {
 public:
  /// Takes them over. Returns whether one has changed.
  bool update(const btSliderConstraint& slider);

 private:
  Scalar m_numbers[28] = {};  ///< in Bullet's order: limits, softness, restitution, damping and CFM
  Scalar m_linear_motor[2] = {}, m_angular_motor[2] = {};  ///< velocity and bound
  int m_switches = 0;  ///< which parameters are set, motors, and kinds of frames
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
