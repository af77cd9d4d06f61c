// The joints of random scenes: all of Pintle's and of Bullet's, without drives and springs. A motor of no speed is friction. The
// springs of Bullet's joints stay off: what a spring stores is not in the book of energy.
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

int kindCount();
const Kind& kindOf(int index);

}  // namespace random_scenes
