// Purpose: the gear, in the place of btGearConstraint: of two axes, two joints, or one joint's two coordinates.
#pragma once

#include <pintle/joints/gear_coordinate.h>
#include <pintle/joints/gear_model.h>
#include <pintle/joints/joint_of.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Holds q_a + ratio * q_b at the value that it finds, over any number of revolutions: not the rates alone, as Bullet's does, so
/// nothing drifts.
///
/// With Bullet's constructor q_a and q_b are the rotations of the two bodies about axes that are fixed in them, in space: the integrals of their
/// rates. Of two wheels on a carrier that turns, the carrier turns these, too. With two joints they are the coordinates of these
/// (GearCoordinate), against their carriers:
///
///     GearJoint gear(hinge_a, hinge_b, 2.5);      // two wheels, as Bullet's sign has it: b turns the other way, 0.4 times as fast
///     GearJoint rack(hinge, slider, -1 / radius);  // the slider moves by radius for each rad of the hinge
///     GearJoint screw(GearCoordinate::angleOf(slider), slider, -2 * pi / pitch);  // one joint: it turns once for each pitch
///     GearJoint mimic(hinge_a, hinge_b, -multiplier);
///     mimic.setOffset(offset);                     // q_a = multiplier * q_b + offset
///
/// It is a constraint of two bodies, one of each joint: those that leave out no body that moves, if there are such; else those that
/// leave out what the joints have in common, their carrier; else bodies B. A carrier that is left out feels nothing of the gear, as in Bullet: where
/// it moves freely, the angular momentum of the whole changes by the torque that a gear box would pass on to it. The coordinates are held against
/// it all the same, whatever moves it.
///
/// - setRatio during a run keeps the angles: what is held from there on is the sum that they have then.
/// - A body that is put elsewhere keeps its place, and the gear holds the new sum: a coordinate that changes in a step by more than 45 degrees or
///   0.25 m, and by so much more than twice what its velocity says. What is less is an error, which is corrected at getMaxCorrectionSpeed (of a position
///   getMaxLinearCorrectionSpeed) at the most, by either coordinate.
/// - A gear that is disabled lets go, and enabled again holds what it finds.
/// - setAxisA and setAxisB, of a gear of two joints: that coordinate is the rotation of the body from there on.
/// - A file keeps what Bullet's class has: axes and ratio of two rotations.
///
/// It is a btGearConstraint: everything of that is Bullet's own, but for the row. As there an axis that is longer than 1 counts its rotation
/// so many times. A number that is not finite is not used: the last good one stays (Joint::whyIgnored).
///
/// \image html gear_joint.svg
class GearJoint : public JointOf<btGearConstraint, GearModel> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// Axes in the bodies' frames.
  GearJoint(btRigidBody& rbA, btRigidBody& rbB, const btVector3& axisInA, const btVector3& axisInB,
            btScalar ratio = 1)
      : JointOf(row_count, rbA, rbB, axisInA, axisInB, ratio) {}
  /// Coordinates of two joints, or of one. Throws std::invalid_argument if the ratio is not finite.
  GearJoint(const GearCoordinate& a, const GearCoordinate& b, btScalar ratio = 1);

  // --- beyond Bullet -----------------------------------------------------------------------------
  ///@{
  /// q_a and q_b, rad or m, with all revolutions: since the gear was made, or since a QuaternionHinge has counted them.
  btScalar getCoordinateA();
  btScalar getCoordinateB();
  ///@}
  ///@{
  /// The sum q_a + ratio * q_b that is held (finite). Another one is approached at the speed of corrections.
  void setOffset(btScalar offset);
  btScalar getOffset();
  ///@}
  /// How far the sum is from the one that is held, rad or m.
  btScalar getError();

 private:
  GearJoint(const GearCoordinate& a, const GearCoordinate& b, btScalar ratio,
            GearCoordinate::Bodies bodies);
  void follow();
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
