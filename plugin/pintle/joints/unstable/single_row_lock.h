// Purpose: the lock of one quaternion row (document, 3.1.3 + 3.3.3), for comparison.
#pragma once

#include <pintle/joints/frame_joint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Not for use: FixedJoint is the lock. One row (3.61) takes the place of three, along the error of the
/// orientation. Where there is no error there is no row, and whatever turns the bodies is answered a
/// step late; across the error nothing is held, so that it goes round instead of away.
///
/// \image html single_row_lock.svg
class SingleRowLock : public FrameJoint {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Joint frames in the bodies' frames.
  SingleRowLock(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                const btTransform& frameInB);
  /// To the world, where the frame is now.
  SingleRowLock(btRigidBody& rbA, const btTransform& frameInA);

  const char* name() const override { return "SingleRowLock"; }
  void addRows(const PosePair& poses, Rows& rows) const override;

 private:
  static constexpr RowCount row_count{4};
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
