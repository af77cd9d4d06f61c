// Purpose: the joint of six degrees of freedom, in the place of btGeneric6DofConstraint.
#pragma once

#include <pintle/joints/six_dof_of.h>

#include <BulletDynamics/ConstraintSolver/btGeneric6DofConstraint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Each of six axes is locked (lower limit = upper limit), limited, or free (lower > upper): the position of frame b along x, y and z of
/// frame a (axes 0 to 2, m), and the Euler angles of a against b (axes 3 to 5, rad).
///
/// A locked axis always holds, at any value. How a rotation is held depends on what is locked of it: three angles as in FixedJoint; two
/// as in a hinge, whose angle counts its turns; one as in UniversalJoint; none: limits are those of the Euler angles, of which the middle
/// one (y) should stay within 80 degrees if another one is limited. Farther, from 85 degrees on, where Euler angles are no coordinates, each
/// limit keeps the direction that it had: nothing jumps, and what was held stays held. An angular limit of (-pi, pi), within 1e-5, is
/// free, and so is a range of a turn or more.
///
/// Bullet's object is the only place of its settings: what any pointer writes there, setters or fields, holds in the next step. A number that
/// is not finite is not used: the last good one stays (Joint::whyIgnored). Motors and springs are read only where they are on.
///
/// Fields of Bullet's that have an effect:
/// - limits of any axis; m_bounce (>= 0) of an angle: the part of its speed that a limit sends back;
/// - m_enableMotor, m_targetVelocity (rad/s; m/s, of a against b, as in Bullet), m_maxMotorForce (N m or N, >= 0; before Bullet 2.89
///   an impulse a step);
/// - STOP_ERP and STOP_CFM (setParam, >= 0): of a limit or a locked axis; CFM: of a motor.
///
/// The others are kept to be read, as in Bullet. The positions are along frame a, whatever useLinearReferenceFrameA says: that has an effect
/// on Bullet's obsolete solver alone.
///
/// \image html generic_6dof_joint.svg
class Generic6DofJoint : public Generic6DofOf<btGeneric6DofConstraint> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  using Generic6DofOf::Generic6DofOf;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
