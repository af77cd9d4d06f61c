// Purpose: the suspension of a wheel, in the place of btHinge2Constraint.
#pragma once

#include <pintle/joints/six_dof_of.h>

#include <BulletDynamics/ConstraintSolver/btHinge2Constraint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A wheel (b) that turns about axis 2, which is x of its frame, on a body (a) against which it is steered about axis 1, which is z of
/// that body's, within +-45 degrees, and sprung along the same, within +-1 m: 4 pi^2 N/m and 0.01 N s/m. It is a
/// Generic6DofSpring2Joint with these settings at first, and all of them can be changed.
///
/// Bullet's object is the only place of its settings: what any pointer writes there, setters or fields, holds in the next step. A number that
/// is not finite is not used: the last good one stays (Joint::whyIgnored). Motors and springs are read only where they are on.
///
/// \image html hinge_2_joint.svg
class Hinge2Joint : public SixDofOf<btHinge2Constraint> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Anchor (m) and axes in the world, where the bodies are now, the axes at right angles; as in Bullet they are made unit where they
  /// stand.
  Hinge2Joint(btRigidBody& rbA, btRigidBody& rbB, btVector3& anchor, btVector3& axis1,
              btVector3& axis2)
      : SixDofOf(rbA, rbB, anchor, axis1, axis2) {}
  /// Joint frames in the bodies' frames. The axes and the anchor are those of frame a, where its body is now.
  Hinge2Joint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
              const btTransform& frameInB);
  /// To the world, where the body, the wheel, is now.
  Hinge2Joint(btRigidBody& rbB, const btTransform& frameInB);

  const char* name() const override { return "Hinge2Joint"; }

  // --- beyond Bullet -----------------------------------------------------------------------------
  /// Impulse of its spring in the last step along axis 0 to 5, as getLimitImpulse has it.
  btScalar getSpringImpulse(int axis) const { return springImpulse(anyAxis(axis)); }

 private:
  struct Axes {
    btVector3 anchor, axis_1, axis_2;
  };
  Hinge2Joint(btRigidBody& rbA, btRigidBody& rbB, Axes axes)
      : SixDofOf(rbA, rbB, axes.anchor, axes.axis_1, axes.axis_2) {}
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
