// Purpose: the joint of six degrees of freedom with springs, servos and an order of its angles, in the place of
// btGeneric6DofSpring2Constraint.
#pragma once

#include <pintle/joints/six_dof_of.h>

#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// As Generic6DofJoint, and its Euler angles are those of a RotateOrder, whose second letter is the middle one.
///
/// Along each axis that is not locked there may be, each beside the others:
/// - a limit, with a bounce (>= 0);
/// - a spring (enableSpring): stiffness (N/m, or N m/rad, >= 0) and damping (N s/m, or N m s/rad, >= 0) are what is set, at any step: one
///   body on one spring moves by the implicit Euler rule, and sags by m g / k. Limiting them (`limitIfNeeded`) is not needed and has no
///   effect; it is kept to be read;
/// - a motor (enableMotor) of a target velocity (m/s of a against b, as in Bullet, or rad/s) and a bound (N or N m, >= 0), or with setServo a
///   servo, which goes to its target at that speed at most, angles by the nearest way, and stays there.
///
/// STOP_ERP and STOP_CFM are those of a limit or a locked axis, CFM that of the motor, and ERP how a motor slows down before a limit or a
/// servo before its target.
///
/// Bullet's object is the only place of its settings: what any pointer writes there, setters or fields, holds in the next step. A number that
/// is not finite is not used: the last good one stays (Joint::whyIgnored). Motors and springs are read only where they are on.
///
/// \image html generic_6dof_spring_2_joint.svg
class Generic6DofSpring2Joint : public SixDofOf<btGeneric6DofSpring2Constraint> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Joint frames in the bodies' frames.
  Generic6DofSpring2Joint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                          const btTransform& frameInB, RotateOrder rotOrder = RO_XYZ)
      : SixDofOf(rbA, rbB, frameInA, frameInB, rotOrder) {}
  /// To the world, where the body is now. As in Bullet the body is b, and a is Bullet's fixed body.
  Generic6DofSpring2Joint(btRigidBody& rbB, const btTransform& frameInB,
                          RotateOrder rotOrder = RO_XYZ)
      : SixDofOf(rbB, frameInB, rotOrder) {}

  // --- beyond Bullet -----------------------------------------------------------------------------
  /// Impulse of its spring in the last step along axis 0 to 5, as getLimitImpulse has it.
  btScalar getSpringImpulse(int axis) const { return springImpulse(anyAxis(axis)); }
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
