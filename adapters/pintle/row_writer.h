// Purpose: the one place that knows how Bullet's solver wants a row. The document's row is
// J v = target with J = [-L, -A_a, L, A_b] (2.2); Bullet's stock joints have body a positive, so a row
// is written as -J v = -target, and its impulse is minus the document's lambda.
#pragma once

#include <pintle/precision.h>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>

#include <cstring>

namespace pintle {
inline namespace PINTLE_PRECISION {

class RowWriter {
 public:
  explicit RowWriter(btTypedConstraint::btConstraintInfo2& info)
      : m_info(info), m_cfm(info.cfm[0]) {}

  /// 1 / time step.
  Scalar fps() const { return m_info.fps; }
  Scalar erp() const { return m_info.erp; }
  /// The world's default; Bullet hands it over in the first row only.
  Scalar cfm() const { return m_cfm; }
  void setDamping(Scalar damping) { m_info.m_damping = damping; }

  /// Writes every field of the next row. `target` and the bounds are the document's (body b
  /// positive), cfm is Bullet's: a fraction of the row's own K.
  template <class Vector>
  void write(const Vector& L, const Vector& A_a, const Vector& A_b, Scalar target, Scalar cfm,
             Scalar lower, Scalar upper) {
    const int at = m_row * m_info.rowskip;
    put(m_info.m_J1linearAxis + at, L);
    put(m_info.m_J1angularAxis + at, A_a);
    put(m_info.m_J2linearAxis + at, Vector(-L));
    put(m_info.m_J2angularAxis + at, Vector(-A_b));
    m_info.m_constraintError[at] = -target;
    m_info.cfm[at] = cfm;
    m_info.m_lowerLimit[at] = -upper;
    m_info.m_upperLimit[at] = -lower;
    ++m_row;
  }

 private:
  // Three numbers of a vector that may have more.
  template <class Vector>
  static void put(btScalar* to, const Vector& v) {
    std::memcpy(to, v.data(), 3 * sizeof(btScalar));
  }

  btTypedConstraint::btConstraintInfo2& m_info;
  Scalar m_cfm;
  int m_row = 0;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
