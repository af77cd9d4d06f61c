// Purpose: the rows of one joint as a block. 3.1.3 asks for them to be solved together; Bullet's solver
// takes row by row. Rows that are orthogonal in the mass metric do not disturb each other, so that
// one pass of the row solver solves the joint: J is multiplied from the left by the inverse of the
// unit lower triangular factor of K = J M^-1 J^T (2.2, 3.1.3), which is Gram-Schmidt. An axis row is
// made orthogonal to the equalities only, and nothing to it: its impulse and bounds keep their
// meaning. J^T lambda, and so what the bodies and the joint feedback see, does not change.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

// Four lanes for the sake of the vector unit.
using Lanes = Eigen::Array<Scalar, 4, 1>;

inline Lanes lanes(const Vec3& v, Scalar last = 0) { return {v.x(), v.y(), v.z(), last}; }

/// A row [L, A_a, A_b] or a velocity change M^-1 J^T.
struct Lanes3 {
  Lanes L, A_a, A_b;

  Lanes product(const Lanes3& o) const { return L * o.L + A_a * o.A_a + A_b * o.A_b; }
  void subtract(Scalar k, const Lanes3& o) {
    L -= k * o.L;
    A_a -= k * o.A_a;
    A_b -= k * o.A_b;
  }
};

struct BlockRow {
  Lanes3 J;    ///< J.L[3] is the row's target, which goes through the same elimination
  Lanes3 W;    ///< M^-1 J^T; W.L[3] = 0
  Scalar K;    ///< J M^-1 J^T
  Scalar K_inv;  ///< 0 if the row has nothing left that the bodies could follow

  Scalar target() const { return J.L[3]; }
};

/// M^-1 of both bodies, as Bullet applies it: with the bodies' linear and angular factors.
class BlockMass {
 public:
  explicit BlockMass(const BodyPair& pair)
      : m_m_inv(lanes(pair.inv_mass_a() * view(pair.a().getLinearFactor()) +
                      pair.inv_mass_b() * view(pair.b().getLinearFactor()))) {
    load(m_I_a, pair.inv_inertia_a(), view(pair.a().getAngularFactor()));
    load(m_I_b, pair.inv_inertia_b(), view(pair.b().getAngularFactor()));
  }

  void weigh(BlockRow& row) const {
    row.W.L = m_m_inv * row.J.L;
    row.W.A_a = m_I_a[0] * row.J.A_a[0] + m_I_a[1] * row.J.A_a[1] + m_I_a[2] * row.J.A_a[2];
    row.W.A_b = m_I_b[0] * row.J.A_b[0] + m_I_b[1] * row.J.A_b[1] + m_I_b[2] * row.J.A_b[2];
    row.K = row.J.product(row.W).sum();
    row.K_inv = row.K > 0 ? 1 / row.K : Scalar(0);
  }

 private:
  // I^-1 is symmetric: its columns, for a product without sums across lanes.
  static void load(Lanes (&I)[3], const MatrixView& inverse, const VectorView& factor) {
    for (int i = 0; i < 3; ++i)
      I[i] = lanes(inverse.row(i).transpose().cwiseProduct(factor));
  }

  Lanes m_m_inv;
  Lanes m_I_a[3], m_I_b[3];
};

/// Makes row `i` of weighed rows orthogonal to the equalities before it. A row that depends on them
/// is left as it was: it says the same again, and a remainder of rounding errors must not be
/// solved for.
inline void orthogonalise(BlockRow* rows, int i, int equalities) {
  // Redundant is what keeps less than this part of its K.
  const Scalar dependent = 64 * SIMD_EPSILON;
  BlockRow row = rows[i];
  for (int j = 0; j < i && j < equalities; ++j) {
    const Scalar k = row.J.product(rows[j].W).sum() * rows[j].K_inv;
    row.J.subtract(k, rows[j].J);
    row.W.subtract(k, rows[j].W);
  }
  row.K = row.J.product(row.W).sum();
  if (row.K > dependent * rows[i].K) {
    row.K_inv = 1 / row.K;
    rows[i] = row;
  } else {
    rows[i].K_inv = 0;
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
