// Purpose: what the rows of all hinges share, for their .cpp files only: inline, as it is on the way
// of every hinge in every step.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/equations/quaternion_hinge_limit.h>
#include <pintle/frame.h>
#include <pintle/joints/hinge_base.h>
#include <pintle/joints/turning.h>
#include <pintle/rows/limit_reach.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The joint frames in the world.
struct HingeBase::Frames {
  Frame a, b;
  Vec3 c_a = a.c(), c_b = b.c();
};

inline HingeBase::Frames HingeBase::frames(const BodyPair& pair) const {
  return {{pair.pose_a(), m_frame_a}, {pair.pose_b(), m_frame_b}};
}

/// The frames, and `twist` as it has become at them.
inline HingeBase::Frames HingeBase::look(const BodyPair& pair, UnwrappedAngle& twist) const {
  const Frames at = frames(pair);
  see(at, twist);
  return at;
}

/// As `look`, if anything acts along the angle; else no row tells of it.
inline HingeBase::Frames HingeBase::lookIfActing(const BodyPair& pair,
                                                 UnwrappedAngle& twist) const {
  return m_axis.limited() || m_axis.driven() ? look(pair, twist) : frames(pair);
}

inline void HingeBase::see(const Frames& at, UnwrappedAngle& angle) const {
  const Lanes a_b = at.a.components(at.b.a()), b_b = at.a.components(at.b.b());
  const auto twist = equations::twist<Scalar>(a_b[0], b_b[1], a_b[1], b_b[0]);
  followTwist(angle, twist, at.c_a + at.c_b, m_rbA, m_rbB, timeStep(), angularSpeed());
}

inline Acting HingeBase::acting(const BodyPair& pair, const UnwrappedAngle& twist,
                                const equations::Swing<Scalar>& swing) const {
  // With c_a and c_b all but opposite the axis has no angle.
  if (!(swing.h_scale < Scalar(20))) return {};
  return actingAngle(m_axis, twist, swing.h, m_sign,
                     [&] { return AngularReach(pair, timeStep()); });
}

inline void HingeBase::addAxisRow(const Acting& acting, const equations::Swing<Scalar>& swing,
                                  Rows& rows) const {
  if (acting.row)
    rows.addAngularAxis(0, equations::twist_row(swing), acting.position, m_axis, acting.limit,
                        m_sign > 0 ? 1 : -1);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
