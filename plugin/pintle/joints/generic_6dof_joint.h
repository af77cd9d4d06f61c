// Purpose: the joint of six degrees of freedom, in the place of btGeneric6DofConstraint.
#pragma once

#include <pintle/joints/joint_of.h>
#include <pintle/joints/six_dof_model.h>

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
/// Of Bullet's fields these have an effect:
/// - limits of any axis; m_bounce (>= 0) of an angle: the part of its speed that a limit sends back;
/// - m_enableMotor, m_targetVelocity (rad/s; m/s, of a against b, as in Bullet), m_maxMotorForce (N m or N, >= 0; before Bullet 2.89
///   an impulse a step);
/// - STOP_ERP and STOP_CFM (setParam, >= 0): of a limit or a locked axis; CFM: of a motor.
///
/// The others are kept to be read, as in Bullet. The positions are along frame a, whatever useLinearReferenceFrameA says: that has an effect
/// on Bullet's obsolete solver alone.
///
/// \image html generic_6dof_joint.svg
class Generic6DofJoint : public JointOf<btGeneric6DofConstraint, SixDofModel> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Joint frames in the bodies' frames.
  Generic6DofJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                   const btTransform& frameInB, bool useLinearReferenceFrameA = true)
      : JointOf(row_count, rbA, rbB, frameInA, frameInB, useLinearReferenceFrameA) {}
  /// To the world, where the body is now. As in Bullet the body is b, and a is Bullet's fixed body.
  Generic6DofJoint(btRigidBody& rbB, const btTransform& frameInB,
                   bool useLinearReferenceFrameB = true)
      : JointOf(row_count, rbB, frameInB, useLinearReferenceFrameB) {}

  ///@{
  /// Count the rows of the step, as getInfo1 does, and write them at other poses of the bodies; no more than were counted. The velocities
  /// are the bodies' own, whatever is given.
  void getInfo1NonVirtual(btTypedConstraint::btConstraintInfo1* info) {
    Generic6DofJoint::getInfo1(info);
  }
  void getInfo2NonVirtual(btTypedConstraint::btConstraintInfo2* info, const btTransform& transA,
                          const btTransform& transB, const btVector3&, const btVector3&,
                          const btVector3&, const btVector3&) {
    writeRowsAt(*info, transA, transB);
  }
  ///@}

  // --- beyond Bullet -----------------------------------------------------------------------------
  ///@{
  /// Bullet hides those that are not const.
  using btTypedConstraint::getRigidBodyA;
  using btTypedConstraint::getRigidBodyB;
  ///@}
  /// rad: the Euler angle about axis 3 to 5, with all turns since it was last locked, freed, or measured about other axes.
  btScalar getAccumulatedAngle(int axis) {
    angleAxis(axis);
    return accumulatedAngle(axis);
  }
  ///@{
  /// Impulses of the last step along axis 0 to 5 (N s or N m s), positive along the coordinate. A locked axis has none of its own. Those of the
  /// outer two of three free angles are torques about Bullet's getAxis.
  btScalar getLimitImpulse(int axis) const { return axisImpulse(anyAxis(axis), Axis::limit); }
  btScalar getMotorImpulse(int axis) const { return axisImpulse(anyAxis(axis), Axis::motor); }
  ///@}
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
