// Purpose: what joint.cpp, before Bullet's passes over the rows of a joint, and joint_passes.cpp, between
// them, have in common.
#pragma once

#include <pintle/joints/joint.h>
#include <pintle/rows/row.h>

#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <BulletDynamics/ConstraintSolver/btSolverConstraint.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>

#include <cstddef>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// What is slower than this (m/s, rad/s) stands still. Of an error a step leaves a part, or its rounding: after a few
/// steps a denormal, with which a processor is a hundred times as slow.
constexpr Scalar min_speed = SIMD_EPSILON * SIMD_EPSILON;

/// Whether a residual of now and one before say the same.
inline bool agree(Scalar now, Scalar before) { return now * before > min_speed * min_speed; }

/// What both say: the one nearer to 0, and 0 where they differ in sign.
inline Scalar agreed(Scalar a, Scalar b) {
  if (!(a * b > 0)) return 0;
  return btFabs(a) < btFabs(b) ? a : b;
}

/// J v
inline Scalar velocity(const Row& row, const Vec3& v_ab, const Vec3& w_a, const Vec3& w_b) {
  return row.L.dot(v_ab) - row.A_a.dot(w_a) + row.A_b.dot(w_b);
}

/// The same of many rows: lane by lane, with one sum.
class RelativeVelocity {
 public:
  RelativeVelocity(const Vec3& v_a, const Vec3& w_a, const Vec3& v_b, const Vec3& w_b)
      : m_v(lanes(v_b - v_a)), m_w_a(lanes(w_a)), m_w_b(lanes(w_b)) {}
  Scalar along(const Row& row) const {
    return (row.lanesL() * m_v + row.lanesA_b() * m_w_b - row.lanesA_a() * m_w_a).sum();
  }

 private:
  static Lanes lanes(const Vec3& v) { return {v[0], v[1], v[2], Scalar(0)}; }
  Lanes m_v, m_w_a, m_w_b;
};

inline bool Joint::isLimit(const Row& row) const {
  const AxisState& state = m_rows.axis(row.axis);
  return state.row[Axis::limit] >= 0 && !state.axis->hasLimitSpring();
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

}  // namespace PINTLE_PRECISION
}  // namespace pintle
