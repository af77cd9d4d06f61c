// Purpose: the rows of one joint as a block. 3.1.3 asks for them to be solved together; Bullet's
// solver takes row by row. Rows that are orthogonal in the mass metric do not disturb each other,
// so that one pass of the row solver solves the joint: J is multiplied from the left by the inverse
// of the unit lower triangular factor of K = J M^-1 J^T (2.2, 3.1.3), which is Gram-Schmidt. An
// axis row is made orthogonal to the equalities only, and nothing to it: its impulse and bounds
// keep their meaning. J^T lambda, and so what the bodies and the joint feedback see, does not
// change.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct BlockRow {
  Lanes A_a, A_b, L;     ///< A_a[3] is the row's target, which goes through the same elimination
  Lanes WA_a, WA_b, WL;  ///< M^-1 J^T
  Scalar K, K_inv;       ///< J M^-1 J^T; K_inv is 0 if the row must not be eliminated with
  bool angular;          ///< L = 0, and A_a = A_b but for the fourth lanes

  Scalar target() const { return A_a[3]; }
};

/// What is left of K after less than this part of it is rounding.
constexpr Scalar rounding_of_K = 64 * SIMD_EPSILON;

class Block {
 public:
  explicit Block(const BodyPair& pair) {
    const VectorView f_a = view(pair.a().getLinearFactor()), f_b = view(pair.b().getLinearFactor());
    const Scalar a = pair.inv_mass_a(), b = pair.inv_mass_b();
    m_m = {a * f_a[0] + b * f_b[0], a * f_a[1] + b * f_b[1], a * f_a[2] + b * f_b[2], Scalar(0)};
    load(m_I_a, pair.inv_inertia_a(), view(pair.a().getAngularFactor()));
    load(m_I_b, pair.inv_inertia_b(), view(pair.b().getAngularFactor()));
  }

  /// Makes `row` of `from`, orthogonal to the rows of the block. A row that depends on them stays as
  /// it was: it says the same again, and a remainder of rounding errors must not be solved for.
  /// Returns whether it is independent.
  bool orthogonalize(BlockRow& row, const Row& from) const {
    const Scalar lost = eliminate(row, from);
    weigh(row);
    // Bullet's solver passes over a row of less: what the bodies' factors leave of it is rounding.
    if (row.K > rounding_of_K * lost + SIMD_EPSILON) {
      row.K_inv = 1 / row.K;
      return true;
    }
    take(row, from);
    row.angular = false;  // it may stand behind one that is not
    weigh(row);
    row.K_inv = 0;
    return false;
  }

  /// Appends what orthogonalize makes of `from`.
  const BlockRow& add(const Row& from) {
    BlockRow& row = *m_end;
    if (!orthogonalize(row, from)) m_independent = false;
    ++m_end;
    if (row.angular) m_angular_end = m_end;
    return row;
  }

  const BlockRow& operator[](int i) const { return m_rows[i]; }
  /// Whether all rows are independent of those before them.
  bool independent() const { return m_independent; }

  /// Makes `row` of `from`, less what it shares with the rows of the block. Returns what K loses by
  /// it; the row's own K is not computed.
  Scalar eliminate(BlockRow& row, const Row& from) const {
    Lanes L = from.lanesL(), A_a = from.lanesA_a(), A_b = from.lanesA_b();
    Scalar lost = 0;
    const BlockRow* other = m_rows;
    for (; other != m_angular_end; ++other) {
      const Lanes common = A_a * other->WA_a + A_b * other->WA_b;
      const Scalar product = common.sum(), k = product * other->K_inv;
      const Lanes part = k * other->A_a;
      A_a -= part;
      A_b -= part;
      lost += k * product;
    }
    row.angular = from.angular && other == m_end;
    for (; other != m_end; ++other) {
      const Lanes common = L * other->WL + A_a * other->WA_a + A_b * other->WA_b;
      const Scalar product = common.sum(), k = product * other->K_inv;
      L -= k * other->L;
      A_a -= k * other->A_a;
      A_b -= k * other->A_b;
      lost += k * product;
    }
    row.L = L;
    row.A_a = A_a;
    row.A_b = A_b;
    return lost;
  }

  /// Makes `row` of `from` as it stands.
  static void take(BlockRow& row, const Row& from) {
    row.L = from.lanesL();
    row.A_a = from.lanesA_a();
    row.A_b = from.lanesA_b();
    row.angular = from.angular;
  }

  /// M^-1 J^T and K of a row, with M^-1 as Bullet applies it: with the bodies' factors.
  void weigh(BlockRow& row) const {
    row.WA_a = m_I_a[0] * row.A_a[0] + m_I_a[1] * row.A_a[1] + m_I_a[2] * row.A_a[2];
    row.WA_b = m_I_b[0] * row.A_b[0] + m_I_b[1] * row.A_b[1] + m_I_b[2] * row.A_b[2];
    if (row.angular) {
      row.K = (row.A_b * (row.WA_a + row.WA_b)).sum();
    } else {
      row.WL = m_m * row.L;
      row.K = (row.L * row.WL + row.A_a * row.WA_a + row.A_b * row.WA_b).sum();
    }
  }

 private:
  // I^-1 is symmetric: its columns, for a product without sums across lanes. The fourth lane is
  // what Bullet pads with, and goes with the factor's zero.
  static void load(Lanes (&I)[3], const MatrixView& inverse, const VectorView& factor) {
    const Lanes f(factor[0], factor[1], factor[2], Scalar(0));
    for (int i = 0; i < 3; ++i) I[i] = f * LanesView(inverse.data() + i * inverse.outerStride());
  }

  Lanes m_m;
  Lanes m_I_a[3], m_I_b[3];
  BlockRow m_rows[max_joint_rows];
  BlockRow* m_end = m_rows;
  BlockRow* m_angular_end = m_rows;  ///< of the angular rows that come first
  bool m_independent = true;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
