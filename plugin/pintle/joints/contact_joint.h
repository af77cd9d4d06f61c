// Purpose: a point of one body on a plane of the other (document, 3.1.2).
#pragma once

#include <pintle/joints/frame_joint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A point of body b stays on the side of a plane of body a to which the plane's normal points, or,
/// two-sided, on the plane. It slides and turns there without friction.
///
/// The point is the origin of the joint frame in b, whose axes mean nothing; the plane goes through
/// the origin of the frame in a, normal to its z. As constructed it is one-sided and has no
/// rebound. Conditioned: the plane turns with body a. Document: it moves with the body but keeps
/// the normal that it had in the world when the frames were set, and holds each body at its own
/// anchor.
///
/// \image html contact_joint.svg
class ContactJoint : public FrameJoint {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Pivots (m) and the normal (made unit) in the bodies' frames.
  ContactJoint(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
               const btVector3& pivotInB, const btVector3& normalInA);
  /// z of the frame of a is the normal.
  ContactJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
               const btTransform& frameInB);
  /// To a point of the world, where the frame's origin is now; the plane moves with the body.
  ContactJoint(btRigidBody& rbA, const btTransform& frameInA);

  /// m, of the point above the plane as they are now: negative below it.
  btScalar getDistance() const;

  /// Whether the point is held on the plane from both sides. Default off.
  void setTwoSided(bool two_sided) { m_axis.high = two_sided ? Scalar(0) : infinity; }
  /// What setTwoSided set.
  bool getTwoSided() const { return m_axis.locked(); }
  /// Coefficient of restitution of a one-sided contact (document, B.2), in [0, 1]. A point that
  /// reaches the plane between two steps rebounds in the second, with this part of the speed that
  /// it had before the first. Default 0.
  void setRestitution(btScalar restitution);
  /// What setRestitution set.
  btScalar getRestitution() const { return m_axis.bias * m_axis.relaxation; }
  /// Makes the plane a spring and damper (document, 2.4), which then rebounds as a spring:
  /// frequency (Hz) and damping ratio (>= 0; 1 is critical). Frequency 0: rigid again.
  void setLimitSpring(btScalar frequency_hz, btScalar damping_ratio);

  /// Impulse of the last step (N s) on body b along the normal.
  btScalar getNormalImpulse() const;

  /// The frames, and a disc of the plane.
  void drawJoint(btIDebugDraw& drawer) const override;
  const char* name() const override { return "ContactJoint"; }
  void addRows(const PosePair& poses, Rows& rows) const override;

 protected:
  void framesChanged() override;

 private:
  // A contact has no part without its position.
  using FrameJoint::getAngularOnly;
  using FrameJoint::setAngularOnly;

  void setDefaults();
  bool isEquality() const { return getTwoSided() && !(m_axis.limit_spring.angular_frequency > 0); }

  struct At;
  At at(const PosePair& pair) const;

  Axis m_axis;               ///< along the normal
  btVector3 m_world_normal;  ///< the document's
  static constexpr RowCount row_count{1, 1};
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
