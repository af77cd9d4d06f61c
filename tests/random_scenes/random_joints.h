// The joints of random scenes: all of Pintle's and of Bullet's, without drives. A motor of no speed is friction. Limits may be springs,
// which give back what they took. The springs of Bullet's joints stay off: what they store at the start is not in the book of energy.
#pragma once

#include <memory>

#include <LinearMath/btTransform.h>

#include "../unit/support.h"

namespace random_scenes {

using Joint = std::unique_ptr<btTypedConstraint>;

struct Range {
  btScalar low, high;
};

/// What a joint is made of.
struct Making {
  btRigidBody &a, &b;
  btTransform in_a, in_b;
  bool rubs;  ///< with friction, where it has any
  support::Random& random;

  /// Around 0, where the joint starts: at most so far.
  Range range(double most) const;
  /// N or N m, also N s or N m s; 0: none.
  btScalar friction() const;
  /// m, of the pivots.
  double length() const;
};

struct Kind {
  const char* name;
  bool has_length;  ///< its pivots start apart
  Joint (*make)(const Making&);
  Joint (*make_other)(const Making&);  ///< on the same bodies; null: there is none
  bool folds = false;                  ///< it holds Euler angles, also where they fold
};

/// What joints have beside, where they can.
struct Variant {
  bool bends = false;     ///< constant velocity joints: a limit of their bend
  bool document = false;  ///< Formulation::document
  double spring_hz = 0;   ///< of limits; 0: they are rigid
  double spring_damping = 0;
};
/// Not the form of an angular limit: what the document has in the place of its row is none where bodies tilt (equations/angular_limit.h).
/// Nor springs of distances: where these turn far in a step, they give more than they took.
void setVariant(btTypedConstraint& joint, const Variant& variant, support::Random& random);

int kindCount();
const Kind& kindOf(int index);

}  // namespace random_scenes
