// Purpose: the fixed joint (document, 3.1.3 + 3.2.3), in the place of btFixedConstraint.
#pragma once

#include <pintle/joints/frame_joint.h>

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
/// What btFixedConstraint has, under the same name. Not the setters that would free an axis, drive
/// it or put a spring on it, which it inherits from btGeneric6DofSpring2Constraint.
class FixedJoint : public FrameJoint {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Joint frames in the bodies' frames.
  FixedJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
             const btTransform& frameInB);
  /// To the world, where the frame is now.
  FixedJoint(btRigidBody& rbA, const btTransform& frameInA);

  /// STOP_ERP and STOP_CFM, as for Bullet, or ERP and CFM, which mean the same here: of all rows,
  /// >= 0. Axis -1, or 0 to 5: one value for all. Unset, the world's; ERP then reads as Bullet's 0.2.
  void setParam(int num, btScalar value, int axis = -1) override;
  btScalar getParam(int num, int axis = -1) const override;

  // --- how far off it is, of the bodies as they are now -------------------------------------------
  void calculateTransforms() {}  ///< not needed here
  /// Origin of b's frame along axis 0 to 2 of a's (m).
  btScalar getRelativePivotPosition(int axis_index) const;
  /// Euler angle 0 to 2 (x, y, z) of the frames (rad), in Bullet's sense: positive where a is turned
  /// against b; and the axis that it is about, in the world.
  btScalar getAngle(int axis_index) const;
  btVector3 getAxis(int axis_index) const;
  bool isLimited(int) const { return true; }

  /// The frames, and what Bullet draws of limits that are 0.
  void drawJoint(btIDebugDraw& drawer) const override;
  const char* name() const override { return "FixedJoint"; }
  void addRows(const BodyPair& pair, Rows& rows) const override;

 private:
  void addConditionedRows(const BodyPair& pair, const Frame& a, const Frame& b, Rows& rows) const;
  void addDocumentRows(const Mat3& F_a, const Mat3& F_b, Rows& rows) const;

  RowMemory<6> m_row_memory;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
