// Purpose: the base of the joints that are made of two joint frames, one in each body.
#pragma once

#include <pintle/joints/standalone_joint.h>

#include <LinearMath/btTransform.h>

namespace pintle {
namespace equations {
template <class T>
struct Anchors;
}

inline namespace PINTLE_PRECISION {

/// The matrix of these columns.
inline btMatrix3x3 columns(const btVector3& x, const btVector3& y, const btVector3& z) {
  return {x.x(), y.x(), z.x(), x.y(), y.y(), z.y(), x.z(), y.z(), z.z()};
}

/// A joint of two joint frames, one in each body.
class FrameJoint : public StandaloneJoint {
 public:
  // --- as Bullet's joints have it ----------------------------------------------------------------
  ///@{
  /// The joint frames in the bodies' frames.
  btTransform& getFrameOffsetA() { return m_frame_a; }
  btTransform& getFrameOffsetB() { return m_frame_b; }
  const btTransform& getFrameOffsetA() const { return m_frame_a; }
  const btTransform& getFrameOffsetB() const { return m_frame_b; }
  ///@}

  ///@{
  /// The joint frames in the world, at the bodies' poses of now.
  btTransform getCalculatedTransformA() const {
    return m_rbA.getCenterOfMassTransform() * m_frame_a;
  }
  btTransform getCalculatedTransformB() const {
    return m_rbB.getCenterOfMassTransform() * m_frame_b;
  }
  ///@}
  /// Joint frames in the bodies' frames (m). Throws if a basis is no rotation.
  virtual void setFrames(const btTransform& frameInA, const btTransform& frameInB);

  /// No position rows: the bodies share directions only.
  void setAngularOnly(bool angularOnly) { m_angular_only = angularOnly; }
  /// What setAngularOnly set.
  bool getAngularOnly() const { return m_angular_only; }

  /// ERP and CFM: the equalities; STOP_ERP, STOP_CFM: the limits. >= 0. Axis -1, or 0 to 5: one value
  /// for all. Other axes and parameters are ignored, and read as 0. NaN and infinity are refused for
  /// all.
  void setParam(int num, btScalar value, int axis = -1) override;
  /// What setParam set; unset it is 0.
  btScalar getParam(int num, int axis = -1) const override;

  /// The two frames.
  void drawJoint(btIDebugDraw& drawer) const override;

 protected:
  /// The constructor of the joint sets the frames: only there errors know its name.
  FrameJoint(btRigidBody& a, btRigidBody& b, RowCount max_rows) : StandaloneJoint(a, b, max_rows) {}
  FrameJoint(btRigidBody& a, RowCount max_rows) : StandaloneJoint(a, max_rows) {}

  /// A right-handed basis of two unit vectors at right angles.
  static btMatrix3x3 basisOf(const btVector3& x, const btVector3& y) {
    return columns(x, y, x.cross(y));
  }
  /// The frame of b that lies where that of a is now.
  btTransform coincident(const btTransform& frameInA) const {
    return m_rbB.getCenterOfMassTransform().inverse() * m_rbA.getCenterOfMassTransform() * frameInA;
  }
  // Throw if the limit of a held axis is not 0.
  void held(const char* field, Scalar limit) const;
  void held(const char* field, const btVector3& limits) const;
  /// What a joint remembers of its frames starts anew.
  virtual void framesChanged() {}

  /// The three rows of the pivot, in the joint's formulation; none if the joint is angular only.
  void addPivotRows(const equations::Anchors<Scalar>& at, Rows& rows) const;

  btTransform m_frame_a = btTransform::getIdentity(), m_frame_b = btTransform::getIdentity();
  bool m_angular_only = false;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
