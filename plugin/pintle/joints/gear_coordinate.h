// Purpose: which coordinate of a joint a gear couples.
#pragma once

#include <pintle/precision.h>

#include <LinearMath/btTransform.h>

class btHingeConstraint;
class btRigidBody;
class btSliderConstraint;
class btTypedConstraint;

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The angle of a hinge (rad), or the position (m) or angle (rad) of a slider, of Bullet's class or any that derives from it, Pintle's
/// among them. It is measured as that joint has it, but counts its own revolutions: limits of the joint may change it by none. The
/// joint's bodies and frames are taken here; the joint itself may end before the gear does. Its bodies may not, either of them, though only one
/// is a body of the gear; and in a world of threads a joint whose other body moves freely stays in the world as long as the gear, so that they are
/// of one island.
class GearCoordinate {
 public:
  ///@{
  /// The angle of a hinge, and the position of a slider. Throw std::invalid_argument if its frames are not finite.
  GearCoordinate(btHingeConstraint& hinge);
  GearCoordinate(btSliderConstraint& slider);
  ///@}
  /// The angle of a slider, of b against a.
  static GearCoordinate angleOf(btSliderConstraint& slider);

 private:
  friend class GearJoint;
  friend class GearSide;

  /// The bodies on which a gear between two coordinates acts, and of which it is a constraint.
  struct Bodies {
    btRigidBody *a, *b;
  };
  static Bodies bodiesOf(const GearCoordinate& a, const GearCoordinate& b);

  GearCoordinate(btTypedConstraint& joint, int main_axis);
  void setFrames(const btTransform& in_a, const btTransform& in_b, const char* joint);
  /// The axis about or along which it moves, in the frame of one of its bodies; its length is 1. A rotation of that body about it
  /// is one of the coordinate.
  btVector3 axisIn(const btRigidBody& body) const;

  btRigidBody *m_a, *m_b;            ///< of the joint
  btTransform m_frame_a, m_frame_b;  ///< the joint frames in them, m
  int m_main;                        ///< number of the frames' axis about or along which it moves
  bool m_is_position = false;
  Scalar m_sign = 1;   ///< of the coordinate against that of b seen from a
  Scalar m_turns = 0;  ///< that the joint has counted
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
