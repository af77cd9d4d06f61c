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
/// The joint frames, if the mode asks for them.
inline void drawFrames(btIDebugDraw& drawer, const btTransform& a, const btTransform& b,
                       btScalar size) {
  if (!drawsFrames(drawer)) return;
  drawer.drawTransform(a, size);
  drawer.drawTransform(b, size);
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

/// The limits of a joint of six degrees of freedom whose position and turn about x are held, as Bullet draws
/// them: where x of frame a may go in angle 1 (about y, within a quarter of a turn) and angle 2 (about z)
/// of Bullet's, drawn at frame b, and the box, which is a point. low > high, or a turn or more: free.
inline void drawPatch(btIDebugDraw& drawer, const btTransform& a, const btTransform& b,
                      btScalar size, Scalar low_1, Scalar high_1, Scalar low_2, Scalar high_2) {
  // Bullet's own buffers hold two turns.
  const bool free = !(low_2 <= high_2 && high_2 - low_2 < SIMD_2_PI);
  drawer.drawSpherePatch(b.getOrigin(), a.getBasis().getColumn(2), a.getBasis().getColumn(0),
                         size * btScalar(0.9f), low_1, high_1, free ? 1 : low_2, free ? -1 : high_2,
                         limitColor());
  const btVector3 origin(0, 0, 0);
  drawer.drawBox(origin, origin, a, limitColor());
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
