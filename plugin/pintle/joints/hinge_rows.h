// Purpose: what the rows of all hinges share, for their .cpp files only: inline, as it is on the way
// of every hinge in every step.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/equations/position.h>
#include <pintle/equations/quaternion_hinge_limit.h>
#include <pintle/frame.h>
#include <pintle/joints/hinge_base.h>
#include <pintle/joints/hinge_of.h>
#include <pintle/joints/observed_joint_rows.h>
#include <pintle/joints/turning.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The joint frames in the world, and the twist at them.
struct HingeBase::Observation {
  Frame a, b;
  Vec3 d;  ///< from the pivot of a to that of b
  Vec3 c_a = a.c(), c_b = b.c();
  Lanes a_b = a.components(b.a()), b_b = a.components(b.b());
  equations::Twist<Scalar> twist = equations::twist<Scalar>(a_b[0], b_b[1], a_b[1], b_b[0]);

  equations::Anchors<Scalar> anchors() const { return {a.r(), b.r(), d}; }
  Scalar sum() const { return d.sum() + c_b.sum() + (a_b + b_b).head<3>().sum(); }
};

inline HingeBase::Observation HingeBase::observe(const PosePair& poses) const {
  const Frame a(poses.pose_a(), m_frame_a), b(poses.pose_b(), m_frame_b);
  return {a, b, equations::position_error(poses.x_a(), a.r(), poses.x_b(), b.r())};
}

inline void HingeBase::remember(const Observation& seen, bool in_step) {
  followStep(m_twist, seen.twist, seen.c_a, seen.c_b, m_rbA, m_rbB, timeStep(), angularSpeed());
  if (in_step) m_tested = m_twist;
}

inline Acting HingeBase::acting(const Observation& seen, const equations::Swing<Scalar>& swing,
                                const Rows& rows) const {
  // With c_a and c_b all but opposite the axis has no angle.
  if (!(swing.h_scale < Scalar(20))) return {};
  return actingAngle(
      m_axis, [&] { return followed(m_twist, seen.twist); }, swing.h, m_sign,
      [&] { return rows.turn(); });
}

inline void HingeBase::addAxisRow(const Acting& acting, const equations::Swing<Scalar>& swing,
                                  Rows& rows) const {
  if (!acting.row) return;
  rows.addAngularAxis(0, equations::twist_row(swing), acting.position, m_axis, acting.limit,
                      m_sign > 0 ? 1 : -1);
  rows.shape(RowShape::turn);
}

template <class Self>
HingeOf<Self>::HingeOf(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
                       const btVector3& pivotInB, const btVector3& axisInA,
                       const btVector3& axisInB, bool useReferenceFrameA)
    : ObservedJoint<Self, HingeBase>(rbA, rbB, Self::row_count, useReferenceFrameA) {
  this->begin(pivotInA, pivotInB, axisInA, axisInB);
}

template <class Self>
HingeOf<Self>::HingeOf(btRigidBody& rbA, const btVector3& pivotInA, const btVector3& axisInA,
                       bool useReferenceFrameA)
    : ObservedJoint<Self, HingeBase>(rbA, Self::row_count, useReferenceFrameA) {
  this->begin(pivotInA, axisInA);
}

template <class Self>
HingeOf<Self>::HingeOf(btRigidBody& rbA, btRigidBody& rbB, const btTransform& rbAFrame,
                       const btTransform& rbBFrame, bool useReferenceFrameA)
    : ObservedJoint<Self, HingeBase>(rbA, rbB, Self::row_count, useReferenceFrameA) {
  this->begin(rbAFrame, rbBFrame);
}

template <class Self>
HingeOf<Self>::HingeOf(btRigidBody& rbA, const btTransform& rbAFrame, bool useReferenceFrameA)
    : ObservedJoint<Self, HingeBase>(rbA, Self::row_count, useReferenceFrameA) {
  this->begin(rbAFrame);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
