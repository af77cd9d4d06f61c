// Purpose: the joint of six degrees of freedom with springs, in the place of btGeneric6DofSpringConstraint.
#pragma once

#include <pintle/joints/six_dof_of.h>

#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpringConstraint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A Generic6DofJoint with a spring along each axis that has one (enableSpring), beside its limits; a locked one has none, and one with
/// a spring has no motor, as in Bullet.
///
/// The stiffness is what is set (N/m, or N m/rad, >= 0), whatever the step: one body on one spring moves by the implicit Euler rule, and
/// sags by m g / k. It rests where Bullet's rests, at the equilibrium point without a load. Damping is a number from 0 to 1, 1 is none, as
/// in Bullet, which bounds by it how fast a spring may go back. Here it is a damper, of the decay that Bullet's has at 60 Hz
/// and 10 iterations where that is stable: with d the damping, m the mass that the coordinate moves, w = sqrt(k / m) and
/// r = (w / (6 d k))^2, 6 in 1 / (kg s), the damper is 2 z sqrt(k m), with
/// - pi z / sqrt(1 - z^2) = artanh(r) for r < 1;
/// - z = (sqrt(r) + 1 / sqrt(r)) / 2 for r >= 1.
///
/// Bullet's object is the only place of its settings: what any pointer writes there, setters or fields, holds in the next step. A number that
/// is not finite is not used: the last good one stays (Joint::whyIgnored). Motors and springs are read only where they are on.
///
/// \image html generic_6dof_spring_joint.svg
class Generic6DofSpringJoint : public Generic6DofOf<btGeneric6DofSpringConstraint> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  using Generic6DofOf::Generic6DofOf;

  // --- beyond Bullet -----------------------------------------------------------------------------
  /// Impulse of its spring in the last step along axis 0 to 5, as getLimitImpulse has it.
  btScalar getSpringImpulse(int axis) const { return springImpulse(anyAxis(axis)); }
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
