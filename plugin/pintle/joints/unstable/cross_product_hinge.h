// Purpose: the hinge of one cross product row (document, 3.1.3 + 3.3.1), for comparison.
#pragma once

#include <pintle/joints/frame_joint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Not for use: QuaternionHinge is the hinge. One row (3.52) takes the place of two, along the error of
/// the axes. Where the axes are parallel there is none, and whatever pushes them apart is answered a
/// step late; across the error nothing is held, so that it goes round instead of away. At 90 degrees
/// the row is nothing too, and beyond it pulls the axes to 180.
///
/// \image html cross_product_hinge.svg
class CrossProductHinge : public FrameJoint {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Joint frames in the bodies' frames, z the hinge axis.
  CrossProductHinge(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                    const btTransform& frameInB);
  /// To the world, where the frame is now.
  CrossProductHinge(btRigidBody& rbA, const btTransform& frameInA);

  const char* name() const override { return "CrossProductHinge"; }
  void addRows(const PosePair& poses, Rows& rows) const override;

 private:
  static constexpr RowCount row_count{4};
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
