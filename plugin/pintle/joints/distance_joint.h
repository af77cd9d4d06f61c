// Purpose: rods, ropes and struts (document, 3.1.1).
#pragma once

#include <pintle/joints/frame_joint.h>
#include <pintle/joints/observed_joint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The distance between a point of each body: held (a rod), or within limits (a rope, a strut).
///
/// As constructed it is a rod. The points are the origins of two joint frames, whose axes mean
/// nothing. Points that coincide have no direction: they part along the last one that they had, and
/// along the world's x if they never had one. Both formulations have the same row; the conditioned
/// one foresees how points gain distance as they pass each other, so that what swings on a rod
/// neither stretches it nor loses its swing.
///
/// \image html distance_joint.svg
class DistanceJoint : public ObservedJoint<DistanceJoint, FrameJoint> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// A rod of `length` (m, >= 0) between pivots (m) in the bodies' frames.
  DistanceJoint(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
                const btVector3& pivotInB, btScalar length);
  /// A rod as long as the frames' origins are apart now.
  DistanceJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                const btTransform& frameInB);
  /// To the world, where the frame's origin is now: a rod of no length. With setLimit(0, length)
  /// it is a tether.
  DistanceJoint(btRigidBody& rbA, const btTransform& frameInA);

  /// m, between the points as they are now.
  btScalar getDistance() const;

  /// low <= distance <= high (m). low = high: a rod; low = 0 (or less): a rope; an infinite high: a
  /// strut; low > high: free. A rod's row is an equality, and nothing else acts along it.
  void setLimit(btScalar low, btScalar high);
  /// m, as setLimit set it; below 0 it is 0.
  btScalar getLowerLimit() const { return m_axis.low > 0 ? m_axis.low : Scalar(0); }
  /// m, as setLimit set it.
  btScalar getUpperLimit() const { return m_axis.high; }
  /// Makes the limit, that of a rod too, a spring and damper (document, 2.4): frequency (Hz) and
  /// damping ratio (>= 0; 1 is critical) of the bodies as they alone would swing on it. Frequency 0:
  /// rigid again.
  void setLimitSpring(btScalar frequency_hz, btScalar damping_ratio);

  /// Changes the distance at target_velocity (m/s), by at most max_impulse in a step (N s, >= 0).
  void enableMotor(bool enable, btScalar target_velocity, btScalar max_impulse);
  /// Holds a distance (m) by a spring (frequency > 0 in Hz, damping ratio >= 0) of at most max_force
  /// (N, >= 0 or infinite), until told otherwise. Takes the place of the motor.
  void setMotorServo(btScalar target_distance, btScalar frequency_hz, btScalar damping_ratio,
                     btScalar max_force);
  /// Turns the motor or servo, as it was set last, on or off.
  void enableMotor(bool enable);
  /// Whether a motor or servo is on.
  bool getEnableMotor() const { return m_axis.drive != Axis::Drive::off; }
  /// Dry friction along the distance of at most max_force (N, >= 0 or infinite). 0: none.
  void setFriction(btScalar max_force);

  ///@{
  /// Impulses of the last step (N s), positive where they push the points apart.
  btScalar getLimitImpulse() const;
  btScalar getMotorImpulse() const { return axisImpulse(0, Axis::motor); }
  btScalar getFrictionImpulse() const { return axisImpulse(0, Axis::friction); }
  ///@}

  /// The frames, and a line between the points.
  void drawJoint(btIDebugDraw& drawer) const override;
  const char* name() const override { return "DistanceJoint"; }

 private:
  friend ObservedJoint;
  // A distance has no part without its position.
  using FrameJoint::getAngularOnly;
  using FrameJoint::setAngularOnly;

  void setDefaults();
  struct Observation;
  Observation observe(const PosePair& poses) const;
  void remember(const Observation& seen, bool);
  void constrain(const Observation& seen, Rows& rows) const;
  Scalar curvature(const Observation& seen, const Rows& rows) const;
  bool rigidRod() const { return m_axis.locked() && !(m_axis.limit_spring.angular_frequency > 0); }

  Axis m_axis;                        ///< along the distance
  btVector3 m_direction = {1, 0, 0};  ///< the last one from a to b, world
  static constexpr RowCount row_count{1, 1};
};

extern template class ObservedJoint<DistanceJoint, FrameJoint>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
