#include <pintle/joints/posed_joint.h>

#include <pintle/body_pair.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

void PosedJoint::calculateTransforms(const btTransform& transA, const btTransform& transB) {
  if (!m_poses) m_poses = std::make_unique<Poses>();
  m_poses->a = transA;
  m_poses->b = transB;
  m_reads_poses = true;
}

BodyPair PosedJoint::seenPair() const { return {m_rbA, seenPoseOfA(), m_rbB, seenPoseOfB()}; }

}  // namespace PINTLE_PRECISION
}  // namespace pintle
