// Purpose: the row of a gear, of which the linear parts on its two bodies are independent of each other: for the .cpp files of gears and of the
// exact solver only.
#pragma once

#include <pintle/vectors.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// As Bullet has it: dC/dt = L_a.v_a + A_a.w_a + L_b.v_b + A_b.w_b + rate. World space.
struct GearRow {
  Vec3 L_a = Vec3::Zero(), A_a = Vec3::Zero(), L_b = Vec3::Zero(), A_b = Vec3::Zero();
  Scalar position = 0;   ///< C, rad or m
  Scalar rate = 0;       ///< dC/dt by bodies that are none of the gear's, rad/s or m/s
  Scalar max_speed = 0;  ///< of the correction of C, rad/s or m/s

  /// True if it is a Row (rows/row.h): forces on the two bodies are equal and opposite.
  bool isPair() const { return L_a == Vec3(-L_b); }
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
