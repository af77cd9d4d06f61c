#include <pintle/joints/generic_6dof_joint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

void Generic6DofJoint::getInfo2NonVirtual(btTypedConstraint::btConstraintInfo2* info,
                                          const btTransform& transA, const btTransform& transB,
                                          const btVector3&, const btVector3&, const btVector3&,
                                          const btVector3&) {
  writeRowsAt(*info, transA, transB);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
