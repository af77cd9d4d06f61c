// Purpose: the classes of hinges: a hinge of Bullet's with rows of Pintle's.
#pragma once

#include <pintle/joints/hinge_base.h>
#include <pintle/joints/hinge_model.h>
#include <pintle/joints/joint_of.h>
#include <pintle/joints/observed_joint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// `Self` has its name and the number of its rows, joint_name and row_count. `Model` has its rows: Self itself, by what ObservedJoint
/// asks for, unless it is another class.
template <class Self, class Model = ObservedJoint<Self, HingeModel>>
class HingeOf : public JointOf<HingeBase, Model> {
 public:
  /// Pivots (m) and axes in the bodies' frames. Axes are made unit.
  HingeOf(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA, const btVector3& pivotInB,
          const btVector3& axisInA, const btVector3& axisInB, bool useReferenceFrameA = false)
      : JointOf<HingeBase, Model>(Self::row_count, rbA, rbB, pivotInA, pivotInB,
                                  HingeBase::unit(axisInA), HingeBase::unit(axisInB),
                                  useReferenceFrameA) {
    this->clear();
    this->straightenFrames();
  }
  /// To the world, where the body is now.
  HingeOf(btRigidBody& rbA, const btVector3& pivotInA, const btVector3& axisInA,
          bool useReferenceFrameA = false)
      : JointOf<HingeBase, Model>(Self::row_count, rbA, pivotInA, HingeBase::unit(axisInA),
                                  useReferenceFrameA) {
    this->clear();
    this->straightenFrames();
  }
  /// Joint frames in the bodies' frames, z the hinge axis.
  HingeOf(btRigidBody& rbA, btRigidBody& rbB, const btTransform& rbAFrame,
          const btTransform& rbBFrame, bool useReferenceFrameA = false)
      : JointOf<HingeBase, Model>(Self::row_count, rbA, rbB, rbAFrame, rbBFrame,
                                  useReferenceFrameA) {
    this->clear();
  }
  /// To the world, as Bullet has it: the pivot where it is now, but the frame's axes as they
  /// stand in `rbAFrame`, not turned with the body.
  HingeOf(btRigidBody& rbA, const btTransform& rbAFrame, bool useReferenceFrameA = false)
      : JointOf<HingeBase, Model>(Self::row_count, rbA, rbAFrame, useReferenceFrameA) {
    this->clear();
  }

  /// The type's name, as errors say it.
  const char* name() const override { return Self::joint_name; }

 private:
  HingeModel& model() override { return *this; }
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
