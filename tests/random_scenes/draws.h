// What scenes draw beside plain numbers.
#pragma once

#include <cmath>

#include "../unit/support.h"

namespace random_scenes {

inline bool chance(support::Random& random, double part) { return random.uniform(0, 1) < part; }
/// Of 10, between these exponents.
inline double power(support::Random& random, double low, double high) {
  return std::pow(10, random.uniform(low, high));
}

}  // namespace random_scenes
