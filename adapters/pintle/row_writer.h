// Purpose: the one place that knows how Bullet's solver wants a row. The document's row is
// J v = target with J = [-L, -A_a, L, A_b] (2.2); Bullet's stock joints have body a positive, so a
// row is written as -J v = -target, and its impulse is minus the document's lambda.
#pragma once

#include <pintle/vectors.h>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>

#include <cstddef>
#include <cstring>

namespace pintle {
inline namespace PINTLE_PRECISION {

class RowWriter {
 public:
  explicit RowWriter(btTypedConstraint::btConstraintInfo2& info)
      : m_J1linear(info.m_J1linearAxis),
        m_J1angular(info.m_J1angularAxis),
        m_J2linear(info.m_J2linearAxis),
        m_J2angular(info.m_J2angularAxis),
        m_error(info.m_constraintError),
        m_cfms(info.cfm),
        m_lower(info.m_lowerLimit),
        m_upper(info.m_upperLimit),
        m_skip(info.rowskip),
        m_cfm(info.cfm[0]) {}

  /// The world's default; Bullet hands it over in the first row only.
  Scalar cfm() const { return m_cfm; }

  /// Writes every field of the next row. The vectors' fourth lanes mean nothing. `target` and the bounds are the
  /// document's (body b positive); cfm is Bullet's, a fraction of the row's own K.
  void write(const Lanes& L, const Lanes& A_a, const Lanes& A_b, Scalar target, Scalar cfm,
             Scalar lower, Scalar upper) {
    put(m_J1linear + m_at, L);
    put(m_J1angular + m_at, A_a);
    put(m_J2linear + m_at, -L);
    put(m_J2angular + m_at, -A_b);
    m_error[m_at] = -target;
    m_cfms[m_at] = cfm;
    m_lower[m_at] = -upper;
    m_upper[m_at] = -lower;
    m_at += m_skip;
  }

 private:
  // Three numbers only: the fourth in Bullet's row is another field.
  static void put(Scalar* to, const Lanes& v) {
    std::memcpy(to, v.data(), 2 * sizeof(Scalar));
    to[2] = v[2];
  }

  // Copies, as pointers in Bullet's structure would be read again after each number written.
  Scalar *m_J1linear, *m_J1angular, *m_J2linear, *m_J2angular;
  Scalar *m_error, *m_cfms, *m_lower, *m_upper;
  std::ptrdiff_t m_skip, m_at = 0;
  Scalar m_cfm;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
