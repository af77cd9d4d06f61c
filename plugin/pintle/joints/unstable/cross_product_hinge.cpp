#include <pintle/joints/unstable/cross_product_hinge.h>

#include <pintle/body_pair.h>
#include <pintle/equations/unstable.h>
#include <pintle/frame.h>
#include <pintle/joints/unstable/single_row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

CrossProductHinge::CrossProductHinge(btRigidBody& rbA, btRigidBody& rbB,
                                     const btTransform& frameInA, const btTransform& frameInB)
    : FrameJoint(rbA, rbB, row_count) {
  setFrames(frameInA, frameInB);
}

CrossProductHinge::CrossProductHinge(btRigidBody& rbA, const btTransform& frameInA)
    : FrameJoint(rbA, row_count) {
  setFrames(frameInA, coincident(frameInA));
}

void CrossProductHinge::addRows(const PosePair& poses, Rows& rows) const {
  const Frame a(poses.pose_a(), m_frame_a), b(poses.pose_b(), m_frame_b);
  const Vec3 d = equations::position_error(poses.x_a(), a.r(), poses.x_b(), b.r());
  const auto row = equations::cross_product_row(a.c(), b.c());
  // Also a frame that its owner has spoiled.
  if (!PosePair::is_finite(d.sum() + row.J_b.sum())) return;
  addSingleRow(row, getMaxCorrectionSpeed(), rows);
  addPivotRows({a.r(), b.r(), d}, rows);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
