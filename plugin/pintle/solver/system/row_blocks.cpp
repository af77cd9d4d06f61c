#include <pintle/solver/system/row_blocks.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {

PINTLE_INLINE void RowBlocks::set(Rows& to, int lane, const Vector3d& L, const Vector3d& A,
                                  const Vector6d& answer) {
  Eigen::Map<Vector6d> kept(to.answer[lane]);
  // (Along an axis that factors hold J may change alone.)
  Vector6d J, kept_J;
  J << L, A;
  for (int k = 0; k < 6; ++k) kept_J[k] = to.J[k][lane];
  if ((m_is_assembled || m_is_factorised) && isSame(kept, answer) && isSame(kept_J, J)) return;
  m_is_assembled = m_is_factorised = false;
  for (int k = 0; k < 6; ++k) to.J[k][lane] = J[k];
  kept = answer;
}

void RowBlocks::setRow(int c, int i, const RowJacobian& J, double root_K, double by_root_K) {
  const int node = m_node[size_t(c)] + i / block, lane = i % block;
  m_root_K[size_t(stride * node + lane)] = root_K;
  for (int side = 0; side < 2; ++side)
    if (const int body = m_bodies_of[size_t(node)][size_t(side)]; body >= 0) {
      const Vector3d L = by_root_K * J.L(side), A = by_root_K * J.A(side);
      set(rows(node, side), lane, L, A, m_bodies[size_t(body)].answer(L, A));
    }
}

double RowBlocks::setRowByItsK(int c, int i, const RowJacobian& J, double else_by) {
  const int node = m_node[size_t(c)] + i / block, lane = i % block;
  Vector6d answer[2];
  double K = 0;
  for (int side = 0; side < 2; ++side)
    if (const int body = m_bodies_of[size_t(node)][size_t(side)]; body >= 0) {
      answer[side] = m_bodies[size_t(body)].answer(J.L(side), J.A(side));
      K += J.along(side, answer[side]);
    }
  const double root_K = K > 0 ? std::sqrt(K) : else_by, by_root_K = 1 / root_K;
  m_root_K[size_t(stride * node + lane)] = root_K;
  for (int side = 0; side < 2; ++side)
    if (m_bodies_of[size_t(node)][size_t(side)] >= 0)
      set(rows(node, side), lane, by_root_K * J.L(side), by_root_K * J.A(side),
          by_root_K * answer[side]);
  return root_K;
}

void RowBlocks::setRows(int c, const IslandRow* from, int count) {
  for (int node = m_node[size_t(c)]; count > 0; ++node, from += block, count -= block) {
    const int lanes = std::min(count, block);
    double* const root_K = &m_root_K[size_t(stride * node)];
    for (int i = 0; i < lanes; ++i) root_K[i] = from[i].root_K;
    for (int side = 0; side < 2; ++side) {
      const int body = m_bodies_of[size_t(node)][size_t(side)];
      if (body < 0) continue;
      Rows& to = rows(node, side);
      for (int i = 0; i < lanes; ++i) {
        const Vector3d L = from[i].by_root_K * from[i].J.L(side),
                       A = from[i].by_root_K * from[i].J.A(side);
        set(to, i, L, A, m_bodies[size_t(body)].answer(L, A));
      }
    }
  }
}

namespace {

// u -= J v
PINTLE_INLINE void subtractVelocity(const double (&J)[6][FourLanes::count], const double* v,
                                    FourLanes& to) {
  for (int j = 0; j < 6; ++j) to.subtract(FourLanes(J[j]), v[j]);
}

}  // namespace

PINTLE_TARGET_CLONES void RowBlocks::addResponse(const double* x, Vector6d* v) const {
  const int nodes = int(m_bodies_of.size());
  for (int node = 0; node < nodes; ++node) {
    const double* const by = x + stride * node;
    if (by[0] == 0 && by[1] == 0 && by[2] == 0) continue;
    for (int side = 0; side < 2; ++side) {
      const int body = m_bodies_of[size_t(node)][size_t(side)];
      if (body < 0) continue;
      const Rows& rows = m_rows[size_t(2 * node + side)];
      double* const to = v[body].data();
      FourLanes first(to), rest;
      for (int r = 0; r < block; ++r) {
        first.add(FourLanes(rows.answer[r]), by[r]);
        rest.add(FourLanes(rows.answer[r] + stride), by[r]);
      }
      first.store(to);
      to[4] += rest[0];
      to[5] += rest[1];
    }
  }
}

PINTLE_TARGET_CLONES void RowBlocks::subtractVelocities(const Vector6d* v, double* x) const {
  const int nodes = int(m_bodies_of.size());
  for (int node = 0; node < nodes; ++node) {
    if (isIdle(node)) continue;
    FourLanes u;
    for (int side = 0; side < 2; ++side)
      if (const int body = m_bodies_of[size_t(node)][size_t(side)]; body >= 0)
        addVelocity(m_rows[size_t(2 * node + side)].J, v[body].data(), u);
    FourLanes left(x + stride * node);
    left.subtract(u, FourLanes(m_acts.data() + stride * node));
    left.store(x + stride * node);
  }
}

PINTLE_TARGET_CLONES double RowBlocks::findResidual(const double* aim, const double* y,
                                                    const Vector6d* v, double* x) const {
  const int nodes = int(m_bodies_of.size());
  FourLanes most;
  for (int node = 0; node < nodes; ++node) {
    const size_t at = size_t(stride * node);
    if (isIdle(node)) {
      FourLanes().store(x + at);
      continue;
    }
    FourLanes left(aim + at);
    left.subtract(FourLanes(&m_softness[at]), FourLanes(y + at));
    for (int side = 0; side < 2; ++side)
      if (const int body = m_bodies_of[size_t(node)][size_t(side)]; body >= 0)
        subtractVelocity(m_rows[size_t(2 * node + side)].J, v[body].data(), left);
    left.multiply(FourLanes(&m_acts[at]));
    left.store(x + at);
    left.multiply(FourLanes(&m_root_K[at]));
    most.maxAbs(left);
  }
  double largest = 0;
  for (int i = 0; i < block; ++i) largest = larger(largest, most[i]);
  return largest;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
