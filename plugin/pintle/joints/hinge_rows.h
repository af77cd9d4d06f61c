// Purpose: what the rows of all hinges share, for their .cpp files only: inline, as it is on the way
// of every hinge in every step.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/equations/quaternion_hinge_limit.h>
#include <pintle/frame.h>
#include <pintle/joints/hinge_base.h>
#include <pintle/rows/limit_reach.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The joint frames in the world.
struct HingeBase::Frames {
  Frame a, b;
  Vec3 c_a = a.c(), c_b = b.c();
};

/// What acts along the angle in this step.
struct HingeBase::Acting {
  Scalar angle = 0;
  bool limit = false;
  bool axis = false;  ///< anything at all: there is a row
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

inline void HingeBase::see(const Frames& at, UnwrappedAngle& angle) const {
  const Lanes dots = at.a.dots(at.b);
  const auto twist =
      equations::twist<Scalar>(dots[0], dots[1], at.a.b().dot(at.b.a()), at.a.a().dot(at.b.b()));
  // Its length is 1 + cos(swing). With the axes all but opposite there is no twist to be seen, and
  // the last one stands; nor in a frame that its owner has spoiled.
  if (!(twist.x * twist.x + twist.y * twist.y > Scalar(0.01))) return;
  // Two fast bodies turn by up to two half turns a step: then not the nearest turn, but the one
  // that their motion leads to. (A kinematic body goes where it is put.)
  const Scalar dt = timeStep();
  if (angularSpeed() * dt < 1 || m_rbA.isStaticOrKinematicObject() ||
      m_rbB.isStaticOrKinematicObject()) {
    angle.update(twist.x, twist.y);
  } else {
    const btVector3 &w_a = m_rbA.getInterpolationAngularVelocity(),
                    &w_b = m_rbB.getInterpolationAngularVelocity();
    const Vec3 h = (at.c_a + at.c_b).normalized();
    angle.update(twist.x, twist.y, h.dot(turnOfStep(w_b, dt) - turnOfStep(w_a, dt)));
  }
}

inline HingeBase::Acting HingeBase::acting(const BodyPair& pair, const UnwrappedAngle& twist,
                                           const equations::Swing<Scalar>& swing) const {
  Acting acting;
  // With c_a and c_b all but opposite the axis has no angle.
  if (!(m_axis.driven() || m_axis.limited()) || !(swing.h_scale < Scalar(20))) return acting;
  Reach reach;
  bool broken = false;
  if (m_axis.limited()) {
    const Scalar rough = m_sign * twist.roughValue(), slack = UnwrappedAngle::rough_error;
    broken = m_axis.distance(rough) < -slack;
    if (!broken) {
      reach = angularReach(pair, swing.h, timeStep(), m_sign).of(m_axis);
      acting.limit = reach.reaches(m_axis, rough, slack);
    }
  }
  if (acting.limit || broken || m_axis.driven()) {
    acting.angle = m_sign * twist.value();
    acting.limit = broken || (acting.limit && reach.reaches(m_axis, acting.angle));
    acting.axis = acting.limit || m_axis.driven();
  }
  return acting;
}

inline void HingeBase::addAxisRow(const Acting& acting, const equations::Swing<Scalar>& swing,
                                  Rows& rows) const {
  if (acting.axis)
    rows.addAngularAxis(0, equations::twist_row(swing), acting.angle, m_axis, acting.limit, m_sign);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
