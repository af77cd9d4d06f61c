// Purpose: the hinge by dot products (document, 3.1.3 + 3.2.1).
#pragma once

#include <pintle/joints/hinge_base.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A hinge whose axis rows (3.16) keep the axis of a normal to two tangents of that of b. They are as
/// good as any while the axes are close. From 90 degrees apart they are stuck, and beyond they pull
/// the axes to 180: QuaternionHinge is the conditioned form of this joint. setFormulation is about the
/// rows of the pivot only.
///
/// The angle, its limit, motor, servo and friction: HingeBase.
class DotHinge : public HingeBase {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// As those of QuaternionHinge.
  DotHinge(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA, const btVector3& pivotInB,
           const btVector3& axisInA, const btVector3& axisInB, bool useReferenceFrameA = false);
  DotHinge(btRigidBody& rbA, const btVector3& pivotInA, const btVector3& axisInA,
           bool useReferenceFrameA = false);
  DotHinge(btRigidBody& rbA, btRigidBody& rbB, const btTransform& rbAFrame,
           const btTransform& rbBFrame, bool useReferenceFrameA = false);
  DotHinge(btRigidBody& rbA, const btTransform& rbAFrame, bool useReferenceFrameA = false);

  const char* name() const override { return "DotHinge"; }
  void addRows(const BodyPair& pair, Rows& rows) const override;

 protected:
  void prepare(const BodyPair& pair, Rows& rows) override;

 private:
  void addRows(const BodyPair& pair, const Frames& at, const UnwrappedAngle& twist,
               Rows& rows) const;

  static constexpr RowCount row_count{6, 1};
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
