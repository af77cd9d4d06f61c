// Purpose: what the C of a row is made of, for a solver that wants its mean over a step and not its gradient at the start alone.
#pragma once

#include <pintle/vectors.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// World space, at the pose of the row.
struct RowShape {
  enum Kind : unsigned char {
    point,  ///< C is along one direction of the world between points of the bodies: a and b are their levers
    dot,  ///< C is a.b, a an axis of body a, b one of body b
    /// C is the angle of b against a about the row's own axis, which other rows of the joint hold: who measures it takes arms a and b
    /// at right angles to that.
    turn,
    distance,  ///< C + a constant is the distance of two points, `length`: a and b are their levers
    angle,  ///< C is an angle about the row's own axis, or another measure of how b is turned against a
    other  ///< anything else
  };
  Kind kind = other;
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();
  Scalar length = 0;  ///< m
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
