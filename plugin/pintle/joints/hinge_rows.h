// Purpose: what the rows of all hinges share, for their .cpp files only: inline, as it is on the way
// of every hinge in every step.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/equations/position.h>
#include <pintle/equations/quaternion_hinge_limit.h>
#include <pintle/frame.h>
#include <pintle/joints/constants.h>
#include <pintle/joints/hinge_model.h>
#include <pintle/joints/observed_joint_rows.h>
#include <pintle/joints/turning.h>
#include <pintle/rows/position_rows.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The joint frames in the world, and the twist at them.
struct HingeModel::Observation {
  Frame a, b;
  Vec3 d;  ///< from the pivot of a to that of b
  Vec3 c_a = a.c(), c_b = b.c();
  Lanes a_b = a.components(b.a()), b_b = a.components(b.b());
  equations::Twist<Scalar> twist = equations::twist<Scalar>(a_b[0], b_b[1], a_b[1], b_b[0]);

  equations::Anchors<Scalar> anchors() const { return {a.r(), b.r(), d}; }
  Scalar sum() const { return d.sum() + c_b.sum() + (a_b + b_b).head<3>().sum(); }
};

inline HingeModel::Observation HingeModel::observe(const PosePair& poses) const {
  const Frame a(poses.pose_a(), m_settings.frame_a), b(poses.pose_b(), m_settings.frame_b);
  return {a, b, equations::position_error(poses.x_a(), a.r(), poses.x_b(), b.r())};
}

inline void HingeModel::remember(const Observation& seen, bool in_step) {
  followStep(m_twist, seen.twist, seen.c_a, seen.c_b, bodyA(), bodyB(), timeStep(), angularSpeed());
  if (in_step) showAngle(seen.c_a.dot(seen.c_b) < min_cosine_of_axes);
}

inline Acting HingeModel::acting(const Observation& seen, const equations::Swing<Scalar>& swing,
                                 const Rows& rows) const {
  // With c_a and c_b all but opposite the axis has no angle.
  if (!(swing.h_scale < max_h_scale)) return {};
  return actingAngle(
      m_settings.axis, [&] { return followed(m_twist, seen.twist); }, swing.h, m_sign,
      [&] { return rows.turn(); });
}

inline void HingeModel::addPivotRows(const equations::Anchors<Scalar>& at, Rows& rows) const {
  if (m_settings.angular_only) return;
  if (getFormulation() == Formulation::document)
    addDocumentPositionRows(at, rows);
  else
    addConservingPositionRows(at, rows);
}

inline void HingeModel::addAxisRow(const Acting& acting, const equations::Swing<Scalar>& swing,
                                   Rows& rows) const {
  if (!acting.row) return;
  rows.addAngularAxis(0, equations::twist_row(swing), acting.position, m_settings.axis,
                      acting.limit, m_sign > 0 ? 1 : -1);
  rows.shape(RowShape::turn);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
