// Purpose: of JointMatrix, what an impulse on a body gives to it when its joints hold.
#include <pintle/solver/joint_matrix.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// A matrix of six rows: each column in twice four lanes, of which two are idle.
struct SixRows {
  FourLanes first, rest;

  PINTLE_INLINE void add(const double* column, double by) {
    first.add(FourLanes(column), by);
    rest.add(FourLanes(column + FourLanes::count), by);
  }
  PINTLE_INLINE void store(double* column) const {
    first.store(column);
    rest.store(column + FourLanes::count);
  }
};

// to += a z c^T. a and c: three columns of six rows.
template <int stride>
PINTLE_INLINE void addSandwich(const double (&a)[3][stride], const double (&z)[3][3],
                               const double (&c)[3][stride], SixRows (&to)[6]) {
  for (int s = 0; s < 3; ++s) {
    SixRows az;
    for (int r = 0; r < 3; ++r) az.add(a[r], z[r][s]);
    double column[stride];
    az.store(column);
    for (int j = 0; j < 6; ++j) to[j].add(column, c[s][j]);
  }
}

}  // namespace

// Of each body: its products come one after the other.
PINTLE_TARGET_CLONES void JointMatrix::subtractProducts(const std::vector<char>& asked,
                                                        std::vector<Matrix6d>& answers) const {
  for (size_t from = 0; from < m_products.size();) {
    const int body = m_products[from].body;
    SixRows sum[6];
    for (; from < m_products.size() && m_products[from].body == body; ++from) {
      const Product& of = m_products[from];
      if (!asked[size_t(body)] || isIdle(of.i) || isIdle(of.k)) continue;
      const Rows &i = m_rows[size_t(of.rows_i)], &k = m_rows[size_t(of.rows_k)];
      const double* const block_of = m_inverse.data() + of.place;
      double z[block][block], z_transposed[block][block];
      for (int r = 0; r < block; ++r)
        for (int s = 0; s < block; ++s)
          z[r][s] = z_transposed[s][r] = block_of[SymmetricFactor::in(r, s)];
      for (int r = 0; of.i == of.k && r < block; ++r)
        if (m_acts[size_t(stride * of.i + r)] == 0) z[r][r] = 0;
      addSandwich(i.answer, z, k.answer, sum);
      if (of.i != of.k) addSandwich(k.answer, z_transposed, i.answer, sum);
    }
    if (!asked[size_t(body)]) continue;
    for (int j = 0; j < 6; ++j) {
      double column[2 * stride];
      sum[j].store(column);
      for (int r = 0; r < 6; ++r) answers[size_t(body)](r, j) -= column[r];
    }
  }
}

// A^-1 - A^-1 J^T K^-1 J A^-1, of which a body's own joints have their part. Of one that stays, its velocity is an unknown.
void JointMatrix::findAnswers(const std::vector<char>& asked, std::vector<Matrix6d>& answers) {
  m_factor.invertWhereFactored(m_inverse);
  answers.resize(m_ends.size());
  for (size_t b = 0; b < m_ends.size(); ++b) {
    if (m_stays[b] || !asked[b]) continue;
    answers[b].setZero();
    answers[b].diagonal().head<3>() = m_bodies[b].linear;
    answers[b].bottomRightCorner<3, 3>() = m_bodies[b].angular;
  }
  subtractProducts(asked, answers);
  for (size_t b = 0; b < m_ends.size(); ++b) {
    if (!m_stays[b] || !asked[b]) continue;
    const int node = nodeOfBody(int(b));
    Matrix6d W, by = Matrix6d::Zero();
    for (int p = 0; p < 2; ++p)
      for (int q = 0; q <= p; ++q) {
        const double* const of = m_inverse.data() + m_factor.place(node + p, node + q);
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j)
            W(3 * p + i, 3 * q + j) = W(3 * q + j, 3 * p + i) = -of[SymmetricFactor::in(i, j)];
      }
    by.diagonal().head<3>() = m_bodies[b].scale[0] * m_bodies[b].linear;
    by.bottomRightCorner<3, 3>() = m_bodies[b].scale[1] * m_bodies[b].angular;
    answers[b] = by * W * by;
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
