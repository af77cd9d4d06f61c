// Purpose: the ball joint (document, 3.1.3), in the place of btPoint2PointConstraint.
#pragma once

#include <pintle/joints/driven_joint.h>
#include <pintle/joints/joint_of.h>

#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

class Complaints;

/// Settings of a ball joint.
struct BallSettings {
  btVector3 pivot_a;       ///< m, in body a's frame
  btVector3 pivot_b;       ///< m, in body b's frame
  ImpulseSetting impulse;  ///< damping and bound of the rows
};

/// A ball joint of Bullet's as Pintle holds it: a point of each body coincide.
class BallModel : public DrivenJoint {
 public:
  static constexpr RowCount row_count{3};  ///< the most that it has

  /// Reads this constraint of Bullet's, which it is a part of, or which it stands for.
  BallModel(btPoint2PointConstraint& ball, RowCount max_rows);

  const char* name() const override { return "BallJoint"; }
  void addRows(const PosePair& poses, Rows& rows) const override;
  /// The two pivots.
  void drawJoint(btIDebugDraw& drawer) const override;

 protected:
  static int rowsOfStock(const btPoint2PointConstraint&) { return row_count.rows; }
  ImpulseSetting impulseSetting() const override { return m_settings.impulse; }
  DriveRoom driveRoom() const override { return {{6, 3}, 0}; }
  void prepare(const PosePair& poses, Rows& rows) override;

 private:
  const btPoint2PointConstraint& ball() const;
  void read(Complaints* complaints) override;
  void addDrive(const PosePair& poses, Rows& rows) const;

  BallSettings m_settings;
};

/// A point of each body coincide; rotation is free, or driven to a pose (setPoseDrive), which is that of body b's own axes in body a's.
///
/// It is a btPoint2PointConstraint: everything of that is Bullet's own, but for the rows. Of m_setting m_damping is the part
/// of the velocity that the joint takes away (1: all of it), m_impulseClamp > 0 the most that each world axis may apply in a
/// step (N s); m_tau is not used. A number that is not finite is not used: the last good one stays (Joint::whyIgnored).
///
/// The document's formulation holds each body at its own anchor; the conditioned one holds both at
/// the same point, and so conserves angular momentum while the joint is violated, as long as neither turns by
/// more than a tenth of a radian in a step.
///
/// \image html ball_joint.svg
class BallJoint : public JointOf<btPoint2PointConstraint, BallModel> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Pivots (m) in the bodies' frames.
  BallJoint(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
            const btVector3& pivotInB);
  /// To the world, where the pivot is now.
  BallJoint(btRigidBody& rbA, const btVector3& pivotInA);
  /// The pivots are the origins of joint frames.
  BallJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
            const btTransform& frameInB);
  /// To the world, where the frame is now.
  BallJoint(btRigidBody& rbA, const btTransform& frameInA);
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
