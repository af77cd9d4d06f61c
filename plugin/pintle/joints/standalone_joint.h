// Purpose: the base of the joints that have no counterpart in Bullet.
#pragma once

#include <pintle/joints/joint_of.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A `btTypedConstraint` of its own type, made of rows.
class StandaloneJoint : public JointOf<btTypedConstraint, Joint> {
 public:
  /// As Bullet has it: getInfo1 of the joint itself, whatever a subclass makes of it.
  void getInfo1NonVirtual(btConstraintInfo1* info) { announceRows(*info); }
  /// As in Bullet nothing to do.
  void updateRHS(btScalar) {}

  /// In the range of btTypedConstraintType and none of its values: Bullet's debug drawing and importer
  /// cast by type.
  static constexpr auto type = btTypedConstraintType(15);

 protected:
  StandaloneJoint(btRigidBody& a, btRigidBody& b, RowCount max_rows)
      : JointOf(max_rows, type, a, b) {}
  /// b is Bullet's fixed body.
  StandaloneJoint(btRigidBody& a, RowCount max_rows)
      : StandaloneJoint(a, getFixedBody(), max_rows) {}
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
