// Purpose: the rows that hold a point of each body together (document, 3.1.3), for every joint that has
// a ball part. They lie along the world's axes: their Jacobian is then made of signs only.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/equations/position.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Along one axis of the world.
template <int i>
void addPositionRow(const Vec3& lever_a, const equations::Anchors<Scalar>& at,
                    const Vec3& curvature, Rows& rows) {
  const auto J = equations::position_row_world<i>(lever_a, at.r_b);
  rows.addEquality(J.L, J.A_a, J.A_b, at.d[i], curvature[i]);
  rows.shape(RowShape::point, at.r_a, at.r_b);
}

inline void addPositionRows(const equations::Anchors<Scalar>& at, const Vec3& lever_a,
                            const Vec3& curvature, Rows& rows) {
  addPositionRow<0>(lever_a, at, curvature, rows);
  addPositionRow<1>(lever_a, at, curvature, rows);
  addPositionRow<2>(lever_a, at, curvature, rows);
}

/// The document's: each body held at its own anchor.
inline void addDocumentPositionRows(const equations::Anchors<Scalar>& at, Rows& rows) {
  addPositionRows(at, at.r_a, Vec3::Zero(), rows);
}

/// Conditioned: both held at the anchor of b, with this part of the gap in the lever of a (StepMotion::gapInLever).
inline void addConservingPositionRows(const equations::Anchors<Scalar>& at, Scalar gap_in_lever,
                                      Rows& rows) {
  const Vec3 lever_a = at.r_a + gap_in_lever * at.d;
  addPositionRows(at, lever_a, rows.curvature([&](const BodyPair& v) {
    const Scalar dt = rows.timeStep();
    return Vec3(equations::chord_curvature<Scalar>(v.w_b(), at.r_b, dt) -
                equations::chord_curvature<Scalar>(v.w_a(), lever_a, dt));
  }),
                  rows);
}
inline void addConservingPositionRows(const equations::Anchors<Scalar>& at, Rows& rows) {
  addConservingPositionRows(at, rows.gapInLever(at.r_a, at.d), rows);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
