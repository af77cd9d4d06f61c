// Clients' joints that override getInfo1 alone, and leave getInfo2 to Pintle's.
#pragma once

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>

namespace support {

/// Announces by itself how many rows there are: those that the joint has at least.
template <class J, int rows>
class Announces : public J {
 public:
  using J::J;
  void getInfo1(btTypedConstraint::btConstraintInfo1* info) override {
    info->m_numConstraintRows = rows;
    info->nub = 6 - rows;
  }
};

/// Asks Bullet's method, which looks at the limits.
template <class J, class Stock>
class AnnouncesAsBullet : public J {
 public:
  using J::J;
  void getInfo1(btTypedConstraint::btConstraintInfo1* info) override { Stock::getInfo1(info); }
};

}  // namespace support
