// Purpose: how joints are drawn: as Bullet draws its own, and only what the drawer's debug mode asks for.
#pragma once

#include <pintle/rows/axis.h>

#include <LinearMath/btIDebugDraw.h>
#include <LinearMath/btTransform.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

inline bool drawsFrames(const btIDebugDraw& drawer) {
  return (drawer.getDebugMode() & btIDebugDraw::DBG_DrawConstraints) != 0;
}
inline bool drawsLimits(const btIDebugDraw& drawer) {
  return (drawer.getDebugMode() & btIDebugDraw::DBG_DrawConstraintLimits) != 0;
}
/// The colour of limits.
inline btVector3 limitColor() { return {0, 0, 0}; }

/// The range of an angle (rad) about the unit vector `normal`, measured from the unit vector `zero`: a
/// sector, or the whole circle where nothing or more than a turn is allowed.
inline void drawRange(btIDebugDraw& drawer, const btVector3& centre, const btVector3& normal,
                      const btVector3& zero, btScalar size, Scalar low, Scalar high) {
  const bool sector = low <= high && high - low < SIMD_2_PI;
  drawer.drawArc(centre, normal, zero, size, size, sector ? low : 0, sector ? high : SIMD_2_PI,
                 limitColor(), sector);
}

/// A closed curve of directions with its cone's edges: point(i) for i in [0, segments).
template <class Point>
void drawCone(btIDebugDraw& drawer, const btVector3& apex, int segments, Point point) {
  btVector3 last = point(segments - 1);
  for (int i = 0; i < segments; ++i) {
    const btVector3 next = point(i);
    drawer.drawLine(last, next, limitColor());
    if (i % (segments / 8) == 0) drawer.drawLine(apex, next, limitColor());
    last = next;
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
