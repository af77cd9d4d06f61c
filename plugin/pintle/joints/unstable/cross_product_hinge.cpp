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

void CrossProductHinge::addRows(const BodyPair& pair, Rows& rows) const {
  const Frame a(pair.pose_a(), m_frame_a), b(pair.pose_b(), m_frame_b);
  const Vec3 d = equations::position_error(pair.x_a(), a.r(), pair.x_b(), b.r());
  const auto row = equations::cross_product_row(a.c(), b.c());
  // Also a frame that its owner has spoiled.
  if (!BodyPair::is_finite(d.sum() + row.J_b.sum())) return;
  addSingleRow(row, getMaxCorrectionSpeed(), rows);
  addPivotRows(pair, {a.r(), b.r(), d}, rows);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
