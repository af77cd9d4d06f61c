// Purpose: the rows of Bullet's solver that a joint has written, if it is a solver that shows them.
#pragma once

#include <pintle/rows/row.h>

#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <BulletDynamics/ConstraintSolver/btSolverConstraint.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>

#include <cstddef>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// J v
inline Scalar velocity(const Row& row, const Vec3& v_ab, const Vec3& w_a, const Vec3& w_b) {
  return row.L.dot(v_ab) - row.A_a.dot(w_a) + row.A_b.dot(w_b);
}

/// The rows behind `info`, if they are those of Bullet's own solvers.
inline btSolverConstraint* solverRows(const btTypedConstraint::btConstraintInfo2& info) {
  auto* bytes = reinterpret_cast<char*>(info.m_J1linearAxis);
  auto* row =
      reinterpret_cast<btSolverConstraint*>(bytes - offsetof(btSolverConstraint, m_contactNormal1));
  const bool same = size_t(info.rowskip) * sizeof(btScalar) == sizeof(btSolverConstraint) &&
                    info.m_J2angularAxis == row->m_relpos2CrossNormal.m_floats &&
                    info.m_constraintError == &row->m_rhs &&
                    info.m_lowerLimit == &row->m_lowerLimit;
  return same ? row : nullptr;
}

/// Changes of the impulses of a joint's rows, given to its bodies at once: all rows act on the same two.
class ImpulseSum {
 public:
  /// Gives a row its impulse, N s or N m s.
  void setImpulse(btSolverConstraint& row, Scalar impulse) {
    const Scalar change = impulse - row.m_appliedImpulse;
    m_linear += change * row.m_contactNormal1;
    m_angular_a += change * row.m_angularComponentA;
    m_angular_b += change * row.m_angularComponentB;
    row.m_appliedImpulse = impulse;
  }
  /// Gives the bodies what the rows have changed by.
  void apply(btSolverBody& a, btSolverBody& b) const {
    a.internalApplyImpulse(m_linear * a.internalGetInvMass(), m_angular_a, 1);
    b.internalApplyImpulse(-m_linear * b.internalGetInvMass(), m_angular_b, 1);
  }

 private:
  btVector3 m_linear{0, 0, 0}, m_angular_a{0, 0, 0}, m_angular_b{0, 0, 0};
};

/// Solves one row as Bullet's pass does.
inline void solveRow(btSolverConstraint& row, btSolverBody& a, btSolverBody& b) {
  const Scalar velocity = row.m_contactNormal1.dot(a.m_deltaLinearVelocity) +
                          row.m_relpos1CrossNormal.dot(a.m_deltaAngularVelocity) +
                          row.m_contactNormal2.dot(b.m_deltaLinearVelocity) +
                          row.m_relpos2CrossNormal.dot(b.m_deltaAngularVelocity);
  const Scalar impulse =
      row.m_appliedImpulse * (1 - row.m_cfm) + row.m_rhs - velocity * row.m_jacDiagABInv;
  ImpulseSum sum;
  sum.setImpulse(row, btMax(row.m_lowerLimit, btMin(impulse, row.m_upperLimit)));
  sum.apply(a, b);
}

/// The same row with a Jacobian so many times as long: its impulse is that much smaller.
inline void lengthen(btSolverConstraint& row, Scalar times) {
  for (btVector3* J : {&row.m_contactNormal1, &row.m_relpos1CrossNormal, &row.m_angularComponentA,
                       &row.m_contactNormal2, &row.m_relpos2CrossNormal, &row.m_angularComponentB})
    *J *= times;
  row.m_appliedImpulse /= times;
  row.m_rhs /= times;
  row.m_jacDiagABInv /= times * times;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
