// Purpose: the base of the joints whose readings Bullet's clients ask for at poses that the bodies are not at.
#pragma once

#include <pintle/joints/frame_joint.h>
#include <pintle/joints/seen_poses.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A joint that can say what holds at other poses of its bodies than theirs of now.
class PosedJoint : public FrameJoint {
 public:
  /// What the joint says of itself (frames, position, angles) is from here on what holds at these poses
  /// of the bodies (world), until the next step, new frames or the subclass's calculateTransforms():
  /// else it is what holds now.
  void calculateTransforms(const btTransform& transA, const btTransform& transB);
  ///@{
  /// The joint frames in the world.
  btTransform getCalculatedTransformA() const { return seenPoseOfA() * m_frame_a; }
  btTransform getCalculatedTransformB() const { return seenPoseOfB() * m_frame_b; }
  ///@}

 protected:
  using FrameJoint::FrameJoint;

  /// In each step, and with new frames.
  void forgetPoses() { m_seen_poses.forget(); }
  bool readsPoses() const { return m_seen_poses.given(); }
  BodyPair seenPair() const;

 private:
  const btTransform& seenPoseOfA() const {
    return m_seen_poses.a(m_rbA.getCenterOfMassTransform());
  }
  const btTransform& seenPoseOfB() const {
    return m_seen_poses.b(m_rbB.getCenterOfMassTransform());
  }

  SeenPoses m_seen_poses;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
