// Purpose: of JointMatrix, what joints do to impulses on their bodies, by the paths of these through the factor.
#include <pintle/solver/joint_matrix.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {

// x += R of an impulse that gives this to the body. Returns the first node that has a part of it: all others are on its path. Of a body
// that stays, its velocity is an unknown.
PINTLE_TARGET_CLONES int JointMatrix::addVelocities(int body, const Vector6d& answer,
                                                    double* x) const {
  if (m_stays[size_t(body)]) {
    const int node = nodeOfBody(body);
    for (int half = 0; half < 2; ++half)
      for (int i = 0; i < 3; ++i)
        x[stride * (node + half) + i] += m_bodies[size_t(body)].scale[half] * answer[3 * half + i];
    return node;
  }
  int from = m_factor.blocks();
  for (const End& end : m_ends[size_t(body)]) {
    const int first = m_node[size_t(end.joint)], last = first + nodesOf(end.joint);
    for (int node = first; node < last; ++node) {
      from = std::min(from, node);
      if (isIdle(node)) continue;
      const Rows& rows = m_rows[size_t(2 * node + end.side)];
      FourLanes u, to(x + stride * node);
      for (int j = 0; j < 6; ++j) u.add(FourLanes(rows.J[j]), answer[j]);
      to.add(u, FourLanes(&m_acts[size_t(stride * node)]));
      to.store(x + stride * node);
    }
  }
  return from;
}

void JointMatrix::findPath(const Joint& bodies, const RowJacobian& J, PathBlocks& to) {
  int from[2] = {m_factor.blocks(), m_factor.blocks()};
  for (int side = 0; side < 2; ++side) {
    const int body = bodies[size_t(side)];
    if (body < 0) continue;
    from[side] =
        addVelocities(body, m_bodies[size_t(body)].answer(J.L(side), J.A(side)), m_path.data());
  }
  m_factor.followPaths(from[0], from[1], m_path.data(), to);
}

int JointMatrix::pathLength(int body) const {
  if (m_stays[size_t(body)]) return m_factor.pathLength(nodeOfBody(body));
  int from = m_factor.blocks();
  for (const End& end : m_ends[size_t(body)])
    if (nodesOf(end.joint) > 0) from = std::min(from, m_node[size_t(end.joint)]);
  return m_factor.pathLength(from);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
