// Purpose: the classes of joints of six degrees of freedom: one of Bullet's with rows of Pintle's, and what all of them have beside Bullet's methods.
#pragma once

#include <pintle/joints/joint_of.h>
#include <pintle/joints/six_dof_model.h>

#include <utility>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A joint of Bullet's class `Stock` with the rows of SixDofModel.
template <class Stock>
class SixDofOf : public JointOf<Stock, SixDofModel> {
 public:
  ///@{
  /// Bullet hides those that are not const.
  using btTypedConstraint::getRigidBodyA;
  using btTypedConstraint::getRigidBodyB;
  ///@}
  /// rad: the Euler angle about axis 3 to 5, with all turns since it was last locked, freed, or measured about other axes.
  btScalar getAccumulatedAngle(int axis) {
    this->angleAxis(axis);
    return this->accumulatedAngle(axis);
  }
  /// Impulse of the limit of axis 0 to 5 in the last step (N s or N m s), positive along the coordinate. A locked axis has none of its own. That of
  /// one of the outer two of three free angles is a torque about Bullet's getAxis.
  btScalar getLimitImpulse(int axis) const {
    return this->axisImpulse(this->anyAxis(axis), Axis::limit);
  }
  /// The same of its motor.
  btScalar getMotorImpulse(int axis) const {
    return this->axisImpulse(this->anyAxis(axis), Axis::motor);
  }

 protected:
  /// `arguments`: those of a constructor of Stock.
  template <class... Arguments>
  explicit SixDofOf(Arguments&&... arguments)
      : JointOf<Stock, SixDofModel>(SixDofModel::row_count, std::forward<Arguments>(arguments)...) {
  }
};

/// The same of btGeneric6DofConstraint and the class with springs that derives from it, which have the same constructors.
template <class Stock>
class Generic6DofOf : public SixDofOf<Stock> {
 public:
  /// Joint frames in the bodies' frames.
  Generic6DofOf(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                const btTransform& frameInB, bool useLinearReferenceFrameA = true)
      : SixDofOf<Stock>(rbA, rbB, frameInA, frameInB, useLinearReferenceFrameA) {}
  /// To the world, where the body is now. As in Bullet the body is b, and a is Bullet's fixed body.
  Generic6DofOf(btRigidBody& rbB, const btTransform& frameInB, bool useLinearReferenceFrameB = true)
      : SixDofOf<Stock>(rbB, frameInB, useLinearReferenceFrameB) {}

  /// Counts the rows of the step, as getInfo1 does.
  void getInfo1NonVirtual(btTypedConstraint::btConstraintInfo1* info) {
    Generic6DofOf::getInfo1(info);
  }
  /// Writes them at other poses of the bodies, no more than were counted. The velocities are the bodies' own, whatever is given.
  void getInfo2NonVirtual(btTypedConstraint::btConstraintInfo2* info, const btTransform& transA,
                          const btTransform& transB, const btVector3&, const btVector3&,
                          const btVector3&, const btVector3&) {
    this->writeRowsAt(*info, transA, transB);
  }
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
