// Purpose: a velocity motor of a constraint of Bullet's.
#pragma once

#include <pintle/finite.h>
#include <pintle/precision.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// As it stands. While it is off these may be no numbers: not every class initialises them.
struct StockMotor {
  bool on;
  Scalar velocity, bound;  ///< rad/s or m/s; N m s, or N and N m

  bool isSameAs(const StockMotor& other) const {
    return isSame(velocity, other.velocity) && isSame(bound, other.bound);
  }
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
