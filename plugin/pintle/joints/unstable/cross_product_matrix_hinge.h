// Purpose: the hinge of three cross product rows (document, 3.1.3 + 3.3.2), for comparison.
#pragma once

#include <pintle/joints/frame_joint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Not for use: QuaternionHinge is the hinge. Three rows (3.55) take the place of two, so that where they
/// hold one says nothing new and their effective mass has no inverse (as a block, the row that depends
/// on the others is left as it is). Where they do not hold, that row also keeps both bodies from turning
/// together: it takes their angular momentum away. From 90 degrees apart they pull the axes to 180.
///
/// \image html cross_product_matrix_hinge.svg
class CrossProductMatrixHinge : public FrameJoint {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Joint frames in the bodies' frames, z the hinge axis.
  CrossProductMatrixHinge(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                          const btTransform& frameInB);
  /// To the world, where the frame is now.
  CrossProductMatrixHinge(btRigidBody& rbA, const btTransform& frameInA);

  const char* name() const override { return "CrossProductMatrixHinge"; }
  void addRows(const PosePair& poses, Rows& rows) const override;

 private:
  static constexpr RowCount row_count{6};
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
