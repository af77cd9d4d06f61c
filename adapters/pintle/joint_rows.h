// Purpose: the rows of any joint, called as Bullet's solver calls it.
#pragma once

#include <pintle/precision.h>

#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <BulletDynamics/ConstraintSolver/btSolverConstraint.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>

#include <cstring>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// What a joint is told of the step; as btContactSolverInfo has it.
struct StepOfRows {
  Scalar fps, erp, cfm, damping;
  int iterations;
};

/// Fills `rows`, which has room for all of the joint's. m_rhs becomes the velocity (m/s, rad/s) that a row asks for by
/// its position. Returns the joint's damping: the part of the present velocity that its rows take away.
inline Scalar askRows(btTypedConstraint& joint, const StepOfRows& step, btSolverConstraint* rows,
                      int count) {
  std::memset(static_cast<void*>(rows), 0, size_t(count) * sizeof(btSolverConstraint));
  for (int i = 0; i < count; ++i) {
    rows[i].m_lowerLimit = -SIMD_INFINITY;
    rows[i].m_upperLimit = SIMD_INFINITY;
  }
  rows->m_cfm = step.cfm;
  btTypedConstraint::btConstraintInfo2 info;
  info.fps = step.fps;
  info.erp = step.erp;
  info.m_J1linearAxis = rows->m_contactNormal1;
  info.m_J1angularAxis = rows->m_relpos1CrossNormal;
  info.m_J2linearAxis = rows->m_contactNormal2;
  info.m_J2angularAxis = rows->m_relpos2CrossNormal;
  info.rowskip = sizeof(btSolverConstraint) / sizeof(btScalar);
  info.m_constraintError = &rows->m_rhs;
  info.cfm = &rows->m_cfm;
  info.m_lowerLimit = &rows->m_lowerLimit;
  info.m_upperLimit = &rows->m_upperLimit;
  info.m_numIterations = step.iterations;
  info.m_damping = step.damping;
  joint.getInfo2(&info);
  return info.m_damping;
}

/// J v of a row, with the step's forces.
inline Scalar velocity(const btSolverConstraint& row, const btSolverBody& a,
                       const btSolverBody& b) {
  return row.m_contactNormal1.dot(a.m_linearVelocity + a.m_externalForceImpulse) +
         row.m_relpos1CrossNormal.dot(a.m_angularVelocity + a.m_externalTorqueImpulse) +
         row.m_contactNormal2.dot(b.m_linearVelocity + b.m_externalForceImpulse) +
         row.m_relpos2CrossNormal.dot(b.m_angularVelocity + b.m_externalTorqueImpulse);
}

/// Makes m_rhs the target of J v of the solver's bodies. A joint's damping leaves a part of the velocity. And Bullet
/// counts the velocity of static bodies, for which its solver has a single body at rest.
inline void completeTargets(btSolverConstraint* rows, int count, const btTypedConstraint& joint,
                            Scalar damping, const btSolverBody& a, const btSolverBody& b) {
  const auto standsIn = [](const btSolverBody& of, const btRigidBody& body) {
    return of.m_originalBody == nullptr &&
           !(body.getLinearVelocity().isZero() && body.getAngularVelocity().isZero());
  };
  const btRigidBody &rb_a = joint.getRigidBodyA(), &rb_b = joint.getRigidBodyB();
  const bool at_a = standsIn(a, rb_a), at_b = standsIn(b, rb_b);
  if (damping == 1 && !at_a && !at_b) return;
  for (int i = 0; i < count; ++i) {
    btSolverConstraint& row = rows[i];
    const Scalar known = velocity(row, a, b);
    Scalar whole = known;
    if (at_a)
      whole += row.m_contactNormal1.dot(rb_a.getLinearVelocity()) +
               row.m_relpos1CrossNormal.dot(rb_a.getAngularVelocity());
    if (at_b)
      whole += row.m_contactNormal2.dot(rb_b.getLinearVelocity()) +
               row.m_relpos2CrossNormal.dot(rb_b.getAngularVelocity());
    row.m_rhs += known - damping * whole;
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
