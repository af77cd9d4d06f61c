// Purpose: the joint of six degrees of freedom with springs, in the place of btGeneric6DofSpringConstraint.
#pragma once

#include <pintle/joints/joint_of.h>
#include <pintle/joints/six_dof_model.h>

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
class Generic6DofSpringJoint : public JointOf<btGeneric6DofSpringConstraint, SixDofModel> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Joint frames in the bodies' frames.
  Generic6DofSpringJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                         const btTransform& frameInB, bool useLinearReferenceFrameA = true)
      : JointOf(row_count, rbA, rbB, frameInA, frameInB, useLinearReferenceFrameA) {}
  /// To the world, where the body is now. As in Bullet the body is b, and a is Bullet's fixed body.
  Generic6DofSpringJoint(btRigidBody& rbB, const btTransform& frameInB,
                         bool useLinearReferenceFrameB = true)
      : JointOf(row_count, rbB, frameInB, useLinearReferenceFrameB) {}

  ///@{
  /// Count the rows of the step, as getInfo1 does, and write them at other poses of the bodies; no more than were counted. The velocities
  /// are the bodies' own, whatever is given.
  void getInfo1NonVirtual(btTypedConstraint::btConstraintInfo1* info) {
    Generic6DofSpringJoint::getInfo1(info);
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
  btScalar getSpringImpulse(int axis) const { return springImpulse(anyAxis(axis)); }
  ///@}
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
