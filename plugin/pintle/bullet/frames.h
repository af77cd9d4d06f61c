// Purpose: joint frames as Bullet's clients give them, which Bullet takes as they are.
#pragma once

#include <pintle/precision.h>

#include <LinearMath/btTransform.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Whether the axes are unit vectors at right angles, right-handed, to a thousandth.
bool isRotation(const btMatrix3x3& R);

/// Makes a frame of what a client gave: its z axis made unit, the part of x across z, and y for
/// a right hand. (Bullet's hinges turn and are driven about the z axis as it stands.) False, and changes nothing, if a number
/// is not finite or z has no direction.
bool orthonormalize(const btTransform& given, btTransform& frame);

/// The same, but what is a frame stays as it stands.
bool repairFrame(const btTransform& given, btTransform& frame);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
