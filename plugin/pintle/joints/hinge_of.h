// Purpose: what the hinges have in common beside HingeBase: their constructors, and the way from a pose to rows.
#pragma once

#include <pintle/joints/hinge_base.h>
#include <pintle/joints/observed_joint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// `Self` has its name and the number of its rows, joint_name and row_count, and what ObservedJoint asks for. (The constructors
/// are here, where errors know the joint's name.)
template <class Self>
class HingeOf : public ObservedJoint<Self, HingeBase> {
 public:
  /// Pivots (m) and axes in the bodies' frames. Axes are made unit.
  HingeOf(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA, const btVector3& pivotInB,
          const btVector3& axisInA, const btVector3& axisInB, bool useReferenceFrameA = false);
  /// To the world, where the body is now.
  HingeOf(btRigidBody& rbA, const btVector3& pivotInA, const btVector3& axisInA,
          bool useReferenceFrameA = false);
  /// Joint frames in the bodies' frames, z the hinge axis.
  HingeOf(btRigidBody& rbA, btRigidBody& rbB, const btTransform& rbAFrame,
          const btTransform& rbBFrame, bool useReferenceFrameA = false);
  /// To the world, as Bullet has it: the pivot where it is now, but the frame's axes as they
  /// stand in `rbAFrame`, not turned with the body.
  HingeOf(btRigidBody& rbA, const btTransform& rbAFrame, bool useReferenceFrameA = false);

  /// The type's name, as errors say it.
  const char* name() const override { return Self::joint_name; }
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
