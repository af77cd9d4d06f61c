// Purpose: the hinge (document, 3.1.3 + 3.2.4 + 3.2.5), in the place of btHingeConstraint and
// btHingeAccumulatedAngleConstraint.
#pragma once

#include <pintle/joints/hinge_base.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// One rotation about an axis common to two bodies (HingeBase), recovered from any error: the hinge
/// to use. Its rows are the swing from one axis to the other; the document's formulation has its
/// quaternion rows, and its limit in half-sine space.
///
/// Everything that btHingeConstraint has, under the same name, with the same signs and defaults.
class QuaternionHinge : public HingeBase {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Pivots (m) and axes in the bodies' frames. Axes are made unit.
  QuaternionHinge(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
                  const btVector3& pivotInB, const btVector3& axisInA, const btVector3& axisInB,
                  bool useReferenceFrameA = false);
  /// To the world, where the body is now.
  QuaternionHinge(btRigidBody& rbA, const btVector3& pivotInA, const btVector3& axisInA,
                  bool useReferenceFrameA = false);
  /// Joint frames in the bodies' frames, z the hinge axis.
  QuaternionHinge(btRigidBody& rbA, btRigidBody& rbB, const btTransform& rbAFrame,
                  const btTransform& rbBFrame, bool useReferenceFrameA = false);
  /// To the world, as Bullet has it: the pivot where it is now, but the frame's axes as they
  /// stand in `rbAFrame`, not turned with the body.
  QuaternionHinge(btRigidBody& rbA, const btTransform& rbAFrame, bool useReferenceFrameA = false);

  const char* name() const override { return "QuaternionHinge"; }
  void addRows(const BodyPair& pair, Rows& rows) const override;

 protected:
  void prepare(const BodyPair& pair, Rows& rows) override;
  void limitChanged() override;

 private:
  void addRows(const BodyPair& pair, const Frames& at, const UnwrappedAngle& twist,
               Rows& rows) const;
  void addConditionedRows(const BodyPair& pair, const equations::Anchors<Scalar>& at,
                          const equations::Swing<Scalar>& swing, Rows& rows) const;
  void addDocumentRows(const BodyPair& pair, const equations::Anchors<Scalar>& at,
                       const UnwrappedAngle* limit, Rows& rows) const;

  Axis m_half_sine_axis;  ///< its limit alone, in the document's half-sine space
  static constexpr RowCount row_count{6, 1};
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
