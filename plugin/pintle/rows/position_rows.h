// Purpose: the rows that hold a point of each body together (document, 3.1.3), for every joint that has
// a ball part. They lie along the world's axes: their Jacobian is then made of signs only.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/equations/position.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Along one axis of the world, with the levers of the two bodies.
template <int i>
void addPositionRow(const Vec3& lever_a, const Vec3& lever_b, const Vec3& d, const Vec3& curvature,
                    Rows& rows) {
  const auto J = equations::position_row_world<i>(lever_a, lever_b);
  rows.addEquality(J.L, J.A_a, J.A_b, d[i], curvature[i]);
}

inline void addPositionRows(const Vec3& lever_a, const Vec3& lever_b, const Vec3& d,
                            const Vec3& curvature, Rows& rows) {
  addPositionRow<0>(lever_a, lever_b, d, curvature, rows);
  addPositionRow<1>(lever_a, lever_b, d, curvature, rows);
  addPositionRow<2>(lever_a, lever_b, d, curvature, rows);
}

/// The document's: each body held at its own anchor. d = p_b - p_a.
inline void addDocumentPositionRows(const Vec3& r_a, const Vec3& r_b, const Vec3& d, Rows& rows) {
  addPositionRows(r_a, r_b, d, Vec3::Zero(), rows);
}

/// With the curvature of the motion.
inline void addPositionRows(const BodyPair& pair, const Vec3& lever_a, const Vec3& lever_b,
                            const Vec3& d, Rows& rows) {
  addPositionRows(lever_a, lever_b, d,
                  equations::position_curvature<Scalar>(pair.w_a(), lever_a, pair.w_b(), lever_b),
                  rows);
}

/// Parts of a gap in the levers of body a and b.
struct GapInLevers {
  Scalar a = 0, b = 0;
};

/// Of two bodies that move freely, with the whole gap in both levers together: the heavier one's takes more, as if they
/// met in their common centre of mass. A body that cannot move, or is held along an axis, keeps no momentum: then each
/// is held at its own anchor, and a pull at a centre turns nothing.
inline GapInLevers gapInLevers(const BodyPair& pair, Scalar whole) {
  const auto isFree = [](const btRigidBody& body) {
    const btVector3& f = body.getLinearFactor();
    return body.getInvMass() > 0 && f.x() == 1 && f.y() == 1 && f.z() == 1;
  };
  if (!isFree(pair.a()) || !isFree(pair.b())) return {};
  const Scalar part = whole / (pair.inv_mass_a() + pair.inv_mass_b());
  return {part * pair.inv_mass_b(), part * pair.inv_mass_a()};
}

/// Conditioned: a part of the gap in the levers (Joint::gapInLever). With all of it both bodies are held at one point
/// between their anchors, and angular momentum is conserved.
inline void addConservingPositionRows(const BodyPair& pair, const Vec3& r_a, const Vec3& r_b,
                                      const Vec3& d, Scalar gap_in_lever, Rows& rows) {
  const GapInLevers part = gapInLevers(pair, gap_in_lever);
  addPositionRows(pair, r_a + part.a * d, r_b - part.b * d, d, rows);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
