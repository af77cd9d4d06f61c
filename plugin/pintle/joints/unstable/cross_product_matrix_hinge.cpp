#include <pintle/joints/unstable/cross_product_matrix_hinge.h>

#include <pintle/body_pair.h>
#include <pintle/equations/unstable.h>
#include <pintle/frame.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

CrossProductMatrixHinge::CrossProductMatrixHinge(btRigidBody& rbA, btRigidBody& rbB,
                                                 const btTransform& frameInA,
                                                 const btTransform& frameInB)
    : FrameJoint(rbA, rbB, row_count) {
  setFrames(frameInA, frameInB);
}

CrossProductMatrixHinge::CrossProductMatrixHinge(btRigidBody& rbA, const btTransform& frameInA)
    : FrameJoint(rbA, row_count) {
  setFrames(frameInA, coincident(frameInA));
}

void CrossProductMatrixHinge::addRows(const PosePair& poses, Rows& rows) const {
  const Frame a(poses.pose_a(), m_frame_a), b(poses.pose_b(), m_frame_b);
  const Vec3 d = equations::position_error(poses.x_a(), a.r(), poses.x_b(), b.r());
  const Vec3 c_a = a.c(), c_b = b.c(), x = cross(c_a, c_b);
  // Also a frame that its owner has spoiled.
  if (!PosePair::is_finite(d.sum() + x.sum())) return;
  // Along the error the rows turn 1/cos(swing) times as fast as they say.
  const Scalar sine = std::sqrt(x.dot(x));
  const Scalar speed_per_error =
      sine > 0 ? getMaxCorrectionSpeed() * std::abs(c_a.dot(c_b)) / sine : Scalar(0);
  for (int i = 0; i < 3; ++i) {
    const auto row = equations::cross_product_matrix_row<Scalar>(Vec3::Unit(i), c_a, c_b);
    rows.addEquality(row.J.L, row.J.A_a, row.J.A_b, row.C).max_speed =
        speed_per_error * std::abs(row.C);
  }
  addPivotRows({a.r(), b.r(), d}, rows);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
