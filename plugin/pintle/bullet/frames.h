// Purpose: joint frames as Bullet's clients give them, which Bullet takes as they are.
#pragma once

#include <pintle/finite.h>
#include <pintle/precision.h>

#include <LinearMath/btTransform.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

class Complaints;

/// Products of the axes of a frame may be off by this: clients make frames of rounded numbers (DerivedHinge, ConstructorsRefuseBadFrames).
constexpr Scalar frame_tolerance = Scalar(1e-3);

/// True of unit axes at right angles, right-handed.
bool isRotation(const btMatrix3x3& R);

/// True of the same numbers in both.
bool isSameBasis(const btMatrix3x3& a, const btMatrix3x3& b);

/// Makes a frame of what a client gave: its axis number `main` made unit, the part of number `second` across that, and the third for
/// a right hand. (About or along the main axis as it stands Bullet's joints are driven, and by the second they measure angles.) False, and
/// changes nothing, if a number is not finite or the main axis has no direction.
bool orthonormalize(const btTransform& given, int main, int second, btTransform& frame);

/// The same, but what is a frame stays as it stands.
bool repairFrame(const btTransform& given, int main, int second, btTransform& frame);

/// Takes over the frames of a joint, repaired; both or neither. Returns whether an axis is another one: then angles have another zero.
/// `complaints`: null in a step.
bool takeOtherFrames(btTransform& frame_a, btTransform& frame_b, const btTransform& from_a,
                     const btTransform& from_b, int main, int second, Complaints* complaints);
/// The same of frames that may be those of the last step, bit by bit: in nearly all steps they are.
inline bool takeFrames(btTransform& frame_a, btTransform& frame_b, const btTransform& from_a,
                       const btTransform& from_b, int main, int second, Complaints* complaints) {
  if (isSame(from_a, frame_a) && isSame(from_b, frame_b)) return false;
  return takeOtherFrames(frame_a, frame_b, from_a, from_b, main, second, complaints);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
