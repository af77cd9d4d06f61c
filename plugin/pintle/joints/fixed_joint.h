// Purpose: the fixed joint (document, 3.1.3 + 3.2.3), in the place of btFixedConstraint.
#pragma once

#include <pintle/joints/posed_joint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

class Frame;

/// Two joint frames, one in each body, coincide: nothing is free. Recovers from any error, by the
/// shortest turn and at a bounded speed (setMaxCorrectionSpeed).
///
/// Conditioned: three rows along the world's axes whose error is the rotation vector from frame to
/// frame. The document's formulation has its quaternion rows (3.24), which correct nothing at
/// exactly 180 degrees.
///
/// What btFixedConstraint has, under the same name. Not the setters that would drive an axis or put a
/// spring on it, which it inherits from btGeneric6DofSpring2Constraint.
///
/// \image html fixed_joint.svg
class FixedJoint : public PosedJoint {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Joint frames in the bodies' frames.
  FixedJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
             const btTransform& frameInB);
  /// To the world, where the frame is now.
  FixedJoint(btRigidBody& rbA, const btTransform& frameInA);

  /// STOP_ERP and STOP_CFM of axis 0 to 5: one value for all rows, >= 0. Unset, the world's; STOP_ERP
  /// then reads as Bullet's 0.2. As in Bullet ERP and CFM of axis 0 to 5 are those of motors, kept to
  /// be read (at first 0.9 and 0), and other axes (-1 too) and parameters are ignored, and read as 0.
  /// NaN and infinity are refused for all.
  void setParam(int num, btScalar value, int axis = -1) override;
  /// What setParam set.
  btScalar getParam(int num, int axis = -1) const override;

  // --- how far off it is, of the bodies as they are now -------------------------------------------
  using PosedJoint::calculateTransforms;
  void calculateTransforms() { forgetPoses(); }  ///< as they are now
  /// Origin of b's frame along axis 0 to 2 of a's (m).
  btScalar getRelativePivotPosition(int axis_index) const;
  ///@{
  /// Euler angle 0 to 2 (x, y, z) of the frames (rad), in Bullet's sense: positive where a is turned
  /// against b; and the axis that it is about, in the world.
  btScalar getAngle(int axis_index) const;
  btVector3 getAxis(int axis_index) const;
  ///@}

  /// Always.
  bool isLimited(int) const { return true; }
  ///@{
  /// All limits are 0, and can be set to nothing else.
  void setLimit(int axis, btScalar lo, btScalar hi);
  void setLinearLowerLimit(const btVector3& linearLower);
  void setLinearUpperLimit(const btVector3& linearUpper);
  void setAngularLowerLimit(const btVector3& angularLower);
  void setAngularUpperLimit(const btVector3& angularUpper);
  void getLinearLowerLimit(btVector3& linearLower) const { linearLower.setZero(); }
  void getLinearUpperLimit(btVector3& linearUpper) const { linearUpper.setZero(); }
  void getAngularLowerLimit(btVector3& angularLower) const { angularLower.setZero(); }
  void getAngularUpperLimit(btVector3& angularUpper) const { angularUpper.setZero(); }
  ///@}

  /// The frames, and what Bullet draws of limits that are 0.
  void drawJoint(btIDebugDraw& drawer) const override;
  const char* name() const override { return "FixedJoint"; }
  void addRows(const PosePair& poses, Rows& rows) const override;

 protected:
  void updateState(const PosePair&) override { forgetPoses(); }
  void framesChanged() override { forgetPoses(); }

 private:
  void addConditionedRows(const Frame& a, const Frame& b, Rows& rows) const;
  void addDocumentRows(const Frame& a, const Frame& b, Rows& rows) const;

  struct MotorParameters {
    Scalar erp = Scalar(0.9f), cfm = 0;
  };
  MotorParameters m_motor_parameters[6];  ///< to be read
  static constexpr RowCount row_count{6};
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
