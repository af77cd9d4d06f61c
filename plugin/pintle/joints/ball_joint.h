// Purpose: the ball joint (document, 3.1.3), in the place of btPoint2PointConstraint.
#pragma once

#include <pintle/joints/standalone_joint.h>

#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A point of each body coincide; rotation is free.
///
/// Everything that btPoint2PointConstraint has, under the same name, with the same signs and defaults.
/// The document's formulation holds each body at its own anchor; the conditioned one holds both at
/// the same point, and so conserves angular momentum while the joint is violated, as long as neither turns by
/// more than a tenth of a radian in a step.
///
/// \image html ball_joint.svg
class BallJoint : public StandaloneJoint {
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

  /// m, in the frame of body a.
  void setPivotA(const btVector3& pivotA) { m_pivot_a = point("pivotA", pivotA); }
  /// m, in the frame of body b.
  void setPivotB(const btVector3& pivotB) { m_pivot_b = point("pivotB", pivotB); }
  /// m, in the frame of body a.
  const btVector3& getPivotInA() const { return m_pivot_a; }
  /// m, in the frame of body b.
  const btVector3& getPivotInB() const { return m_pivot_b; }

  /// As Bullet's: m_damping is the part of the velocity that the joint takes away (1: all of it),
  /// m_impulseClamp > 0 the most that each world axis may apply in a step (N s), m_tau is not used.
  btConstraintSetting m_setting;
  /// As in Bullet without effect.
  bool m_useSolveConstraintObsolete = false;

  /// ERP (and STOP_ERP), CFM (and STOP_CFM): both >= 0. Axis -1. As in Bullet other axes and
  /// parameters are ignored, and read as SIMD_INFINITY. NaN and infinity are refused for all.
  void setParam(int num, btScalar value, int axis = -1) override;
  /// What setParam set; unset it is 0.
  btScalar getParam(int num, int axis = -1) const override;
  /// BT_P2P_FLAGS_* of the parameters that were set.
  virtual int getFlags() const {
    return (m_erp.isSet() ? BT_P2P_FLAGS_ERP : 0) | (m_cfm.isSet() ? BT_P2P_FLAGS_CFM : 0);
  }

  /// The rows at other poses of the bodies; no more than getInfo1 announced.
  void getInfo2NonVirtual(btConstraintInfo2* info, const btTransform& body0_trans,
                          const btTransform& body1_trans) {
    writeRowsAt(*info, body0_trans, body1_trans);
  }

  /// The two pivots.
  void drawJoint(btIDebugDraw& drawer) const override;
  const char* name() const override { return "BallJoint"; }
  void addRows(const PosePair& poses, Rows& rows) const override;

 protected:
  // The setting is open: what is no number is no setting.
  ImpulseSetting impulseSetting() const override {
    const Scalar damping = m_setting.m_damping, clamp = m_setting.m_impulseClamp;
    return {damping - damping == 0 ? damping : Scalar(1), clamp > 0 ? clamp : infinity};
  }

 private:
  btVector3 m_pivot_a, m_pivot_b;
  static constexpr RowCount row_count{3};
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
