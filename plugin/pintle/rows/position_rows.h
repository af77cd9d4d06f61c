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

/// Conditioned: both held at the anchor of b, with all of the gap in the lever of a (Joint::gapInLever).
inline void addConservingPositionRows(const BodyPair& pair, const Vec3& r_a, const Vec3& r_b,
                                      const Vec3& d, Scalar gap_in_lever, Rows& rows) {
  addPositionRows(pair, r_a + gap_in_lever * d, r_b, d, rows);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
