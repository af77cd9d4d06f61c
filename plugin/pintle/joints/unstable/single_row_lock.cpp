#include <pintle/joints/unstable/single_row_lock.h>

#include <pintle/body_pair.h>
#include <pintle/equations/unstable.h>
#include <pintle/frame.h>
#include <pintle/joints/unstable/single_row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

SingleRowLock::SingleRowLock(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                             const btTransform& frameInB)
    : FrameJoint(rbA, rbB, row_count) {
  setFrames(frameInA, frameInB);
}

SingleRowLock::SingleRowLock(btRigidBody& rbA, const btTransform& frameInA)
    : FrameJoint(rbA, row_count) {
  setFrames(frameInA, coincident(frameInA));
}

void SingleRowLock::addRows(const PosePair& poses, Rows& rows) const {
  const Frame a(poses.pose_a(), m_frame_a), b(poses.pose_b(), m_frame_b);
  const Vec3 d = equations::position_error(poses.x_a(), a.r(), poses.x_b(), b.r());
  const auto q_a = equations::quaternion(a.axes());
  auto q_b = equations::quaternion(b.axes());
  // Of q and -q, which are one turn, the one that is nearer.
  if (q_a.w * q_b.w + q_a.v.dot(q_b.v) < 0) q_b = {-q_b.w, -q_b.v};
  const auto row = equations::quaternion_dot_row(q_a, q_b);
  // Also a frame that its owner has spoiled.
  if (!PosePair::is_finite(d.sum() + row.J_b.sum() + row.C)) return;
  addSingleRow(row, getMaxCorrectionSpeed(), rows);
  addPivotRows({a.r(), b.r(), d}, rows);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
