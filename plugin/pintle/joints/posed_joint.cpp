#include <pintle/joints/posed_joint.h>

#include <pintle/body_pair.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

void PosedJoint::calculateTransforms(const btTransform& transA, const btTransform& transB) {
  m_seen_poses.set(transA, transB);
}

BodyPair PosedJoint::seenPair() const { return {m_rbA, seenPoseOfA(), m_rbB, seenPoseOfB()}; }

}  // namespace PINTLE_PRECISION
}  // namespace pintle
