// Purpose: a ball joint whose free body keeps within a wedge of the sphere (document, 3.1.3 + 3.2.7).
#pragma once

#include <pintle/joints/frame_joint.h>
#include <pintle/rows/far_limit.h>

namespace pintle {
namespace equations {
template <class T>
struct AngleAbout;
template <class T>
struct Wedge;
}  // namespace equations

inline namespace PINTLE_PRECISION {

class AngularReach;
class Frame;

/// A point of each body coincide, and a direction c_b of body b keeps between two half planes of
/// body a that meet in the wedge axis w. It may turn about itself, and lean towards w and away.
///
/// The angle (rad) is that of c_b about w, right-handed, zero where the reference c_a is. In joint
/// frames w is z of a, c_a is x of a, and c_b is x of b. Along w there is no angle, and c_b may rest
/// in the corner. Limits are dead stops.
///
/// Document: the two planes by dot products, and the extra one while both are broken. Conditioned:
/// the shortest turns to the same planes, and the extra one as soon as an acute corner is near; from far behind
/// the edge the shortest turn to it.
///
/// \image html wedge_joint.svg
class WedgeJoint : public FrameJoint {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Pivots (m), the directions c_a and c_b and the wedge axis w in the bodies' frames; directions
  /// are made unit. c_a may be at any angle to w but along it.
  WedgeJoint(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
             const btVector3& pivotInB, const btVector3& referenceInA,
             const btVector3& referenceInB, const btVector3& wedgeAxisInA);
  /// Joint frames in the bodies' frames: z of a is the wedge axis, x of a and of b the references.
  WedgeJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
             const btTransform& frameInB);
  /// To the world, where the frame is now.
  WedgeJoint(btRigidBody& rbA, const btTransform& frameInA);

  /// low <= angle <= high (rad, phi_- and phi_+ of the document). Their difference is from 0 to
  /// below 2 pi, and 0 need not be between. low > high, an infinite side, or a whole turn: free.
  void setLimit(btScalar low, btScalar high);
  /// rad, as setLimit set it.
  btScalar getLowerLimit() const { return m_side.low; }
  /// rad, as setLimit set it.
  btScalar getUpperLimit() const { return m_side.high; }
  /// Makes the limit a spring and damper (document, 2.4): frequency (Hz) and damping ratio (>= 0; 1
  /// is critical) of the bodies as they alone would swing. Frequency 0: rigid again.
  void setLimitSpring(btScalar frequency_hz, btScalar damping_ratio);
  /// Turns c_b at target_velocity (rad/s, of the angle), by at most max_impulse in a step (N m s, >= 0).
  void enableAngularMotor(bool enable, btScalar target_velocity, btScalar max_impulse);
  /// Holds an angle (rad) by a spring (frequency > 0 in Hz, damping ratio >= 0) of at most max_torque
  /// (N m, >= 0 or infinite), until told otherwise. Takes the place of the motor.
  void setMotorServo(btScalar target_angle, btScalar frequency_hz, btScalar damping_ratio,
                     btScalar max_torque);
  /// Turns the motor or servo, as it was set last, on or off.
  void enableMotor(bool enable);
  /// Whether a motor or servo is on.
  bool getEnableAngularMotor() const { return m_side.drive != Axis::Drive::off; }
  /// Dry friction of at most max_torque (N m, >= 0 or infinite) against a change of the angle; not
  /// against leaning towards w, nor against turning about c_b. 0: none.
  void setFriction(btScalar max_torque);

  /// rad, in the turn around the middle of the limit, as the bodies are now; along w the middle.
  btScalar getAngle() const;
  /// Whether c_b is within the limit, as the bodies are now.
  bool isInside() const;

  ///@{
  /// Impulses of the last step (N m s): of both sides, positive towards larger angles; of an acute
  /// corner, away from it; of motor and friction, positive towards larger angles.
  btScalar getLimitImpulse() const { return sideImpulse(Axis::limit); }
  btScalar getCornerImpulse() const { return axisImpulse(corner, Axis::limit); }
  btScalar getMotorImpulse() const { return sideImpulse(Axis::motor); }
  btScalar getFrictionImpulse() const { return sideImpulse(Axis::friction); }
  ///@}

  /// The frames, and the wedge as a sector of the plane normal to w.
  void drawJoint(btIDebugDraw& drawer) const override;
  const char* name() const override { return "WedgeJoint"; }
  void addRows(const PosePair& poses, Rows& rows) const override;

 private:
  enum Index { low_side, high_side, corner, drive, axes };
  struct Reference;
  struct Plane;
  struct Directions;

  void setDefaults();
  Scalar sideImpulse(Axis::Part part) const {
    return axisImpulse(low_side, part) + axisImpulse(high_side, part) + axisImpulse(drive, part);
  }
  bool limited() const { return m_convex || m_reflex; }
  Scalar angle(const equations::AngleAbout<Scalar>& to) const;
  equations::Wedge<Scalar> wedge() const;
  void addWedgeRows(const Reference& at, const AngularReach& reach, Rows& rows) const;
  bool isFarBehindEdge(const Directions& at) const;
  bool isInLowHalf(const Directions& at) const;
  void addPlaneRow(const Plane& plane, const Directions& at, const Axis& side, Rows& rows) const;

  Axis m_side;                           ///< along the angle: both limits, motor and friction
  Axis m_plane[2];                       ///< of each side its limit alone
  Axis m_corner;                         ///< along the turn to the extra plane
  btVector3 m_n_min, m_n_max, m_middle;  ///< the wedge, in the joint frame of body a
  DirectionLimit m_look;                 ///< of c_b, a cone or half of space that lies in the wedge
  bool m_convex = false;                 ///< below pi
  bool m_reflex = false;                 ///< from pi on
  bool m_acute = false;
  static constexpr RowCount row_count{3 + axes, axes};
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
