// How deep bodies are in each other.
#pragma once

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <algorithm>

namespace support {

/// m: the deepest contact of a pair where contacts were last looked for, at the beginning of a step; 0: nothing touches.
inline double depthOf(const btPersistentManifold& pair) {
  double deepest = 0;
  for (int i = 0; i < pair.getNumContacts(); ++i)
    deepest = std::max(deepest, -double(pair.getContactPoint(i).getDistance()));
  return deepest;
}

}  // namespace support
